// The house keeps to its own plan: the #include lines of include/ and src/ against the table of
// src/README.md. The test reads text, so it also sees rooms that this build leaves out.
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

namespace {

namespace fs = std::filesystem;
using Names = std::set<std::string>;

const fs::path kSource = STILLBASE_SOURCE_DIR;

std::string read(const fs::path& path) {
  std::ifstream file(path);
  REQUIRE(file);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::stringstream stream(text);
  for (std::string part; std::getline(stream, part, separator);) {
    const auto first = part.find_first_not_of(" \t");
    if (first == std::string::npos) continue;
    parts.push_back(part.substr(first, part.find_last_not_of(" \t") - first + 1));
  }
  return parts;
}

struct Room {
  int layer = 0;
  Names may_include;
  std::map<std::string, Names> libraries;  // library -> file names in the room
};

std::map<std::string, Room> read_table() {
  std::map<std::string, Room> rooms;
  std::stringstream text(read(kSource / "src/README.md"));
  bool in_table = false;
  for (std::string line; std::getline(text, line);) {
    if (line == "| room | layer | may include | third-party |") {
      in_table = true;
      continue;
    }
    if (!in_table || line.rfind("|---", 0) == 0) continue;
    const std::vector<std::string> cells = split(line, '|');
    if (cells.size() != 4) break;
    Room room;
    room.layer = std::stoi(cells[1]);
    if (cells[2] != "-") {
      for (const std::string& name : split(cells[2], ' ')) room.may_include.insert(name);
    }
    if (cells[3] != "-") {
      for (const std::string& entry : split(cells[3], ';')) {
        const std::size_t colon = entry.find(':');
        REQUIRE(colon != std::string::npos);
        for (const std::string& file : split(entry.substr(colon + 1), ' ')) {
          room.libraries[entry.substr(0, colon)].insert(file);
        }
      }
    }
    CHECK(rooms.emplace(cells[0], room).second);
  }
  return rooms;
}

/// Library of an angle-bracket include; nothing for the standard library.
std::optional<std::string> library_of(const std::string& header) {
  static const std::vector<std::pair<std::regex, std::string>> kLibraries = {
      {std::regex("[a-z_0-9]+"), ""},
      {std::regex("(unsupported/)?Eigen/.*"), "Eigen"},
      {std::regex("nlopt\\.h(pp)?"), "NLopt"},
      {std::regex("Ip[A-Z].*|HSLLoader.*|coin.*"), "Ipopt"},
      {std::regex("ompl/.*"), "OMPL"},
      {std::regex("(fcl|ccd|octomap)/.*"), "FCL"},
      {std::regex("tinyxml2?\\.h"), "tinyxml2"},
      {std::regex("assimp/.*"), "assimp"},
      {std::regex("libqhull.*"), "Qhull"},
      {std::regex("yaml-cpp/.*"), "yaml-cpp"},
      {std::regex("nlohmann/.*"), "json"},
      {std::regex("CLI/.*"), "CLI11"},
      {std::regex("boost/.*"), "Boost"},
      {std::regex("openssl/.*"), "OpenSSL"},
      {std::regex("fmt/.*"), "fmt"},
      {std::regex("(sys/.*|fcntl|unistd|signal|termios|poll)(\\.h)?"), "POSIX"}};
  for (const auto& [pattern, library] : kLibraries) {
    if (!std::regex_match(header, pattern)) continue;
    if (library.empty()) return std::nullopt;
    return library;
  }
  return "unknown";
}

struct SourceFile {
  std::string room;
  fs::path path;  // below the source tree
  bool is_public = false;
  bool is_header = false;
  std::vector<std::string> own;      // "impact/jump.hpp", from either tree
  std::vector<std::string> foreign;  // <...> of others
  std::vector<std::string> strange;  // neither
};

std::vector<SourceFile> read_sources() {
  std::vector<SourceFile> files;
  const std::regex include_line(R"(^\s*#\s*include\s*([<"])([^>"]+)[>"])");
  for (const char* tree : {"include/stillbase", "src"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kSource / tree)) {
      const std::string extension = entry.path().extension();
      if (extension != ".hpp" && extension != ".cpp") continue;
      SourceFile file;
      file.path = fs::relative(entry.path(), kSource);
      file.is_public = tree == std::string("include/stillbase");
      file.is_header = extension == ".hpp";
      const fs::path inside = fs::relative(entry.path(), kSource / tree);
      if (!inside.has_parent_path()) continue;  // the front door stillbase.hpp is no room
      file.room = inside.begin()->string();
      std::stringstream text(read(entry.path()));
      for (std::string line; std::getline(text, line);) {
        std::smatch match;
        if (!std::regex_search(line, match, include_line)) continue;
        const std::string header = match[2];
        if (header == "stillbase/stillbase.h") continue;  // the front door of C is no room either
        if (header.rfind("stillbase/", 0) == 0) {
          file.own.push_back(header.substr(10));
        } else if (match[1] == "<") {
          file.foreign.push_back(header);
        } else if (fs::exists(kSource / "src" / header)) {
          file.own.push_back(header);
        } else {
          file.strange.push_back(header);
        }
      }
      files.push_back(file);
    }
  }
  return files;
}

