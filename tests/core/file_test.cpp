#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <catch2/catch.hpp>

#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/core/sha256.hpp>

#include "support/temporary_folder.hpp"

using namespace stillbase;
namespace fs = std::filesystem;

namespace {

long files_in(const TemporaryFolder& folder) {
  return std::distance(fs::directory_iterator(folder.folder()), {});
}

std::string rule_of(const std::string& path, std::size_t max_bytes) {
  try {
    read_text_file(path, max_bytes);
  } catch (const InputError& error) {
    return error.findings().at(0).rule;
  }
  return "";
}

}  // namespace

TEST_CASE("what was written is read back byte for byte") {
  TemporaryFolder folder;
  const std::string text = std::string("one\0two\r\n", 9) + std::string(300000, 'x');
  write_file_atomically(folder.path("a"), text, false);
  CHECK(read_text_file(folder.path("a")) == text);
  CHECK(files_in(folder) == 1);
}

TEST_CASE("an existing file is replaced only when asked") {
  TemporaryFolder folder;
  write_file_atomically(folder.path("a"), "old", false);
  CHECK_THROWS_AS(write_file_atomically(folder.path("a"), "new", false), FileError);
  CHECK(read_text_file(folder.path("a")) == "old");
  CHECK(files_in(folder) == 1);
  write_file_atomically(folder.path("a"), "new", true);
  CHECK(read_text_file(folder.path("a")) == "new");
  CHECK(files_in(folder) == 1);
}

TEST_CASE("a write that fails leaves nothing behind") {
  TemporaryFolder folder;
  CHECK_THROWS_AS(write_file_atomically(folder.path("no/such/folder/a"), "x", true), FileError);
  fs::create_directory(folder.folder() / "d");
  CHECK_THROWS_AS(write_file_atomically(folder.path("d"), "x", true), FileError);
  CHECK_THROWS_AS(write_file_atomically("/dev/null", "x", true), FileError);
  // A dangling link passes the first check; the last step must still not go through it.
  fs::create_symlink(folder.path("nowhere"), folder.path("link"));
  CHECK_THROWS_AS(write_file_atomically(folder.path("link"), "x", false), FileError);
  CHECK(files_in(folder) == 2);
}

TEST_CASE("temporary files of processes that were killed block no write and are cleared") {
  TemporaryFolder folder;
  // As a process of this number leaves them that was killed in writing.
  const std::string begin = folder.path("a") + ".tmp." + std::to_string(::getpid()) + ".";
  for (int i = 0; i < 100; ++i) std::ofstream(begin + std::to_string(i)) << "part";
  std::ofstream(folder.path("a.tmp.1.7")) << "part";
  // Not temporary files of this one.
  for (const char* name : {"a.tmp", "a.tmp.1.x", "a.tmp..2", "b.tmp.1.0"}) {
    std::ofstream(folder.path(name)) << "kept";
  }
  write_file_atomically(folder.path("a"), "whole", false);
  CHECK(read_text_file(folder.path("a")) == "whole");
  CHECK(files_in(folder) == 5);
}

TEST_CASE("a temporary file that another process writes is left to it") {
  TemporaryFolder folder;
  const std::string other = folder.path("a.tmp.1.0");
  const int fd = ::open(other.c_str(), O_WRONLY | O_CREAT, 0666);
  REQUIRE(::flock(fd, LOCK_EX) == 0);
  write_file_atomically(folder.path("a"), "whole", false);
  CHECK(fs::exists(other));
  ::close(fd);
  write_file_atomically(folder.path("a"), "newer", true);
  CHECK_FALSE(fs::exists(other));
}

TEST_CASE("missing files, folders and too large files are wrong input") {
  TemporaryFolder folder;
  write_file_atomically(folder.path("a"), "12345", false);
  CHECK(rule_of(folder.path("b"), 10) == "missing-file");
  CHECK(rule_of(folder.path("a/b"), 10) == "missing-file");
  CHECK(rule_of(folder.folder(), 10) == "not-a-file");
  CHECK(rule_of(folder.path("a"), 4) == "too-large");
  CHECK(rule_of(folder.path("a"), 5).empty());
  CHECK(rule_of("/dev/zero", 1000) == "too-large");
}

TEST_CASE("sha256_hex gives the digests of FIPS 180-4's examples") {
  CHECK(sha256_hex("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  CHECK(sha256_hex("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  CHECK(sha256_hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq") ==
        "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}
