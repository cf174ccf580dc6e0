#include <algorithm>
#include <atomic>
#include <cfenv>
#include <chrono>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>

#include <stillbase/core/parallel.hpp>

using namespace stillbase;

TEST_CASE("every index is worked on once for every number of jobs") {
  const int jobs = GENERATE(0, 1, 2, 5, 64);
  std::vector<std::atomic<int>> times(100);
  CHECK(for_each_index(jobs, 100, {}, [&](int i) { ++times[static_cast<std::size_t>(i)]; }) == 100);
  for (const std::atomic<int>& each : times) CHECK(each == 1);
  CHECK(for_each_index(jobs, 0, {}, [](int) { FAIL(); }) == 0);
}

TEST_CASE("one job takes each index before it works on the next one on the caller's thread") {
  const std::thread::id here = std::this_thread::get_id();
  std::vector<int> order;
  const auto note = [&](int i) {
    CHECK(std::this_thread::get_id() == here);
    order.push_back(i);
  };
  for_each_index(1, 3, {}, note, [&](int i) { note(10 + i); });
  CHECK(order == std::vector{0, 10, 1, 11, 2, 12});
}

TEST_CASE("indices are taken in order after they were worked on") {
  const int jobs = GENERATE(1, 2, 5, 16);
  std::vector<int> results(500, 0), taken;
  const auto work = [&](int i) {
    for (int turn = 0; turn < (i * 37) % 11; ++turn) std::this_thread::yield();
    results[static_cast<std::size_t>(i)] = i * i;
  };
  const auto take = [&](int i) { taken.push_back(results[static_cast<std::size_t>(i)]); };
  CHECK(for_each_index(jobs, 500, {}, work, take) == 500);
  REQUIRE(taken.size() == 500);
  for (int i = 0; i < 500; ++i) CHECK(taken[static_cast<std::size_t>(i)] == i * i);
}

TEST_CASE("several jobs work at the same time") {
  // Each waits for the other: one after the other would wait for ever, hence the limit.
  std::atomic<int> waiting{0};
  std::atomic<bool> met{false};
  StopCondition limit;
  limit.deadline = StopCondition::Clock::now() + std::chrono::seconds(60);
  for_each_index(2, 2, {}, [&](int) {
    ++waiting;
    while (waiting < 2 && !limit.reached()) std::this_thread::yield();
    if (waiting == 2) met = true;
  });
  CHECK(met);
}

TEST_CASE("after a stop the indices before the returned number were all worked on") {
  const int jobs = GENERATE(1, 2, 5);
  std::atomic<bool> interrupted{false};
  StopCondition stop;
  stop.interrupted = &interrupted;
  std::vector<std::atomic<int>> times(1000);
  const int done = for_each_index(jobs, 1000, stop, [&](int i) {
    if (i == 20) interrupted = true;
    ++times[static_cast<std::size_t>(i)];
  });
  CHECK(done > 20);
  CHECK(done <= 20 + jobs);
  for (int i = 0; i < 1000; ++i) CHECK(times[static_cast<std::size_t>(i)] == (i < done ? 1 : 0));
  CHECK(for_each_index(jobs, 10, stop, [](int) { FAIL(); }) == 0);
}

TEST_CASE("the failure of the lowest index is thrown for every number of jobs") {
  const int jobs = GENERATE(1, 2, 5, 16);
  std::atomic<int> failures{0};
  try {
    for_each_index(jobs, 1000, {}, [&](int i) {
      if (i < 7) return;
      ++failures;
      throw std::runtime_error(std::to_string(i));
    });
    FAIL("nothing was thrown");
  } catch (const std::runtime_error& error) {
    CHECK(std::string(error.what()) == "7");
  }
  CHECK(failures <= std::max(1, jobs));
}

TEST_CASE("what is taken before a failure is the same for every number of jobs") {
  const int jobs = GENERATE(1, 2, 5, 16);
  std::vector<int> taken;
  const auto take = [&](int i) {
    if (i == 9) throw std::runtime_error("of taking");
    taken.push_back(i);
  };
  const auto work = [](int i) {
    if (i == 12) throw std::runtime_error("of working");
  };
  CHECK_THROWS_WITH(for_each_index(jobs, 100, {}, work, take), "of taking");
  CHECK(taken == std::vector{0, 1, 2, 3, 4, 5, 6, 7, 8});
}

