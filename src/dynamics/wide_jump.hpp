// compute_jump() from joint positions on in wide registers: poses, inertia and factor are nowhere
// written down.
#pragma once

#include "dynamics/wide_factor.hpp"
#include "dynamics/wide_inertia.hpp"

namespace stillbase {

namespace {

/// The equations of a jump, the base translation eliminated.
struct JumpEquations {
  Wide3x3 Htilde_omega;
  V Htilde_omegaphi[kWideBodies];
  WideMatrix Htilde_phi;      ///< with the added inertia
  double x[3 + kWideBodies];  ///< right-hand side, then the solution

  /// Of the lower triangle.
  double entry(Eigen::Index i, Eigen::Index j) const {
    if (i < 3) return numbers(Htilde_omega.c0)[i + 4 * j];
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
};

void wide_jump(const RobotModel& robot, const WideJoints& at, const double* added_inertia,
               const double* F, const WideMotion& out) {
  const Joint* const joints = &robot.joints[0];
  const auto n = static_cast<int>(robot.bodies.size());
  WidePose poses[kWideBodies];
  place_bodies(robot, at, poses);
  const WideArm arm(
      robot, [&poses](int k) -> const WidePose& { return poses[k]; }, [](int, const Wide3x3&) {});
  V r_bh = load3(numbers(robot.p_hand));
  if (robot.hand_body != kBase) {
    const WidePose& pose = poses[robot.hand_body];
    r_bh = pose.o + times(pose.R, numbers(robot.p_hand));
  }
  const double mass = arm.total.h[3], inverse_mass = 1 / mass;
  const V r_bg = arm.total.h * all(inverse_mass);
  const V f = load3(F), moment = load3(F + 3) + cross(r_bh, f);  // about the base centroid
  const V v_g = f * all(inverse_mass);                           // of the system centroid

  JumpEquations equations;
  const Wide3x3& I = arm.total.I;
  const Wide3x3 of_mass = point_mass(mass, r_bg).I;
  equations.Htilde_omega = {I.c0 - of_mass.c0, I.c1 - of_mass.c1, I.c2 - of_mass.c2};
  store3(equations.x, moment - cross(r_bg, f));
  fill(robot, arm, inverse_mass, equations.Htilde_phi);
  bool moves_hand[kWideBodies] = {};  // as the robot's list, whose functions are not for this file
  for (int k = robot.hand_body; k != kBase; k = joints[k].parent) moves_hand[k] = true;
  for (int k = 0; k < n; ++k) {
    equations.Htilde_omegaphi[k] = arm.L[k] - cross(r_bg, arm.p[k]);
    V power = -arm.p[k] * v_g;
    if (moves_hand[k]) power += arm.v[k] * f + arm.w[k] * moment;
    equations.x[3 + k] = sum(power);
    equations.Htilde_phi.columns[k][k] += added_inertia[k];
  }
  equations.solve(n);

  V p = f;
  for (int k = 0; k < n; ++k) {
    out.phidot[k] = equations.x[3 + k];
    p -= arm.p[k] * all(out.phidot[k]);
  }
  const V omega = load3(equations.x);
  store3(out.Omega, p * all(inverse_mass) - cross(omega, r_bg));
  store3(out.Omega + 3, omega);
}

}  // namespace

}  // namespace stillbase
