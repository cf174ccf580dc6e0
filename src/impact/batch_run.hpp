// The batch loop on number type S: a pack, or double as a pack of one.
#pragma once

#include <algorithm>

#include "impact/batch_kernels.hpp"

namespace stillbase {

namespace {

inline void load(const double* x, std::ptrdiff_t, double& out) { out = *x; }
inline void store(const double& value, std::ptrdiff_t, double* x) { *x = value; }

/// Missing lanes repeat the first one, so that they hold a posture like any other.
template <class S>
void load(const double* x, std::ptrdiff_t lanes, S& out) {
  if (lanes == S::kLanes) {
    out = S::load(x);
    return;
  }
  double all[S::kLanes];
  for (std::ptrdiff_t i = 0; i < S::kLanes; ++i) all[i] = x[i < lanes ? i : 0];
  out = S::load(all);
}

template <class S>
void store(const S& value, std::ptrdiff_t lanes, double* x) {
  if (lanes == S::kLanes) {
    value.store(x);
    return;
  }
  double all[S::kLanes];
  value.store(all);
  for (std::ptrdiff_t i = 0; i < lanes; ++i) x[i] = all[i];
}

template <class S>
void run_batch(const RobotModel& robot, const ImpactResistance& resistance,
               const BatchColumns& columns, std::ptrdiff_t width) {
  const std::ptrdiff_t count = columns.count;
  JointVector<S> phi(robot.n());
  Vector6<S> F;
  for (std::ptrdiff_t i = 0; i < count; i += width) {
    const std::ptrdiff_t lanes = std::min(width, count - i);
    const auto put = [&](const auto& value, double* column) {
      if (column == nullptr) return;
      for (Eigen::Index j = 0; j < value.size(); ++j)
        store(value[j], lanes, column + i + j * count);
    };
    const auto put_number = [&](const S& value, double* column) {
      if (column != nullptr) store(value, lanes, column + i);
    };
    for (int k = 0; k < robot.n(); ++k) load(columns.phi + i + k * count, lanes, phi[k]);
    for (int k = 0; k < 6; ++k) load(columns.F + i + k * count, lanes, F[k]);

    const PostureImpact<S> posture = evaluate_posture<S>(robot, resistance, phi);
    const ImpactResponse<S> response = respond<S>(posture, F);
    S p(1), yield(1);  // yield: 1 / (hand's + target's inverse mass)
    if (columns.approach != nullptr) {
      S approach, target;
      load(columns.approach + i, lanes, approach);
      load(columns.target_inverse_mass + i, lanes, target);
      yield = S(1) / (response.hand_inverse_mass + target);
      p = approach * yield;
    }
    put(response.d.Delta_Omega, columns.Delta_Omega);
    put(response.base, columns.base);
    put(response.total, columns.total);
    put_number(response.hand_inverse_mass, columns.hand_inverse_mass);
    put_number(p, columns.p);
    if (columns.psi == nullptr) continue;

    const BatchObjective& objective = columns.objective;
    const S p2 = p * p;
    ResponseWeights<S> weights;
    weights.omega = response.omega() * (p2 * S(objective.omega));
    weights.base = response.base * (p2 * S(objective.base));
    weights.total = response.total * (p2 * S(objective.total));
    const S twice_psi = weights.omega.dot(response.omega()) + weights.base.dot(response.base) +
                        weights.total.dot(response.total);
    if (columns.approach != nullptr) weights.hand_inverse_mass = -(twice_psi * yield);
    put_number(twice_psi * S(0.5), columns.psi);
    put(response_gradient<S>(robot, posture, response, weights).phi, columns.gradient);
  }
}

}  // namespace

}  // namespace stillbase
