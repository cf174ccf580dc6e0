#include "approach/ompl_support.hpp"

#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

namespace stillbase {

namespace {

class SilentLog : public ompl::msg::OutputHandler {
 public:
  void log(const std::string&, ompl::msg::LogLevel, const char*, int) override {}
};

std::shared_mutex& ompl_in_use() {
  static std::shared_mutex mutex;
  return mutex;
}

}  // namespace

void silence_ompl() {
  static std::once_flag once;
  static SilentLog log;
  std::call_once(once, [] { ompl::msg::useOutputHandler(&log); });
}

std::uint_fast32_t local_seed(Random& random) {
  return static_cast<std::uint_fast32_t>(random.next() & 0x7fffffffu) | 1u;
}

std::shared_lock<std::shared_mutex> share_ompl() {
  silence_ompl();
  return std::shared_lock(ompl_in_use());
}

std::unique_lock<std::shared_mutex> own_ompl(std::uint_fast32_t seed) {
  silence_ompl();
  std::unique_lock lock(ompl_in_use());
  // Complains on the console when it is not the first call, and does what it is asked for.
  ompl::RNG::setSeed(seed);
  return lock;
}

}  // namespace stillbase
