// No case is lost, whatever dies.
#include <catch2/catch.hpp>

#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include <stillbase/campaign/campaign.hpp>
#include <stillbase/core/error.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/core/sha256.hpp>

#include "support/temporary_folder.hpp"

using namespace stillbase;

namespace {

std::string case_list(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += "case " + std::to_string(i) + "\n";
  return text;
}

std::string hashed(const std::string& text) { return sha256_hex(text); }

CampaignOptions in(const TemporaryFolder& folder, int jobs = 1, Shard shard = {}) {
  CampaignOptions options;
  options.folder = folder.folder();
  options.jobs = jobs;
  options.shard = shard;
  return options;
}

/// What a merge says, as one text.
std::string text_of(const MergedCampaign& merged) {
  std::string text = merged.cases_sha256 + "\n";
  for (const CaseRecord& record : merged.records) {
    text +=
        std::to_string(record.number) + " " + to_string(record.status) + " " + record.text + "\n";
  }
  return text;
}

/// Runs a campaign in a process that is killed after a while, until it ends by itself.
int kills_until_done(const TemporaryFolder& folder, const std::string& cases, int jobs,
                     Random& random, int most) {
  for (int kills = 0;; ++kills) {
    const pid_t pid = fork();
    if (pid == 0) {
      int code = 1;
      try {
        const CampaignRun run = run_campaign(cases, in(folder, jobs), [](const std::string& text) {
          usleep(3000);
          return hashed(text);
        });
        code = run.is_complete() ? 0 : 1;
      } catch (...) {
      }
      _exit(code);
    }
    if (kills < most) {
      usleep(static_cast<useconds_t>(random.uniform(1e3, 60e3)));
      kill(pid, SIGKILL);
    }
    int status = 0;
    waitpid(pid, &status, 0);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return kills;
    if (WIFEXITED(status)) throw std::runtime_error("the campaign failed");
  }
}

std::string undisturbed(const std::string& cases) {
  const TemporaryFolder folder;
  run_campaign(cases, in(folder), hashed);
  return text_of(merge_campaign(folder.folder()));
}

}  // namespace

TEST_CASE("results are the same for every number of workers and shards") {
  const std::string cases = case_list(37);
  const std::string expected = undisturbed(cases);
  for (const int jobs : {1, 2, 4}) {
    const TemporaryFolder folder;
    const CampaignRun run = run_campaign(cases, in(folder, jobs), hashed);
    CHECK(run.is_complete());
    CHECK(run.recorded == 37);
    CHECK(text_of(merge_campaign(folder.folder())) == expected);
  }
  const TemporaryFolder folder;
  for (const int i : {2, 0, 1}) run_campaign(cases, in(folder, 2, {i, 3}), hashed);
  const MergedCampaign merged = merge_campaign(folder.folder());
  CHECK(merged.is_complete());
  CHECK(merged.duplicates == 0);
  CHECK(text_of(merged) == expected);
}

TEST_CASE("a case that throws is a record, not the end") {
  const std::string cases = case_list(6);
  const TemporaryFolder folder;
  const CampaignRun run = run_campaign(cases, in(folder, 2), [](const std::string& text) {
    if (text == "case 3") throw std::runtime_error("two\nlines");
    return hashed(text);
  });
  CHECK(run.is_complete());
  CHECK(run.failed == 1);
  const MergedCampaign merged = merge_campaign(folder.folder());
  CHECK(merged.is_complete());
  CHECK(merged.records[3].status == CaseStatus::Crashed);
  CHECK(merged.records[3].text == "two lines");
  CHECK(merged.records[4].text == hashed("case 4"));
}

TEST_CASE("a case that is refused before its worker begins leaves no record") {
  const std::string cases = case_list(6);
  const TemporaryFolder folder;
  CampaignOptions options = in(folder);
  options.check_case = [](const std::string& text) {
    if (text == "case 3") throw FileError("not there");
  };
  CHECK_THROWS_AS(run_campaign(cases, options, hashed), FileError);
  CHECK(merge_campaign(folder.folder()).missing == std::vector<int>{3, 4, 5});
  CHECK(run_campaign(cases, in(folder), hashed).is_complete());
  CHECK(text_of(merge_campaign(folder.folder())) == undisturbed(cases));
}