std::string room_of(const std::string& header) { return header.substr(0, header.find('/')); }

/// Rooms that the table lets a room reach through others.
Names reachable(const std::map<std::string, Room>& rooms, const std::string& room) {
  Names all;
  for (const std::string& next : rooms.at(room).may_include) {
    all.insert(next);
    all.merge(reachable(rooms, next));
  }
  return all;
}

bool names_file(const Names& files, const std::string& name) {
  return files.count(name) > 0 || files.count("*" + fs::path(name).extension().string()) > 0;
}

std::string without_comments_and_strings(std::string text) {
  text = std::regex_replace(text, std::regex("//[^\n]*"), "");
  return std::regex_replace(text, std::regex("\"(\\\\.|[^\"\\\\\n])*\""), "\"\"");
}

/// Free functions that the public headers of these rooms declare: names at the left margin.
Names declared_functions(const std::vector<SourceFile>& files, const Names& rooms) {
  const std::regex declaration(R"(\b([a-z]\w*)\()");
  Names names;
  for (const SourceFile& file : files) {
    if (!file.is_public || rooms.count(file.room) == 0) continue;
    std::stringstream text(without_comments_and_strings(read(kSource / file.path)));
    for (std::string line; std::getline(text, line);) {
      std::smatch match;
      const bool at_margin = !line.empty() && (std::isalpha(line[0]) != 0 || line[0] == '[');
      if (at_margin && std::regex_search(line, match, declaration)) names.insert(match[1]);
    }
  }
  return names;
}

}  // namespace

TEST_CASE("the table of rooms leads strictly downwards") {
  const auto rooms = read_table();
  REQUIRE(rooms.size() >= 14);
  for (const auto& [name, room] : rooms) {
    for (const std::string& other : room.may_include) {
      INFO(name << " may include " << other);
      REQUIRE(rooms.count(other) == 1);
      CHECK(rooms.at(other).layer < room.layer);
    }
  }
}

TEST_CASE("the front door only opens public headers") {
  const std::string text = read(kSource / "include/stillbase/stillbase.hpp");
  const std::regex include_line("#include <([^>]+)>");
  int headers = 0;
  for (std::sregex_iterator it(text.begin(), text.end(), include_line), end; it != end; ++it) {
    INFO((*it)[1]);
    CHECK(fs::exists(kSource / "include" / (*it)[1].str()));
    ++headers;
  }
  CHECK(headers >= 10);
}

