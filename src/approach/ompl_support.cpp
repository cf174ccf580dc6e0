#include "approach/ompl_support.hpp"

#include <stdexcept>

#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

namespace stillbase {

namespace {

/// OMPL writes to the console by itself; outcomes are reported by status instead.
class SilentLog : public ompl::msg::OutputHandler {
 public:
  void log(const std::string&, ompl::msg::LogLevel, const char*, int) override {}
};

std::shared_mutex& ompl_in_use() {
  static SilentLog log;
  static std::once_flag once;
  std::call_once(once, [] { ompl::msg::useOutputHandler(&log); });
  static std::shared_mutex mutex;
  return mutex;
}

}  // namespace

std::uint_fast32_t local_seed(Random& random) {
  return static_cast<std::uint_fast32_t>(random.next() & 0x7fffffffu) | 1u;
}

std::shared_lock<std::shared_mutex> share_ompl() { return std::shared_lock(ompl_in_use()); }

std::unique_lock<std::shared_mutex> own_ompl(std::uint_fast32_t seed) {
  std::unique_lock lock(ompl_in_use());
  // Logs an error when it is not the first call, and sets the seed all the same.
  ompl::RNG::setSeed(seed);
  return lock;
}

ompl::base::RealVectorBounds bounds_of(const PathQuery& query, unsigned dimension) {
  ompl::base::RealVectorBounds bounds(dimension);
  for (Eigen::Index k = 0; k < query.lower.size(); ++k) {
    bounds.setLow(static_cast<unsigned>(k), query.lower[k]);
    bounds.setHigh(static_cast<unsigned>(k), query.upper[k]);
  }
  return bounds;
}

void PathQuery::check() const {
  bool sound = !ends.empty() && lower.allFinite() && upper.allFinite() &&
               (lower.array() < upper.array()).all();
  for (const PathEnds& end : ends) {
    sound = sound && end.start.allFinite() && end.goal.allFinite() && end.weight > 0;
  }
  if (!sound) {
    throw std::invalid_argument("path query with numbers that are not finite or empty bounds");
  }
}

}  // namespace stillbase
