// The lines of <stillbase/impact/gradient.hpp>, for any number type.
#pragma once

#include <type_traits>

#include <stillbase/impact/gradient.hpp>

#include "dynamics/cholesky.hpp"
#include "dynamics/inertia_factor_kernel.hpp"
#include "dynamics/inertia_kernel.hpp"
#include "dynamics/wide_kernel.hpp"

namespace stillbase {

/// Linear and angular part of a twist or a momentum, about the base centroid.
template <class S>
struct SpatialVector {
  Vector3<S> v;
  Vector3<S> w;
};

/// Twist of body k's joint under unit rate of its coordinate.
template <class S>
inline SpatialVector<S> joint_axis(const RobotModel& robot, const Kinematics<S>& kin, int k) {
  SpatialVector<S> axis;
  put_axis(robot, robot.tree()[k], kin, k, axis.v, axis.w);
  return axis;
}

template <class S>
using JointAxes = BodyWorkspace<SpatialVector<S>, S>;

/// The sums over the tree in wide registers; null: those of the templates.
template <class S>
static const WideKernel* registers_for(const RobotModel& robot) {
  if constexpr (std::is_same_v<S, double>) {
    return wide_kernel(robot);
  } else {
    return nullptr;
  }
}

inline KnownWidePoses plain_poses(const Kinematics<double>& kin) {
  return {kin.R.data()->data(), kin.o.data()->data(), kin.c.data()->data()};
}

/// For the sums over the tree; not set where wide registers take them.
template <class S>
static JointAxes<S> joint_axes(const RobotModel& robot, const Kinematics<S>& kin) {
  JointAxes<S> axes;
  if (registers_for<S>(robot) != nullptr) return axes;
  for (int k = 0; k < kin.n; ++k) axes[k] = joint_axis(robot, kin, k);
  return axes;
}

/// A motion, and an impulse [force; moment about the hand's origin] that the hand carries with it.
template <class S>
struct LoadedMotion {
  const GeneralizedMotion<S>& x;
  const Vector6<S>& F;
};

/// Twists of all bodies and momenta of the subtrees that they carry, less the impulse at the hand.
template <class S>
struct SubtreeMomenta {
  JointAxes<S> V;
  JointAxes<S> P;