TEST_CASE("a case whose worker was killed is tried again and is then as any other") {
  const std::string cases = case_list(6);
  const TemporaryFolder folder;
  const CampaignRun run = run_campaign(cases, in(folder, 2), [&](const std::string& text) {
    const std::filesystem::path seen = folder.folder() / ("seen " + text);
    const bool is_first = !std::filesystem::exists(seen);
    std::ofstream(seen) << "x";
    if (text == "case 2" && is_first) std::raise(SIGKILL);
    return hashed(text);
  });
  CHECK(run.is_complete());
  CHECK(run.failed == 0);
  const MergedCampaign merged = merge_campaign(folder.folder());
  CHECK(merged.is_complete());
  CHECK(text_of(merged) == undisturbed(cases));
}

TEST_CASE(
    "a case whose worker always dies leaves the campaign incomplete until a run finishes it") {
  const std::string cases = case_list(6);
  const TemporaryFolder folder;
  const auto deadly = [&](const std::string& text) {
    std::ofstream(folder.folder() / "tries", std::ios::app) << (text == "case 2" ? "x" : "");
    if (text == "case 2") std::raise(SIGKILL);
    return hashed(text);
  };
  CampaignOptions options = in(folder, 2);
  options.tries = 3;
  const CampaignRun run = run_campaign(cases, options, deadly);
  CHECK_FALSE(run.is_complete());
  CHECK(run.recorded == 5);
  CHECK(run.died == std::vector<int>{2});
  CHECK(std::filesystem::file_size(folder.folder() / "tries") == 3);
  const MergedCampaign merged = merge_campaign(folder.folder());
  CHECK_FALSE(merged.is_complete());
  CHECK(merged.missing == std::vector<int>{2});
  REQUIRE(merged.records.size() == 6);
  CHECK(merged.records[2].status == CaseStatus::Died);
  CHECK(merged.records[2].text.find("3 tries") != std::string::npos);

  CHECK_FALSE(run_campaign(cases, options, deadly).is_complete());
  CHECK(std::filesystem::file_size(folder.folder() / "tries") == 6);
  CHECK(merge_campaign(folder.folder()).contradictory.empty());
  CHECK(run_campaign(cases, options, hashed).is_complete());
  CHECK(text_of(merge_campaign(folder.folder())) == undisturbed(cases));
}