TEST_CASE("the independent rooms stay independent, whatever the table says") {
  const auto rooms = read_table();
  CHECK(reachable(rooms, "nlp") == Names{"core"});
  CHECK(reachable(rooms, "reference") == Names{"core", "robot"});
  for (const char* planner : {"formulation", "search", "approach", "planner"}) {
    CHECK(reachable(rooms, "simulation").count(planner) == 0);
    for (const char* judge : {"verification", "audit"}) {
      CHECK(reachable(rooms, judge).count(planner) == 0);
    }
  }
  for (const char* kernel : {"dynamics", "impact", "nlp", "encounter"}) {
    for (const char* judge : {"verification", "audit"}) {
      CHECK(rooms.at(judge).may_include.count(kernel) == 0);
    }
  }
}

TEST_CASE("every include goes where the table of rooms allows") {
  const auto rooms = read_table();
  const auto files = read_sources();
  REQUIRE(files.size() > 50);
  for (const SourceFile& file : files) {
    INFO(file.path.string());
    REQUIRE(rooms.count(file.room) == 1);
    CHECK(file.strange.empty());
    for (const std::string& header : file.own) {
      INFO("includes " << header);
      const std::string other = room_of(header);
      CHECK((other == file.room || rooms.at(file.room).may_include.count(other) == 1));
      if (file.is_public) CHECK(fs::exists(kSource / "include/stillbase" / header));
    }
  }
}

TEST_CASE("public headers include Eigen and the standard library only") {
  for (const SourceFile& file : read_sources()) {
    if (!file.is_public) continue;
    for (const std::string& header : file.foreign) {
      INFO(file.path.string() << " includes " << header);
      CHECK(library_of(header).value_or("Eigen") == "Eigen");
    }
  }
}

TEST_CASE("third-party libraries appear in their named files only") {
  const auto rooms = read_table();
  const auto files = read_sources();
  Names used, present;
  for (const SourceFile& file : files) {
    present.insert(file.room);
    for (const std::string& header : file.foreign) {
      const auto library = library_of(header);
      INFO(file.path.string() << " includes " << header);
      if (!library || *library == "Eigen") continue;
      if (*library == "fmt") {
        CHECK_FALSE(file.is_header);
        continue;
      }
      const auto& allowed = rooms.at(file.room).libraries;
      REQUIRE(allowed.count(*library) == 1);
      CHECK(names_file(allowed.at(*library), file.path.filename()));
      used.insert(file.room + "/" + file.path.filename().string() + ": " + *library);
    }
  }
  // And what the table names is so.
  for (const auto& [name, room] : rooms) {
    if (present.count(name) == 0) continue;
    for (const auto& [library, named] : room.libraries) {
      for (const std::string& file : named) {
        if (file[0] == '*') continue;
        const std::string entry = std::string(name).append("/").append(file).append(": ") + library;
        INFO("src/README.md names " << entry);
        CHECK(used.count(entry) == 1);
      }
    }
  }
}

TEST_CASE("verification and audit call nothing that planning calls") {
  const auto files = read_sources();
  const Names own = {"core",       "robot",     "reference",    "target", "plan",
                     "simulation", "collision", "verification", "audit"};
  const Names allowed = declared_functions(files, own);
  const Names kernel = declared_functions(files, {"dynamics", "impact", "nlp", "encounter",
                                                  "formulation", "search", "approach", "planner"});
  REQUIRE(kernel.count("compute_jump") == 1);
  REQUIRE(kernel.count("compute_kinematics") == 1);
  Names forbidden;
  std::set_difference(kernel.begin(), kernel.end(), allowed.begin(), allowed.end(),
                      std::inserter(forbidden, forbidden.end()));
  const std::regex call(R"(\b([a-z]\w*)\s*(<[\w:]*>\s*)?\()");
  for (const SourceFile& file : files) {
    if (file.room != "verification" && file.room != "audit") continue;
    const std::string text = without_comments_and_strings(read(kSource / file.path));
    for (std::sregex_iterator it(text.begin(), text.end(), call), end; it != end; ++it) {
      INFO(file.path.string() << " calls " << (*it)[1]);
      CHECK(forbidden.count((*it)[1]) == 0);
    }
  }
}
