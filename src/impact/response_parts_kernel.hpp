// Each part of a response, with the place of its weight in an adjoint gradient.
#pragma once

#include <stillbase/impact/gradient.hpp>
#include <stillbase/impact/response_parts.hpp>

namespace stillbase {

/// Calls use(value, weight): a part of the response to a unit impulse, and a reference to its
/// weight in `weights`, of the same size.
template <class S, class Use>
void with_part(ResponsePart part, const PostureImpact<S>& posture,
               const ImpactResponse<S>& response, ResponseWeights<S>& weights, const Use& use) {
  const Vector6<S>& Omega = response.d.Delta_Omega;
  switch (part) {
    case ResponsePart::BaseVelocity:
      return use(Vector3<S>(Omega.template head<3>()), weights.velocity);
    case ResponsePart::BaseRate:
      return use(response.omega(), weights.omega);
    case ResponsePart::BaseAngularMomentum:
      return use(response.base, weights.base);
    case ResponsePart::TotalAngularMomentum:
      return use(response.total, weights.total);
    case ResponsePart::ReceivedLinearMomentum:
      return use(Vector3<S>(posture.inertia.H_b.template topRows<3>() * Omega +
                            response.held_momentum.template head<3>()),
                 weights.momentum.template head<3>());
    case ResponsePart::ReceivedAngularMomentum:
      return use(Vector3<S>(posture.inertia.H_b.template bottomRows<3>() * Omega +
                            response.held_momentum.template tail<3>()),
                 weights.momentum.template tail<3>());
    case ResponsePart::JointRates:
      if (weights.phidot.size() == 0) weights.phidot.setZero(response.d.Delta_phidot.size());
      return use(response.d.Delta_phidot, weights.phidot);
    case ResponsePart::Impulse:
      return use(Vector3<S>(response.F.template head<3>()), weights.force);
  }
}

/// A 3 x 3 matrix on a part of three components; its first entry on all components of another.
template <class S, class Part>
auto apply_metric(const Matrix3<S>& G, const Part& part) {
  if constexpr (Part::RowsAtCompileTime == 3) {
    return Vector3<S>(G * part);
  } else {
    return Part(part * G(0, 0));
  }
}

}  // namespace stillbase