  SubtreeMomenta(const RobotModel& robot, const PostureImpact<S>& posture, const JointAxes<S>& axes,
                 const LoadedMotion<S>& loaded) {
    const Kinematics<S>& kin = posture.kinematics;
    const GeneralizedMotion<S>& x = loaded.x;
    const SpatialVector<S> base{x.Omega.template head<3>(), x.Omega.template tail<3>()};
    const std::vector<Joint>& tree = robot.tree();
    for (int k = 0; k < kin.n; ++k) {
      const int parent = tree[k].parent, coordinate = robot.coordinate(k);
      const SpatialVector<S>& inherited = parent == kBase ? base : V[parent];
      V[k].v = inherited.v + axes[k].v * x.phidot[coordinate];
      V[k].w = inherited.w + axes[k].w * x.phidot[coordinate];
      P[k].v = (V[k].v + V[k].w.cross(kin.c[k])) * S(robot.bodies[k].mass);
      P[k].w = kin.c[k].cross(P[k].v);
      P[k].w.noalias() += posture.inertia.I[k] * V[k].w;
    }
    if (robot.hand_body != kBase) {
      const Vector3<S> f = loaded.F.template head<3>();
      P[robot.hand_body].v -= f;
      P[robot.hand_body].w -= loaded.F.template tail<3>() + kin.r_bh.cross(f);
    }
    for (int k = kin.n - 1; k >= 0; --k) {
      const int parent = tree[k].parent;
      if (parent == kBase) continue;
      P[parent].v += P[k].v;
      P[parent].w += P[k].w;
    }
  }
};

/// gradient += d/dphi (a' J' F_b + b' J' F_a - a' H b), motions and impulses fixed in B: each
/// subtree and the impulse on it move as a rigid body under its joint, so only the twist that it
/// inherits counts. That the impulses do not turn with the hand adds their moment on its velocity.
/// @param hand_moment J a x F_b + J b x F_a, x of the linear parts plus x of the angular parts
template <class S>
static void add_motion_gradient(const RobotModel& robot, const PostureImpact<S>& posture,
                                const JointAxes<S>& axes, const LoadedMotion<S>& a,
                                const LoadedMotion<S>& b, const Vector3<S>& hand_moment,
                                JointVector<S>& gradient) {
  if constexpr (std::is_same_v<S, double>) {
    if (const WideKernel* wide = registers_for<S>(robot); wide != nullptr) {
      const auto plain = [](const LoadedMotion<S>& one) {
        return WideLoadedMotion{one.x.Omega.data(), one.x.phidot.data(), one.F.data()};
      };
      wide->motion_gradient(robot, plain_poses(posture.kinematics),
                            posture.inertia.I.data()->data(),
                            {posture.kinematics.r_bh.data(), hand_moment.data()}, plain(a),
                            plain(b), gradient.data());
      return;
    }
  }
  const SubtreeMomenta<S> of_a(robot, posture, axes, a);
  const SubtreeMomenta<S> of_b(robot, posture, axes, b);
  for (int k = 0; k < posture.kinematics.n; ++k) {
    // (S_k x V_a) . P_b + (S_k x V_b) . P_a, x the cross product of twists, with S_k taken out.
    const SpatialVector<S>&V_a = of_a.V[k], &P_a = of_a.P[k], &V_b = of_b.V[k], &P_b = of_b.P[k];
    const Vector3<S> linear = V_a.w.cross(P_b.v) + V_b.w.cross(P_a.v);
    const Vector3<S> angular =
        V_a.v.cross(P_b.v) + V_b.v.cross(P_a.v) + V_a.w.cross(P_b.w) + V_b.w.cross(P_a.w);
    gradient[robot.coordinate(k)] += axes[k].v.dot(linear) + axes[k].w.dot(angular);
  }
  const std::vector<Joint>& tree = robot.tree();
  for (int k = robot.hand_body; k != kBase; k = tree[k].parent) {
    gradient[robot.coordinate(k)] += axes[k].w.dot(hand_moment);
  }
}

/// gradient += d/dphi (a' H b), a and b fixed.
template <class S>
static void add_inertia_gradient(const RobotModel& robot, const PostureImpact<S>& posture,
                                 const JointAxes<S>& axes, const GeneralizedMotion<S>& a,
                                 const GeneralizedMotion<S>& b, JointVector<S>& gradient) {
  const Vector6<S> none = Vector6<S>::Zero();
  const GeneralizedMotion<S> minus_a{-a.Omega, -a.phidot};
  add_motion_gradient<S>(robot, posture, axes, {minus_a, none}, {b, none}, Vector3<S>::Zero(),
                         gradient);
}

/// Of linear and of angular parts, summed.
template <class S>
static Vector3<S> cross_by_parts(const Vector6<S>& a, const Vector6<S>& b) {
  const Vector3<S> a_v = a.template head<3>(), a_w = a.template tail<3>();
  return a_v.cross(Vector3<S>(b.template head<3>())) + a_w.cross(Vector3<S>(b.template tail<3>()));
}

/// gradient += d/dphi (u' Htilde_omega w), u and w fixed: the robot turns as one body about its
/// centroid g, so every body has the same twist and the momenta are those of the composite bodies.
template <class S>
static void add_locked_rotation_gradient(const RobotModel& robot, const PostureImpact<S>& posture,
                                         const JointAxes<S>& axes, const Vector3<S>& u,
                                         const Vector3<S>& w, JointVector<S>& gradient) {
  const Vector3<S>& r = posture.inertia.r_bg;
  if constexpr (std::is_same_v<S, double>) {
    if (const WideKernel* wide = registers_for<S>(robot); wide != nullptr) {
      wide->rotation_gradient(robot, plain_poses(posture.kinematics), &posture.inertia.subtree[0].m,
                              {r.data(), u.data(), w.data()}, gradient.data());
      return;
    }
  }
  const S uw = u.dot(w), ur = u.dot(r), wr = w.dot(r);
  for (int k = 0; k < posture.kinematics.n; ++k) {
    const RigidInertia<S>& body = posture.inertia.subtree[k];
    // Twist of the joint and first moment of the subtree, both about g. Its second moment about g
    // is I + r h' + h_B r' and a multiple of E, which does not count.
    const Vector3<S>& z = axes[k].w;
    const Vector3<S> v = axes[k].v + z.cross(r);
    const Vector3<S> h = body.h - r * body.m;
    const S uh = u.dot(h), wh = w.dot(h);
    const Vector3<S> zu = z.cross(u), zw = z.cross(w);
    Vector3<S> Lw = r * wh + body.h * wr;
    Lw.noalias() += body.I * w;
    Vector3<S> Lu = r * uh + body.h * ur;
    Lu.noalias() += body.I * u;
    gradient[robot.coordinate(k)] +=
        S(2) * uw * v.dot(h) - v.dot(w) * uh - v.dot(u) * wh - zu.dot(Lw) - zw.dot(Lu);
  }
}

template <class S>
static Vector6<S> hand_twist(const HandJacobian<S>& jacobian, const GeneralizedMotion<S>& x) {
  Vector6<S> twist = jacobian.R_bh * x.Omega;
  for (Eigen::Index k = 0; k < x.phidot.size(); ++k) twist += jacobian.J_phi.col(k) * x.phidot[k];
  return twist;
}

/// The whole robot turning as one body about its centroid: u' Htilde_omega w = x(u)' H x(w).
template <class S>
static GeneralizedMotion<S> locked_rotation(const PostureImpact<S>& posture, const Vector3<S>& u) {
  GeneralizedMotion<S> x;
  x.Omega.template head<3>() = -u.cross(posture.inertia.r_bg);
  x.Omega.template tail<3>() = u;
  x.phidot.setZero(posture.jacobian.J_phi.cols());
  return x;
}

template <class S>
PostureImpact<S> evaluate_posture(const RobotModel& robot, const ImpactResistance& resistance,
                                  const JointVector<S>& phi) {
  // Each member is built in place from those before it: copying them would cost as much as the
  // sums.
  PostureImpact<S> out{
      .kinematics = compute_kinematics(robot, phi),
      .inertia = compute_inertia(robot, out.kinematics),
      .tilde = compute_tilde_inertia(out.inertia),
      .jacobian = compute_hand_jacobian(robot, out.kinematics),
      .factor =
          factorize_inertia(out.inertia, out.tilde, resistance.added_inertia, resistance.locked),
  };
  return out;
}

/// A T whose numbers are not set; T{} would fill all of it with zeros.
template <class T>
T unset() {
  T out;
  return out;
}

template <class S>
PostureImpact<S> evaluate_hand(const RobotModel& robot, const JointVector<S>& phi) {
  PostureImpact<S> out{.kinematics = compute_kinematics(robot, phi),
                       .inertia = unset<InertiaMatrices<S>>(),
                       .tilde = unset<TildeInertia<S>>(),
                       .jacobian = compute_hand_jacobian(robot, out.kinematics),
                       .factor = unset<InertiaFactor<S>>()};
  return out;
}

template <class S>
ImpactResponse<S> respond(const PostureImpact<S>& posture, const Vector6<S>& F) {
  const auto n = static_cast<int>(posture.jacobian.J_phi.cols());
  const Vector3<S> f = F.template head<3>();
  // J' F
  Vector6<S> F_b = F;
  F_b.template tail<3>() += posture.kinematics.r_bh.cross(f);
  JointVector<S> tau(n);
  for (int k = 0; k < n; ++k) tau[k] = posture.jacobian.J_phi.col(k).dot(F);

  const GeneralizedMotion<S> d = solve_inertia(posture.factor, F_b, tau);
  ImpactResponse<S> out{.F = F,
                        .d = {d.Omega, d.phidot},
                        .total = {},
                        .base = {},
                        .hand_inverse_mass = {},
                        .held_momentum = Vector6<S>::Zero()};
  out.total = F_b.template tail<3>() - posture.inertia.r_bg.cross(f);
  out.base = posture.tilde.Htilde_omega * out.omega();
  out.hand_inverse_mass = F_b.dot(d.Omega);  // (J' F)' d
  for (int k = 0; k < n; ++k) out.hand_inverse_mass += tau[k] * d.phidot[k];
  return out;
}

/// What psi changes by with the velocities: of the parts that are linear in d
/// [u_velocity; u_omega + Htilde_omega u_base; u_phidot] + [H_b u_momentum; 0] + [of_target; 0].
/// @param of_target what a held target adds, or null
template <class S>
static GeneralizedMotion<S> weights_of_motion(const PostureImpact<S>& posture,
                                              const ResponseWeights<S>& weights,
                                              const Vector6<S>* of_target) {
  const auto n = static_cast<int>(posture.jacobian.J_phi.cols());
  GeneralizedMotion<S> out{{}, JointVector<S>::Zero(n)};
  Vector6<S>& rhs = out.Omega;
  rhs.template head<3>() = weights.velocity;
  rhs.template tail<3>() = weights.omega + posture.tilde.Htilde_omega * weights.base;
  if (weights.momentum != Vector6<S>::Zero()) rhs += posture.inertia.H_b * weights.momentum;
  if (of_target != nullptr) rhs += *of_target;
  if (weights.phidot.size() == n) out.phidot = weights.phidot;
  return out;
}

/// Adjoint of these parts, H lambda = weights_of_motion().
template <class S>
static GeneralizedMotion<S> solve_adjoint(const PostureImpact<S>& posture,
                                          const ResponseWeights<S>& weights) {
  const GeneralizedMotion<S> rhs = weights_of_motion<S>(posture, weights, nullptr);
  return solve_inertia(posture.factor, rhs.Omega, rhs.phidot);
}

/// gradient += what psi changes by with the posture where d and F stay.
/// @param by_r_gh d psi / d r_gh
template <class S>
static void add_explicit_gradient(const RobotModel& robot, const PostureImpact<S>& posture,
                                  const JointAxes<S>& axes, const ImpactResponse<S>& response,
                                  const ResponseWeights<S>& weights, const Vector3<S>& by_r_gh,
                                  JointVector<S>& gradient) {
  const auto n = static_cast<int>(posture.jacobian.J_phi.cols());
  // base = Htilde_omega Delta omega also moves with Htilde_omega itself.
  if (weights.base != Vector3<S>::Zero()) {
    add_locked_rotation_gradient<S>(robot, posture, axes, weights.base, response.omega(), gradient);
  }

  // So does H_b Delta Omega with H_b.
  if (weights.momentum != Vector6<S>::Zero()) {
    const GeneralizedMotion<S> u{weights.momentum, JointVector<S>::Zero(n)};
    const GeneralizedMotion<S> base{response.d.Delta_Omega, JointVector<S>::Zero(n)};
    add_inertia_gradient<S>(robot, posture, axes, u, base, gradient);
  }

  // r_gh = r_bh - r_bg.
  const Vector3<S> by_first_moment = by_r_gh / posture.inertia.mass;
  for (int k = 0; k < n; ++k) {
    gradient[k] += posture.jacobian.J_phi.template block<3, 1>(0, k).dot(by_r_gh) -
                   posture.inertia.H_bphi.template block<3, 1>(0, k).dot(by_first_moment);
  }
}

template <class S>
ResponseGradient<S> response_gradient(const RobotModel& robot, const PostureImpact<S>& posture,
                                      const ImpactResponse<S>& response,
                                      const ResponseWeights<S>& weights) {
  const auto n = static_cast<int>(posture.jacobian.J_phi.cols());
  const Vector3<S> f = response.F.template head<3>();
  const GeneralizedMotion<S> d{response.d.Delta_Omega, response.d.Delta_phidot};
  ResponseGradient<S> out;
  out.phi.setZero(n);
  const GeneralizedMotion<S> adjoint = solve_adjoint<S>(posture, weights);

  // F' W_h F = (J' F)' H^-1 (J' F) is its own adjoint; both factors J' F vary, H once.
  const S s = weights.hand_inverse_mass;
  const GeneralizedMotion<S> lambda{adjoint.Omega + d.Omega * s, adjoint.phidot + d.phidot * s};
  const GeneralizedMotion<S> lambda_hand{lambda.Omega + d.Omega * s, lambda.phidot + d.phidot * s};
  const JointAxes<S> axes = joint_axes(robot, posture.kinematics);
  out.F = hand_twist(posture.jacobian, lambda_hand);
  const Vector6<S> F_s = response.F * s;
  add_motion_gradient<S>(robot, posture, axes, {lambda, F_s}, {d, response.F},
                         cross_by_parts<S>(out.F, response.F), out.phi);

  // total = r_gh x f + t.
  const Vector3<S> by_r_gh = f.cross(weights.total);
  add_explicit_gradient<S>(robot, posture, axes, response, weights, by_r_gh, out.phi);
  const Vector3<S> r_gh = posture.kinematics.r_bh - posture.inertia.r_bg;
  out.F.template head<3>() += weights.total.cross(r_gh) + weights.force;
  out.F.template tail<3>() += weights.total;
  return out;
}

template <class S>
JointVector<S> coupling_gradient(const RobotModel& robot, const PostureImpact<S>& posture,
                                 const JointVector<S>& w, const Vector3<S>& y) {
  // Both motions carry no linear momentum, so the translation drops out of the derivative.
  GeneralizedMotion<S> x{Vector6<S>::Zero(), w};
  for (Eigen::Index k = 0; k < w.size(); ++k) {
    x.Omega.template head<3>() -=
        posture.inertia.H_bphi.template block<3, 1>(0, k) * (w[k] / posture.inertia.mass);
  }
  JointVector<S> gradient;
  gradient.setZero(robot.n());
  add_inertia_gradient<S>(robot, posture, joint_axes(robot, posture.kinematics),
                          locked_rotation(posture, y), x, gradient);
  return gradient;
}

template <class S>
JointVector<S> coupling_column_gradient(const RobotModel& robot, const PostureImpact<S>& posture,
                                        int i, const Vector3<S>& y) {
  JointVector<S> w;
  w.setZero(robot.n());
  w[i] = S(1);
  return coupling_gradient<S>(robot, posture, w, y);
}

/// H_b^-1 by the centroid's equations.
template <class S>
class BaseInverse {
 public:
  explicit BaseInverse(const PostureImpact<S>& posture)
      : inertia_(posture.inertia), factor_(posture.tilde.Htilde_omega) {
    factorize_cholesky(factor_);
  }
  /// @param momentum [p; l] about the base centroid
  Vector6<S> operator()(const Vector6<S>& momentum) const {
    const Vector3<S> p = momentum.template head<3>();
    Vector3<S> omega = momentum.template tail<3>() - inertia_.r_bg.cross(p);
    solve_cholesky(factor_, omega);
    Vector6<S> out;
    out.template head<3>() = p / inertia_.mass - omega.cross(inertia_.r_bg);
    out.template tail<3>() = omega;
    return out;
  }

