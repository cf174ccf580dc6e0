// What the rows are worth at a point, and their exact gradients: for any number type.
#pragma once

#include "formulation/constraints/margins_kernel.hpp"
#include "formulation/formulation_kernel.hpp"

namespace stillbase {

namespace {

/// Component i of 1/2 sum r_k x d_k of two sets of axes (columns): sin(angle) times the axis that
/// turns R to D.
template <class S>
S rotation_error(const Matrix3<S>& R, const Matrix3<S>& D, int i) {
  const int j = (i + 1) % 3, k = (i + 2) % 3;
  return (R.row(j).dot(D.row(k)) - R.row(k).dot(D.row(j))) / S(2);
}

/// sum r_k . d_k.
template <class S>
S alignment(const Matrix3<S>& R, const Matrix3<S>& D) {
  return R.cwiseProduct(D).sum();
}

/// d rotation_error_i / d(turn of R): row i of 1/2 (R D' - (sum r_k . d_k) E).
template <class S>
Vector3<S> rotation_error_turn(const Matrix3<S>& R, const Matrix3<S>& D, int i) {
  Vector3<S> out = D * R.row(i).transpose();
  out[i] -= alignment<S>(R, D);
  return out / S(2);
}

}  // namespace

template <class S>
S Formulation::Parts::value_of(const Row& row, const Local<S>& local,
                               const PostureImpact<S>& posture,
                               const ScenarioImpact<S>& hit) const {
  const Kinematics<S>& kin = posture.kinematics;
  const ImpactResponse<S>& response = hit.response;
  const auto r_bh_N = [&](int i) -> S { return local.R_NB.row(i).dot(kin.r_bh); };
  const auto contact_point = [&]() -> Vector3<S> {
    return model.hand_point ? Vector3<S>(model.hand_point->cast<S>()) : local.contact.point;
  };
  const Vector3<S> tangent =
      (row.index == 0 ? model.u : (row.index == 1 ? model.v : model.n)).cast<S>();
  const auto hand_axis = [&]() -> Vector3<S> {
    return local.contact.R_EB *
           Vector3<S>(kin.R_hand * problem.hand.approach_axis.template cast<S>());
  };
  switch (row.kind) {
    case RowKind::HandPosition:
      if (model.hand_point && problem.hand.frame == Frame::Base) {
        return kin.r_bh[row.index] - S((*model.hand_point)[row.index]);
      }
      return r_bh_N(row.index) + S(problem.base.position[row.index]) - contact_point()[row.index];
    case RowKind::StationBox:
      return contact_point()[row.index] - r_bh_N(row.index);
    case RowKind::HandAxis:
      return tangent.dot(hand_axis());
    case RowKind::HandFacing:
      return model.n.cast<S>().dot(hand_axis());
    case RowKind::HandPose:
      return rotation_error<S>(
          kin.R_hand, wanted_hand_axes<S>(model, local.R_NB, local.contact.R_EB), row.index);
    case RowKind::PoseFacing:
      return alignment<S>(kin.R_hand, wanted_hand_axes<S>(model, local.R_NB, local.contact.R_EB));
    case RowKind::CaseTotal:
      return tangent.dot(local.contact.R_EB * response.total);
    case RowKind::CaseBase:
      return response.base[row.index];
    case RowKind::CaseCoupling:
      return response.coupling()[row.index];
    case RowKind::CouplingColumn:
      return Vector3<S>(posture.tilde.Htilde_omegaphi.col(row.index)).dot(response.coupling());
    case RowKind::ClosingSpeed:
      return hit.encounter.closing_speed;
    case RowKind::AttitudeAngle:
      return local.x.template segment<3>(layout.attitude).squaredNorm();
    case RowKind::AttitudeCone: {
      const Vector3d& axis = problem.variables.base_attitude_axis;
      const Vector3d in_base = problem.base.orientation.conjugate() * axis;
      return Vector3<S>(axis.cast<S>()).dot(local.R_NB * Vector3<S>(in_base.cast<S>()));
    }
    case RowKind::JointRate:
      return hit.p * response.d.Delta_phidot[row.index];
    case RowKind::CouplingMargin:
    case RowKind::JacobianMargin:
      return margin<S>(row.kind, posture).sigma;
    case RowKind::Clearance:
      return separation<S>(clearances[static_cast<std::size_t>(row.index)], local, posture)
          .distance;
  }
  return S(0);
}

template <class S>
ScalarGradient<S> Formulation::Parts::gradient_of(const Row& row, const Local<S>& local,
                                                  const PostureImpact<S>& posture,
                                                  const ScenarioImpact<S>& hit) const {
  const Kinematics<S>& kin = posture.kinematics;
  const ImpactResponse<S>& response = hit.response;
  ScalarGradient<S> out(n());
  const Vector3<S> tangent =
      (row.index == 0 ? model.u : (row.index == 1 ? model.v : model.n)).cast<S>();
  // Turn of the hand per joint rate, in B.
  const auto turn = [&](int k) -> Vector3<S> {
    return posture.jacobian.J_phi.template block<3, 1>(3, k);
  };
  const auto unit = [](int i) -> Vector3<S> { return Vector3d(Vector3d::Unit(i)).cast<S>(); };

  switch (row.kind) {
    case RowKind::HandPosition:
    case RowKind::StationBox: {
      const bool in_base = model.hand_point && problem.hand.frame == Frame::Base;
      const S sign = row.kind == RowKind::HandPosition ? S(1) : S(-1);
      const Vector3<S> axis =
          in_base ? unit(row.index) : Vector3<S>(local.R_NB.row(row.index).transpose());
      for (int k = 0; k < n(); ++k) {
        out.phi[k] = sign * axis.dot(Vector3<S>(posture.jacobian.J_phi.template block<3, 1>(0, k)));
      }
      if (!in_base) out.theta = kin.r_bh.cross(axis) * sign;
      if (!model.hand_point) out.t = -sign * local.rates.point[row.index];
      return out;
    }
    case RowKind::HandAxis:
    case RowKind::HandFacing: {
      const Vector3<S> e =
          row.kind == RowKind::HandFacing ? Vector3<S>(model.n.cast<S>()) : tangent;
      const Vector3<S> e_B = local.contact.R_EB.transpose() * e;
      const Vector3<S> a = kin.R_hand * problem.hand.approach_axis.template cast<S>();
      for (int k = 0; k < n(); ++k) out.phi[k] = turn(k).cross(a).dot(e_B);
      add_contact_turn<S>(local.rates, a.cross(e_B), out);
      return out;
    }
    case RowKind::HandPose:
    case RowKind::PoseFacing: {
      // In B: turning B against the wanted axes turns them back.
      const Matrix3<S> R = kin.R_hand;
      const Matrix3<S> D = wanted_hand_axes<S>(model, local.R_NB, local.contact.R_EB);
      Vector3<S> g_R, g_D;
      if (row.kind == RowKind::HandPose) {
        g_R = rotation_error_turn<S>(R, D, row.index);
        g_D = -rotation_error_turn<S>(D, R, row.index);
      } else {
        for (int i = 0; i < 3; ++i) g_R[i] = rotation_error<S>(R, D, i) * S(2);
        g_D = -g_R;
      }
      for (int k = 0; k < n(); ++k) out.phi[k] = turn(k).dot(g_R);
      if (!problem.hand.orientation) {
        add_contact_turn<S>(local.rates, -g_D, out);
      } else if (problem.hand.frame == Frame::Inertial) {
        out.theta -= g_D;
      }
      return out;
    }
    case RowKind::CaseTotal: {
      ResponseWeights<S> weights;
      weights.total = local.contact.R_EB.transpose() * tangent;
      out = impact_gradient<S>(posture, hit, weights);
      add_contact_turn<S>(local.rates, response.total.cross(weights.total), out);
      return out;
    }
    case RowKind::CaseBase: {
      ResponseWeights<S> weights;
      weights.base = unit(row.index);
      return impact_gradient<S>(posture, hit, weights);
    }
    case RowKind::CaseCoupling:
    case RowKind::CouplingColumn: {
      ResponseWeights<S> weights;
      weights.total = row.kind == RowKind::CaseCoupling
                          ? unit(row.index)
                          : Vector3<S>(posture.tilde.Htilde_omegaphi.col(row.index));
      weights.base = -weights.total;
      out = impact_gradient<S>(posture, hit, weights);
      if (row.kind == RowKind::CouplingColumn) {
        out.phi +=
            coupling_column_gradient<S>(problem.robot, posture, row.index, response.coupling());
      }
      return out;
    }
    case RowKind::ClosingSpeed:
      out.t = hit.closing_speed_rate;
      return out;
    case RowKind::AttitudeAngle:
      // The rotation vector a is its own image under its right Jacobian: J_r(a)' 2 a = 2 a.
      out.theta = local.x.template segment<3>(layout.attitude) * S(2);
      return out;
    case RowKind::AttitudeCone: {
      const Vector3d& axis = problem.variables.base_attitude_axis;
      const Vector3d in_base = problem.base.orientation.conjugate() * axis;
      const Vector3<S> wanted = local.R_NB.transpose() * Vector3<S>(axis.cast<S>());
      out.theta = Vector3<S>(in_base.cast<S>()).cross(wanted);
      return out;
    }
    case RowKind::JointRate: {
      ResponseWeights<S> weights;
      weights.phidot.setZero(n());
      weights.phidot[row.index] = hit.p;
      return scaled_gradient<S>(posture, hit, weights, hit.p * response.d.Delta_phidot[row.index]);
    }
    case RowKind::CouplingMargin:
    case RowKind::JacobianMargin:
      return margin_gradient<S>(row.kind, posture, margin<S>(row.kind, posture));
    case RowKind::Clearance: {
      const ClearancePair& pair = clearances[static_cast<std::size_t>(row.index)];
      return separation_gradient<S>(pair, local, posture, separation<S>(pair, local, posture));
    }
  }
  return out;
}

template <class S>
S Formulation::Parts::value_and_gradient(const Row& row, const Local<S>& local,
                                         const PostureImpact<S>& posture,
                                         const ScenarioImpact<S>& hit,
                                         ScalarGradient<S>& gradient) const {
  switch (row.kind) {
    case RowKind::CouplingMargin:
    case RowKind::JacobianMargin: {
      const SingularTriple<S> triple = margin<S>(row.kind, posture);
      gradient = margin_gradient<S>(row.kind, posture, triple);
      return triple.sigma;
    }
    case RowKind::Clearance: {
      const ClearancePair& pair = clearances[static_cast<std::size_t>(row.index)];
      const Separation<S> at = separation<S>(pair, local, posture);
      gradient = separation_gradient<S>(pair, local, posture, at);
      return at.distance;
    }
    default:
      gradient = gradient_of<S>(row, local, posture, hit);
      return value_of<S>(row, local, posture, hit);
  }
}

}  // namespace stillbase