namespace {

/// The threads that work on 16 indices, each of which takes a while.
std::set<std::thread::id> threads_of_call(int jobs) {
  std::set<std::thread::id> out;
  std::mutex mutex;
  for_each_index(jobs, 16, {}, [&](int) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const std::lock_guard lock(mutex);
    out.insert(std::this_thread::get_id());
  });
  return out;
}

}  // namespace

TEST_CASE("a crew keeps its threads from one call to the next") {
  std::set<std::thread::id> seen;
  {
    const ThreadCrew crew(3);
    for (int call = 0; call < 20; ++call) seen.merge(threads_of_call(3));
    CHECK(seen.size() > 1);
    CHECK(seen.size() <= 3);
    const ThreadCrew inner(8);  // does nothing
    seen.merge(threads_of_call(8));
    CHECK(seen.size() <= 3);
  }
  // Without it each call has threads of its own, whatever their number was before.
  std::size_t most = 0;
  for (int call = 0; call < 20; ++call) most = std::max(most, threads_of_call(5).size());
  CHECK(most > 3);
}

TEST_CASE("a crew of one job leaves calls their own threads") {
  const ThreadCrew crew(1);
  std::size_t most = 0;
  for (int call = 0; call < 20; ++call) most = std::max(most, threads_of_call(2).size());
  CHECK(most == 2);
}

TEST_CASE("calls within calls share a crew") {
  const int jobs = GENERATE(1, 2, 3, 8);
  const ThreadCrew crew(jobs);
  for (int call = 0; call < 50; ++call) {
    std::vector<std::atomic<int>> times(60);
    for_each_index(jobs, 6, {}, [&](int i) {
      for_each_index(jobs, 10, {}, [&](int k) { ++times[static_cast<std::size_t>(10 * i + k)]; });
    });
    for (const std::atomic<int>& each : times) CHECK(each == 1);
  }
}

TEST_CASE("the maker of a crew helps with the calls within while it waits") {
  const ThreadCrew crew(2);
  const std::thread::id maker = std::this_thread::get_id();
  for (int call = 0; call < 10; ++call) {
    StopCondition limit;
    limit.deadline = StopCondition::Clock::now() + std::chrono::seconds(60);
    std::atomic<int> begun{0};
    std::mutex mutex;
    std::set<std::thread::id> seen;
    for_each_index(2, 2, {}, [&](int) {
      ++begun;
      while (begun < 2 && !limit.reached()) std::this_thread::yield();
      if (std::this_thread::get_id() == maker) return;
      for_each_index(2, 60, {}, [&](int) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        const std::lock_guard lock(mutex);
        seen.insert(std::this_thread::get_id());
      });
    });
    CHECK(begun == 2);
    CHECK(seen.size() == 2);
  }
}

TEST_CASE("a crew goes on after a failure and after a stop") {
  const ThreadCrew crew(4);
  for (int call = 0; call < 50; ++call) {
    CHECK_THROWS_WITH(for_each_index(4, 40, {},
                                     [](int i) {
                                       if (i >= 7) throw std::runtime_error(std::to_string(i));
                                     }),
                      "7");
    StopCondition over;
    over.deadline = StopCondition::Clock::now();
    CHECK(for_each_index(4, 40, over, [](int) {}) == 0);
    std::atomic<int> sum{0};
    CHECK(for_each_index(4, 40, {}, [&](int i) { sum += i; }) == 40);
    CHECK(sum == 780);
  }
}

TEST_CASE("the threads of a crew round as the caller does") {
  const ThreadCrew crew(3);
  const int before = std::fegetround();
  for (const int mode : {FE_UPWARD, before, FE_DOWNWARD, before}) {
    std::fesetround(mode);
    std::atomic<int> others{0};
    for_each_index(3, 16, {}, [&](int) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      if (std::fegetround() != mode) ++others;
    });
    CHECK(others == 0);
  }
  std::fesetround(before);
}
