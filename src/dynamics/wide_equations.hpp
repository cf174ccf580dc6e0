// The floating robot's equations in wide registers, the base translation eliminated: those of a
// jump (6) and of the motion (3), which have the same matrix.
#pragma once

#include "dynamics/wide_factor.hpp"
#include "dynamics/wide_inertia.hpp"

namespace stillbase {

namespace {

struct WideEquations {
  WideWhole whole;
  V Htilde_omegaphi[kWideBodies];
  WideMatrix Htilde_phi;      ///< with the added inertia
  double x[3 + kWideBodies];  ///< right-hand side, then the solution

  /// All but the right-hand side. @param added_inertia of each joint
  [[gnu::always_inline]] WideEquations(const RobotModel& robot, const WideArm& arm,
                                       const double* added_inertia)
      : whole(arm.total) {
    fill(robot, arm, whole.inverse_mass, Htilde_phi);
    const auto n = static_cast<int>(robot.bodies.size());
    for (int k = 0; k < n; ++k) {
      Htilde_omegaphi[k] = arm.L[k] - cross(whole.r_bg, arm.p[k]);
      Htilde_phi.columns[k][k] += added_inertia[k];
    }
  }

  /// Of the lower triangle.
  double entry(Eigen::Index i, Eigen::Index j) const {
    if (i < 3) return numbers(whole.Htilde_omega.c0)[i + 4 * j];
    if (j < 3) return numbers(Htilde_omegaphi[i - 3])[j];
    return Htilde_phi.columns[j - 3][i - 3];
  }

  void solve(int joints) {
    with_equations(joints, [this](auto n) {
      namespace loops = cholesky_loops;
      constexpr Eigen::Index room = kRoomFor<decltype(n)>;
      WideNumber A[room * room], b[room];
      factorize_entries(
          n, [this](auto i, auto j) { return entry(i, j); }, A);
      loops::up(loops::kFirst, n, [&](auto i) { b[i] = WideNumber(x[i]); });
      loops::solve_scaled(A, n, n, b);
      loops::solve_transposed(A, n, n, b);
      loops::up(loops::kFirst, n, [&](auto i) { x[i] = b[i].x; });
    });
  }

  /// The whole motion from a solution. @param f linear part of what acts, about the base
  [[gnu::always_inline]] void put_motion(int joints, const WideArm& arm, const V& f,
                                         const WideMotion& out) const {
    V p = f;
    for (int k = 0; k < joints; ++k) {
      out.phidot[k] = x[3 + k];
      p -= arm.p[k] * all(out.phidot[k]);
    }
    const V omega = load3(x);
    store3(out.Omega, whole.base_velocity(p, omega));
    store3(out.Omega + 3, omega);
  }
};

}  // namespace

}  // namespace stillbase
