// A robot in each lane of a pack: the joints of one model, mass properties of many.
#pragma once

#include <array>
#include <cassert>

#include "core/pack.hpp"
#include "simulation/lane_kernels.hpp"

namespace stillbase {

/// What the kernels of `dynamics` read of a RobotModel.
template <class S>
struct LaneRobot {
  struct Body {
    S mass;
    Vector3<S> centroid;
    Matrix3<S> inertia;
  };

  const RobotModel& pattern;
  const std::vector<Coupling>& couplings;
  const std::vector<bool>& moves_hand;
  int hand_body;
  Body base;
  std::array<Body, static_cast<std::size_t>(kMaxJointsOf<S>)> bodies;
  Vector3<S> p_hand;
  Matrix3<S> R_hand;

  explicit LaneRobot(const LaneRobots& robots)
      : pattern(*robots.pattern),
        couplings(pattern.couplings),
        moves_hand(pattern.moves_hand),
        hand_body(pattern.hand_body) {
    assert(num_bodies() <= kMaxJointsOf<S>);
    const double* from = robots.bodies;
    load(from, base);
    for (int k = 0; k < num_bodies(); ++k) {
      from += kBodyNumbers * S::kLanes;
      load(from, bodies[static_cast<std::size_t>(k)]);
    }
    for (int i = 0; i < 3; ++i) p_hand[i] = S::load(robots.hand + i * S::kLanes);
    for (int i = 0; i < 9; ++i) R_hand(i % 3, i / 3) = S::load(robots.hand + (3 + i) * S::kLanes);
  }

  int n() const { return pattern.n(); }
  int num_bodies() const { return pattern.num_bodies(); }
  const std::vector<Joint>& tree() const { return pattern.tree(); }
  bool is_coupled() const { return pattern.is_coupled(); }
  int coordinate(int k) const { return pattern.coordinate(k); }

 private:
  static void load(const double* from, Body& body) {
    body.mass = S::load(from);
    for (int i = 0; i < 3; ++i) body.centroid[i] = S::load(from + (1 + i) * S::kLanes);
    for (int i = 0; i < 9; ++i) body.inertia(i % 3, i / 3) = S::load(from + (4 + i) * S::kLanes);
  }
};

}  // namespace stillbase
