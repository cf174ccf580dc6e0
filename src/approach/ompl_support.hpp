// Shared by every use of OMPL here: no console output, and random numbers that depend on a seed
// alone.
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

#include "approach/path_planner.hpp"

namespace stillbase {

/// A seed of 32 bits, never 0: OMPL would take one from the clock.
std::uint_fast32_t local_seed(Random& random);

/// Held while OMPL works: shared by those that seed every generator themselves.
std::shared_lock<std::shared_mutex> share_ompl();
/// Exclusive, with OMPL's global sequence of seeds restarted.
std::unique_lock<std::shared_mutex> own_ompl(std::uint_fast32_t seed);

/// A class of OMPL with a generator `rng_` of its own, seeded.
template <class Base>
class Seeded : public Base {
 public:
  template <class Argument>
  Seeded(const Argument& argument, std::uint_fast32_t seed) : Base(argument) {
    this->rng_.setLocalSeed(seed);
  }
};
using SeededSampler = Seeded<ompl::base::RealVectorStateSampler>;

inline const double* values_of(const ompl::base::State* state) {
  return state->as<ompl::base::RealVectorStateSpace::StateType>()->values;
}
inline double* values_of(ompl::base::State* state) {
  return state->as<ompl::base::RealVectorStateSpace::StateType>()->values;
}
inline JointVectord posture_of(const ompl::base::State* state, unsigned joints) {
  return Eigen::Map<const Eigen::VectorXd>(values_of(state), joints);
}

/// Bounds of a query as OMPL's, in a space of `dimension` >= joints.
ompl::base::RealVectorBounds bounds_of(const PathQuery& query, unsigned dimension);

}  // namespace stillbase
