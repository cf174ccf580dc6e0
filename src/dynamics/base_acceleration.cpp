#include <stillbase/dynamics/base_acceleration.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

namespace stillbase {

namespace {

/// Everything in the upper rows of (3) but the accelerations: F_b + R_bh' F_h - c_b.
Vector6d load(const BaseEquation& equation, const ExternalWrenches& external) {
  return external.F_b + equation.jacobian.R_bh.transpose() * external.F_h - equation.bias.c_b;
}

JointAcceleration solve(ReactionNullSpace space, const Eigen::VectorXd& right,
                        const JointVectord& xi) {
  JointAcceleration out;
  out.phiddot = space.A_pinv * right;
  out.phiddot += space.P_RNS * xi;
  out.missing = right - space.range * (space.range.transpose() * right);
  out.space = std::move(space);
  return out;
}

}  // namespace

JointAcceleration joint_acceleration_for_base(const BaseEquation& equation,
                                              const ExternalWrenches& external,
                                              const Vector6d& dot_Omega, const JointVectord& xi,
                                              double rank_tolerance) {
  const Vector6d right = load(equation, external) - equation.inertia.H_b * dot_Omega;
  return solve(full_reaction_null_space(equation.inertia, rank_tolerance), right, xi);
}

JointAcceleration joint_acceleration_for_rotation(const BaseEquation& equation,
                                                  const ExternalWrenches& external,
                                                  const Vector3d& dot_omega, const JointVectord& xi,
                                                  double rank_tolerance) {
  const auto tilde = compute_tilde_inertia(equation.inertia);
  const Vector6d all = load(equation, external);
  const Vector3d f = all.head<3>();
  // The moment about the system centroid: base translation is eliminated.
  const Vector3d right =
      all.tail<3>() - equation.inertia.r_bg.cross(f) - tilde.Htilde_omega * dot_omega;
  return solve(angular_reaction_null_space(tilde, rank_tolerance), right, xi);
}

JointAcceleration joint_acceleration_for_translation(const BaseEquation& equation,
                                                     const ExternalWrenches& external,
                                                     const Vector3d& dot_v, const JointVectord& xi,
                                                     double rank_tolerance) {
  const Matrix6d& H_b = equation.inertia.H_b;
  const Matrix3d H_vomega = H_b.topRightCorner<3, 3>();
  const Matrix3d H_omega = H_b.bottomRightCorner<3, 3>();
  const Matrix3d eliminate = H_omega.llt().solve(Matrix3d(H_vomega.transpose())).transpose();
  const Vector6d all = load(equation, external);
  const Matrix3d H_v = H_b.topLeftCorner<3, 3>() - eliminate * H_vomega.transpose();
  const Vector3d right = all.head<3>() - eliminate * all.tail<3>() - H_v * dot_v;
  return solve(translational_reaction_null_space(equation.inertia, rank_tolerance), right, xi);
}

Vector6d base_acceleration(const BaseEquation& equation, const ExternalWrenches& external,
                           const JointVectord& phiddot) {
  const Vector6d right = load(equation, external) - equation.inertia.H_bphi * phiddot;
  return equation.inertia.H_b.ldlt().solve(right);
}

JointVectord joint_torque(const BaseEquation& equation, const ExternalWrenches& external,
                          const Vector6d& dot_Omega, const JointVectord& phiddot) {
  JointVectord tau = equation.inertia.H_bphi.transpose() * dot_Omega;
  tau += equation.inertia.H_phi * phiddot;
  tau += equation.bias.c_phi;
  tau -= equation.jacobian.J_phi.transpose() * external.F_h;
  return tau;
}

}  // namespace stillbase
