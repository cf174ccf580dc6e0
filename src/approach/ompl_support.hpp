// What every use of OMPL here shares: silence, and random numbers that depend on nothing but a
// seed.
//
// OMPL draws the seeds of its generators from one global sequence, which threads share. Generators
// that can be reached get local seeds; planners that hide theirs run alone, with the global
// sequence set just before.
#pragma once

#include <cstdint>
#include <mutex>
#include <shared_mutex>

#include <ompl/base/spaces/RealVectorStateSpace.h>

#include <stillbase/core/random.hpp>

namespace stillbase {

/// OMPL writes to the console by itself; outcomes are reported by status instead.
void silence_ompl();

/// OMPL's seeds are 32 bits; 0 means "draw one from the clock".
std::uint_fast32_t local_seed(Random& random);

/// Held while OMPL works: shared by those that seed every generator themselves.
std::shared_lock<std::shared_mutex> share_ompl();
/// The same alone, with OMPL's global sequence of seeds begun anew.
std::unique_lock<std::shared_mutex> own_ompl(std::uint_fast32_t seed);

class SeededSampler : public ompl::base::RealVectorStateSampler {
 public:
  SeededSampler(const ompl::base::StateSpace* space, std::uint_fast32_t seed)
      : ompl::base::RealVectorStateSampler(space) {
    rng_.setLocalSeed(seed);
  }
};

}  // namespace stillbase
