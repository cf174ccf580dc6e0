// Singular-value margins and clearances of a posture, and their exact gradients.
#pragma once

#include <stillbase/dynamics/inertia.hpp>

#include "formulation/formulation_parts.hpp"

namespace stillbase {

template <class S>
SingularTriple<S> Formulation::Parts::margin(RowKind kind, const PostureImpact<S>& posture) const {
  Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic> A;
  if (kind == RowKind::CouplingMargin) {
    A = posture.tilde.Htilde_omegaphi;
    return singular_triple<S>(A, coupling_rank);
  }
  A = compute_hat_inertia<S>(posture.inertia, posture.jacobian).Jhat_phi;
  A.bottomRows(3) *= S(problem.constraints.jacobian_length);
  return singular_triple<S>(A, jacobian_rank);
}

// With u and v the singular vectors, d sigma = u' dA v.
template <class S>
ScalarGradient<S> Formulation::Parts::margin_gradient(RowKind kind, const PostureImpact<S>& posture,
                                                      const SingularTriple<S>& triple) const {
  ScalarGradient<S> out(n());
  const JointVector<S> v = triple.v;
  if (kind == RowKind::CouplingMargin) {
    out.phi = coupling_gradient<S>(problem.robot, posture, v, Vector3<S>(triple.u));
    return out;
  }
  Vector6<S> u = triple.u;
  u.template tail<3>() *= S(problem.constraints.jacobian_length);
  out.phi = generalized_jacobian_gradient<S>(problem.robot, posture, v, u);
  return out;
}

template <class S>
PlacedShape<S> Formulation::Parts::placed(const ClearanceShape& shape, const Local<S>& local,
                                          const PostureImpact<S>& posture) const {
  const Kinematics<S>& kin = posture.kinematics;
  Matrix3<S> R = Matrix3<S>::Identity();
  Vector3<S> o = Vector3<S>::Zero();
  if (shape.body >= 0) {
    R = kin.R[static_cast<std::size_t>(shape.body)];
    o = kin.o[static_cast<std::size_t>(shape.body)];
  } else if (shape.body == kTargetBody) {
    R = local.contact.R_EB.transpose() * target.R_ET.cast<S>();
    o = kin.r_bh - R * target.r.cast<S>();
  }
  const Matrix3<S> axes = R * shape.R.cast<S>();
  return {&shape, axes, o + R * shape.p.cast<S>()};
}

template <class S>
Separation<S> Formulation::Parts::separation(const ClearancePair& pair, const Local<S>& local,
                                             const PostureImpact<S>& posture) const {
  return separate<S>(placed<S>(pair.first, local, posture), placed<S>(pair.second, local, posture));
}

template <class S>
ScalarGradient<S> Formulation::Parts::separation_gradient(const ClearancePair& pair,
                                                          const Local<S>& local,
                                                          const PostureImpact<S>& posture,
                                                          const Separation<S>& at) const {
  const Kinematics<S>& kin = posture.kinematics;
  ScalarGradient<S> out(n());
  const auto add = [&](int body, const Vector3<S>& normal) {
    if (body == kTargetBody) {
      // It moves with the hand, but turns with the contact frame: against B's own turn.
      for (int k = 0; k < n(); ++k) {
        out.phi[k] += normal.dot(Vector3<S>(posture.jacobian.J_phi.template block<3, 1>(0, k)));
      }
      add_contact_turn<S>(local.rates, normal.cross(Vector3<S>(at.point - kin.r_bh)), out);
      return;
    }
    for (int k = body; k != kBase; k = problem.robot.joints[static_cast<std::size_t>(k)].parent) {
      const auto index = static_cast<std::size_t>(k);
      const Vector3<S> z = kin.z(k);
      const Vector3<S> velocity = problem.robot.joints[index].is_prismatic()
                                      ? z
                                      : Vector3<S>(z.cross(Vector3<S>(at.point - kin.o[index])));
      out.phi[k] += normal.dot(velocity);
    }
  };
  add(pair.first.body, at.normal);
  add(pair.second.body, Vector3<S>(-at.normal));
  return out;
}

}  // namespace stillbase