 private:
  const InertiaMatrices<S>& inertia_;
  Matrix3<S> factor_;
};

/// gradient += d/dphi (y . J x + u . Omega), x = (Omega, phidot) the motion of the joints' rates at
/// zero momentum, the rates, y and u fixed.
template <class S>
static void add_zero_momentum_gradient(const RobotModel& robot, const PostureImpact<S>& posture,
                                       const JointAxes<S>& axes, const GeneralizedMotion<S>& x,
                                       const Vector6<S>& y, const Vector6<S>& u,
                                       JointVector<S>& gradient) {
  // Omega moves with the posture by -H_b^-1 (dH x)_b, which psi sees through
  // mu = H_b^-1 (R_bh' y + u).
  Vector6<S> load = y + u;
  load.template tail<3>() += posture.kinematics.r_bh.cross(Vector3<S>(y.template head<3>()));
  const GeneralizedMotion<S> mu{BaseInverse<S>(posture)(load),
                                JointVector<S>::Zero(x.phidot.size())};
  const Vector6<S> none = Vector6<S>::Zero();
  add_motion_gradient<S>(robot, posture, axes, {x, none}, {mu, y},
                         cross_by_parts<S>(hand_twist(posture.jacobian, x), y), gradient);
}

template <class S>
JointVector<S> generalized_jacobian_gradient(const RobotModel& robot,
                                             const PostureImpact<S>& posture,
                                             const JointVector<S>& w, const Vector6<S>& y) {
  // y . Jhat w = y . J x with x the motion of the joints w at zero momentum.
  Vector6<S> momentum = Vector6<S>::Zero();
  for (Eigen::Index k = 0; k < w.size(); ++k) momentum += posture.inertia.H_bphi.col(k) * w[k];
  const GeneralizedMotion<S> x{-BaseInverse<S>(posture)(momentum), w};
  JointVector<S> gradient;
  gradient.setZero(robot.n());
  add_zero_momentum_gradient<S>(robot, posture, joint_axes(robot, posture.kinematics), x, y,
                                Vector6<S>::Zero(), gradient);
  return gradient;
}

}  // namespace stillbase