TEST_CASE("a SIGTERM to all processes of a campaign leaves no case behind") {
  const std::string cases = case_list(30);
  const TemporaryFolder folder;
  const pid_t pid = fork();
  if (pid == 0) {
    setpgid(0, 0);
    static std::atomic<bool> interrupted{false};
    std::signal(SIGTERM, [](int) { interrupted = true; });
    CampaignOptions options = in(folder, 4);
    options.stop.interrupted = &interrupted;
    int code = 1;
    try {
      run_campaign(cases, options, [](const std::string& text) {
        usleep(50'000);
        return hashed(text);
      });
      code = 0;
    } catch (...) {
    }
    _exit(code);
  }
  while (!std::filesystem::exists(folder.folder() / "journal-1-of-1.txt") ||
         std::filesystem::file_size(folder.folder() / "journal-1-of-1.txt") == 0) {
    usleep(1000);
  }
  usleep(20'000);
  kill(-pid, SIGTERM);
  int status = 0;
  waitpid(pid, &status, 0);
  CHECK((WIFEXITED(status) && WEXITSTATUS(status) == 0));
  const MergedCampaign part = merge_campaign(folder.folder());
  CHECK_FALSE(part.is_complete());
  for (const CaseRecord& record : part.records) CHECK(record.status == CaseStatus::Finished);
  CHECK(run_campaign(cases, in(folder, 2), hashed).is_complete());
  CHECK(text_of(merge_campaign(folder.folder())) == undisturbed(cases));
}

TEST_CASE("a run that begins again finds what is done and does the rest") {
  const std::string cases = case_list(10);
  const TemporaryFolder folder;
  std::atomic<bool> interrupted = false;
  CampaignOptions options = in(folder);
  options.stop.interrupted = &interrupted;
  options.on_progress = [&](int done, int) { interrupted = done >= 4; };
  const CampaignRun first = run_campaign(cases, options, hashed);
  CHECK_FALSE(first.is_complete());
  const MergedCampaign part = merge_campaign(folder.folder());
  CHECK_FALSE(part.is_complete());
  CHECK(part.missing.size() == static_cast<std::size_t>(10 - first.recorded));
  const CampaignRun second = run_campaign(cases, in(folder, 2), hashed);
  CHECK(second.found == first.recorded);
  CHECK(second.is_complete());
  CHECK(text_of(merge_campaign(folder.folder())) == undisturbed(cases));
  // Other shards of the same folder know what is done, too.
  CHECK(run_campaign(cases, in(folder, 1, {1, 2}), hashed).recorded == 0);
}

TEST_CASE("killed five times at random, a campaign ends as if undisturbed") {
  const std::string cases = case_list(40);
  const TemporaryFolder folder;
  Random random(1, 77);
  kills_until_done(folder, cases, 2, random, 5);
  const MergedCampaign merged = merge_campaign(folder.folder());
  CHECK(merged.duplicates == 0);
  CHECK(text_of(merged) == undisturbed(cases));
}

TEST_CASE("killed a thousand times at random, a campaign ends as if undisturbed", "[.slow]") {
  Random random(2, 77);
  int kills = 0;
  const std::string cases = case_list(60);
  const std::string expected = undisturbed(cases);
  while (kills < 1000) {
    const TemporaryFolder folder;
    kills += kills_until_done(folder, cases, 1 + random.index(3), random, 1000);
    const MergedCampaign merged = merge_campaign(folder.folder());
    REQUIRE(merged.duplicates == 0);
    REQUIRE(text_of(merged) == expected);
  }
}

TEST_CASE("a torn record is cut off, a damaged one is done again") {
  const std::string cases = case_list(5);
  const TemporaryFolder folder;
  run_campaign(cases, in(folder), hashed);
  const std::filesystem::path journal = folder.folder() / "journal-1-of-1.txt";
  std::string text;
  {
    std::ifstream stream(journal, std::ios::binary);
    text.assign(std::istreambuf_iterator<char>(stream), {});
  }
  // The last line loses its end, the first one a digit of its result.
  text.resize(text.size() - 5);
  const std::size_t end = text.find('\n');
  text[end - 1] = text[end - 1] == '0' ? '1' : '0';
  std::ofstream(journal, std::ios::binary) << text;
  const MergedCampaign broken = merge_campaign(folder.folder());
  CHECK(broken.damaged == 1);
  CHECK(broken.missing.size() == 2);
  const CampaignRun again = run_campaign(cases, in(folder), hashed);
  CHECK(again.recorded == 2);
  const MergedCampaign merged = merge_campaign(folder.folder());
  CHECK(merged.is_complete());
  CHECK(text_of(merged) == undisturbed(cases));
}

TEST_CASE("records that contradict each other are no complete campaign") {
  const std::string cases = case_list(2);
  const TemporaryFolder folder, other;
  run_campaign(cases, in(folder, 1, {0, 1}), hashed);
  run_campaign(cases, in(other, 1, {0, 2}), [](const std::string&) { return "else"; });
  std::filesystem::copy(other.folder() / "journal-1-of-2.txt",
                        folder.folder() / "journal-1-of-2.txt");
  const MergedCampaign merged = merge_campaign(folder.folder());
  CHECK_FALSE(merged.is_complete());
  CHECK(merged.contradictory == std::vector<int>{0});
}

TEST_CASE("a folder belongs to one list of cases, a shard to one run") {
  const TemporaryFolder folder;
  run_campaign(case_list(3), in(folder), hashed);
  CHECK_THROWS_AS(run_campaign(case_list(4), in(folder), hashed), InputError);
  CHECK_THROWS_AS(merge_campaign((folder.folder() / "nothing").string()), InputError);
  CHECK_THROWS_AS(shard_from_text("0/2"), std::invalid_argument);
  CHECK_THROWS_AS(shard_from_text("3/2"), std::invalid_argument);
  CHECK_THROWS_AS(shard_from_text("2"), std::invalid_argument);
  CHECK_THROWS_AS(shard_from_text("1/2x"), std::invalid_argument);
  CHECK(shard_from_text("2/4").index == 1);
  CHECK_THROWS_AS(cases_from_text("a\na\n", "cases"), InputError);
  CHECK_THROWS_AS(cases_from_text("", "cases"), InputError);
}
