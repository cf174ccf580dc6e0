// The batch loop on number type S: a pack, or double as a pack of one.
#pragma once

#include <algorithm>
#include <type_traits>

#include "dynamics/null_velocity_kernel.hpp"
#include "impact/batch_kernels.hpp"
#include "impact/response_parts_kernel.hpp"

namespace stillbase {

/// Missing lanes repeat the first one, so that they hold a posture like any other.
template <class S>
void load(const double* x, std::ptrdiff_t lanes, S& out) {
  if constexpr (std::is_same_v<S, double>) {
    out = *x;
  } else if (lanes == S::kLanes) {
    out = S::load(x);
  } else {
    double all[S::kLanes];
    for (std::ptrdiff_t i = 0; i < S::kLanes; ++i) all[i] = x[i < lanes ? i : 0];
    out = S::load(all);
  }
}

template <class S>
void store(const S& value, std::ptrdiff_t lanes, double* x) {
  if constexpr (std::is_same_v<S, double>) {
    *x = value;
  } else if (lanes == S::kLanes) {
    value.store(x);
  } else {
    double all[S::kLanes];
    value.store(all);
    for (std::ptrdiff_t i = 0; i < lanes; ++i) x[i] = all[i];
  }
}

/// One pack of a batch: the rows from i on.
template <class S>
void run_pack(const RobotModel& robot, const BatchColumns& columns, const PostureImpact<S>& posture,
              std::ptrdiff_t i, std::ptrdiff_t lanes) {
  const std::ptrdiff_t count = columns.count;
  const auto put = [&](const auto& value, double* column) {
    if (column == nullptr) return;
    for (Eigen::Index j = 0; j < value.size(); ++j) store(value[j], lanes, column + i + j * count);
  };
  const auto put_number = [&](const S& value, double* column) {
    if (column != nullptr) store(value, lanes, column + i);
  };
  Vector6<S> F;
  for (int k = 0; k < 6; ++k) load(columns.F + i + k * count, lanes, F[k]);
  RigidContact<S> contact;
  if (columns.target != nullptr) {
    contact.law = columns.law;
    const double* column = columns.target + i;
    for_each_number(contact.target, [&](S& number) {
      load(column, lanes, number);
      column += count;
    });
  }
  const ImpactResponse<S> response =
      columns.target != nullptr ? respond_to_contact<S>(posture, contact) : respond<S>(posture, F);
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
  if (columns.psi == nullptr) return;

  const S p2 = p * p;
  ResponseWeights<S> weights;
  S twice_psi(0);
  for (std::size_t k = 0; k < columns.objective_parts; ++k) {
    const BatchMetric& wanted = columns.objective[k];
    Matrix3<S> metric;
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) metric(a, b) = p2 * S(wanted.G[a][b]);
    }
    with_part<S>(wanted.part, posture, response, weights, [&](const auto& value, auto&& weight) {
      weight = apply_metric<S>(metric, value);
      twice_psi += weight.dot(value);
    });
  }
  put_number(twice_psi * S(0.5), columns.psi);
  if (columns.gradient == nullptr) return;
  if (columns.target != nullptr) {
    const ContactGradient<S> all = contact_gradient<S>(robot, posture, contact, response, weights);
    put(all.phi, columns.gradient);
    put(all.turn, columns.gradient_target);
    put(all.velocity, columns.gradient_target + 3 * count);
    put(all.omega, columns.gradient_target + 6 * count);
    return;
  }
  if (columns.approach != nullptr) weights.hand_inverse_mass = -(twice_psi * yield);
  const ResponseGradient<S> gradient = response_gradient<S>(robot, posture, response, weights);
  put(gradient.phi, columns.gradient);
  put(gradient.F, columns.gradient_F);
}

template <class S>
void run_batch(const RobotModel& robot, const ImpactResistance& resistance,
               const BatchColumns& columns, std::ptrdiff_t width) {
  const std::ptrdiff_t count = columns.count;
  JointVector<S> phi(robot.n());
  for (std::ptrdiff_t i = 0; i < count;) {
    const auto lanes = [&] { return std::min(width, count - i); };
    for (int k = 0; k < robot.n(); ++k) load(columns.phi + i + k * count, lanes(), phi[k]);
    const PostureImpact<S> posture = evaluate_posture<S>(robot, resistance, phi);
    do {
      run_pack<S>(robot, columns, posture, i, lanes());
      i += width;
    } while (columns.is_one_posture && i < count);
  }
}

template <class S>
void find_null_velocities(const RobotModel& robot, const std::vector<Eigen::Index>& free,
                          const NullVelocityColumns& columns, std::ptrdiff_t width) {
  const std::ptrdiff_t count = columns.count;
  JointVector<S> phi(robot.n()), wanted(static_cast<Eigen::Index>(free.size()));
  for (std::ptrdiff_t i = 0; i < count; i += width) {
    const std::ptrdiff_t lanes = std::min(width, count - i);
    for (int k = 0; k < robot.n(); ++k) load(columns.phi + i + k * count, lanes, phi[k]);
    for (int k = 0; k < wanted.size(); ++k) load(columns.wanted + i + k * count, lanes, wanted[k]);
    const NullVelocity<S> found = nearest_null_velocity<S>(robot, phi, free, wanted);
    for (int k = 0; k < wanted.size(); ++k) {
      store(found.phidot[k], lanes, columns.phidot + i + k * count);
    }
    store(found.conditioning, lanes, columns.conditioning + i);
  }
}

}  // namespace stillbase
