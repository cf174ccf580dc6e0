#include <chrono>
#include <ctime>
#include <thread>

#include <catch2/catch.hpp>

#include <stillbase/core/phase_clock.hpp>

using namespace stillbase;

namespace {

void sleep_20_ms() { std::this_thread::sleep_for(std::chrono::milliseconds(20)); }

}  // namespace

TEST_CASE("a phase within another is not counted in the outer one") {
  using Clock = std::chrono::steady_clock;
  PhaseClock clock;
  const auto begin = Clock::now();
  {
    const PhaseClock::Phase outer(&clock, "outer");
    {
      const PhaseClock::Phase inner(&clock, "inner");
      sleep_20_ms();
    }
    sleep_20_ms();
    {
      const PhaseClock::Phase inner(&clock, "inner");
      sleep_20_ms();
    }
  }
  const double all = std::chrono::duration<double>(Clock::now() - begin).count();
  sleep_20_ms();
  REQUIRE(clock.seconds().size() == 2);
  const double outer = clock.seconds().at("outer").wall, inner = clock.seconds().at("inner").wall;
  CHECK(outer >= 0.02);
  CHECK(inner >= 0.04);
  CHECK(outer + inner <= all);
}

TEST_CASE("processor time counts work and not waiting") {
  PhaseClock clock;
  {
    const PhaseClock::Phase work(&clock, "work");
    const std::clock_t begin = std::clock();
    while (std::clock() - begin < CLOCKS_PER_SEC / 50) {
    }
  }
  {
    const PhaseClock::Phase waiting(&clock, "waiting");
    sleep_20_ms();
  }
  CHECK(clock.seconds().at("work").processor >= 0.019);
  CHECK(clock.seconds().at("waiting").processor < 0.01);
}

TEST_CASE("without a clock a phase measures nothing") {
  const PhaseClock::Phase phase(nullptr, "nothing");
  SUCCEED();
}
