// The space of a query with several goals: one layer of postures for each.
//
// A state is [posture; layer * kLayerHeight]. Layers are far from each other and nothing leads from
// one to another, so that a tree grows in the world of one goal alone. Informed samplers put states
// a little above and below a layer: they belong to the nearest one.
#pragma once

#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "approach/ompl_support.hpp"

namespace stillbase {

/// rad; far more than any path is long.
inline constexpr double kLayerHeight = 1000;

class LayeredSpace : public ompl::base::RealVectorStateSpace {
 public:
  /// @param joints dimension of the postures
  explicit LayeredSpace(unsigned joints)
      : ompl::base::RealVectorStateSpace(joints + 1), joints_(joints) {}

  /// Layer of a state; negative: between two layers.
  long layer_of(const ompl::base::State* state) const {
    const double place = state->as<StateType>()->values[joints_] / kLayerHeight;
    const double nearest = std::round(place);
    return std::abs(place - nearest) < 0.25 ? std::lround(nearest) : -1;
  }

  double distance(const ompl::base::State* a, const ompl::base::State* b) const override {
    const double *p = a->as<StateType>()->values, *q = b->as<StateType>()->values;
    double square = 0;
    for (unsigned k = 0; k < joints_; ++k) square += (p[k] - q[k]) * (p[k] - q[k]);
    const long from = layer_of(a), to = layer_of(b);
    const bool same = from == to && from >= 0;
    return std::sqrt(square) + (same ? 0 : kLayerHeight);
  }

  void interpolate(const ompl::base::State* from, const ompl::base::State* to, double t,
                   ompl::base::State* state) const override {
    const bool same = layer_of(from) == layer_of(to);
    ompl::base::RealVectorStateSpace::interpolate(from, to, t, state);
    if (!same) state->as<StateType>()->values[joints_] = -kLayerHeight / 2;  // in no layer
  }

 private:
  unsigned joints_;
};

/// Draws a layer by its weight, then a posture.
class LayeredSampler : public SeededSampler {
 public:
  LayeredSampler(const ompl::base::StateSpace* space, std::uint_fast32_t seed,
                 std::vector<double> weights)
      : SeededSampler(space, seed), weights_(std::move(weights)) {
    total_ = std::accumulate(weights_.begin(), weights_.end(), 0.0);
  }

  void sampleUniform(ompl::base::State* state) override {
    SeededSampler::sampleUniform(state);
    double left = rng_.uniformReal(0, total_);
    std::size_t layer = 0;
    while (layer + 1 < weights_.size() && left > weights_[layer]) left -= weights_[layer++];
    state->as<ompl::base::RealVectorStateSpace::StateType>()->values[space_->getDimension() - 1] =
        kLayerHeight * static_cast<double>(layer);
  }

 private:
  std::vector<double> weights_;
  double total_ = 0;
};

}  // namespace stillbase
