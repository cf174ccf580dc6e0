// What the rows and the objective are worth at a point, and their exact gradients.
#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include <stillbase/core/random.hpp>
#include <stillbase/impact/contact.hpp>
#include <stillbase/plan/encounter.hpp>

#include "capture/formulation_parts.hpp"

namespace stillbase {

namespace {

/// 1/2 sum r_i x d_i of two sets of axes (columns): sin(angle) times the axis that turns R to D.
Vector3d rotation_error(const Matrix3d& R, const Matrix3d& D) {
  Vector3d e = Vector3d::Zero();
  for (int i = 0; i < 3; ++i) e += R.col(i).cross(D.col(i)) / 2;
  return e;
}

/// d rotation_error / d(turn of R): 1/2 sum (r d' - (r . d) E).
Matrix3d rotation_error_turn(const Matrix3d& R, const Matrix3d& D) {
  return (R * D.transpose() - (R.transpose() * D).trace() * Matrix3d::Identity()) / 2;
}

}  // namespace

Eigen::VectorXd Formulation::Parts::start_point(const Eigen::VectorXd& u) const {
  Eigen::VectorXd x(layout.size);
  for (int i = 0; i < layout.size; ++i) {
    double low = layout.lower[i], high = layout.upper[i];
    if (!std::isfinite(low) || !std::isfinite(high)) {
      low = std::isfinite(low) ? low : (std::isfinite(high) ? high - 2 * M_PI : -M_PI);
      high = std::isfinite(high) ? high : low + 2 * M_PI;
    }
    x[i] = low + u[i] * (high - low);
  }
  if (layout.attitude_size == 3) {
    const double limit = problem.variables.base_attitude_max;
    const double a = u[layout.attitude], b = u[layout.attitude + 1], c = u[layout.attitude + 2];
    if (limit > 3.14159) {
      // Uniform over rotations (Shoemake, Graphics Gems III, 1992).
      const Eigen::Quaterniond q(
          std::sqrt(a) * std::cos(2 * M_PI * c), std::sqrt(1 - a) * std::sin(2 * M_PI * b),
          std::sqrt(1 - a) * std::cos(2 * M_PI * b), std::sqrt(a) * std::sin(2 * M_PI * c));
      x.segment<3>(layout.attitude) = rotation_log(q);
    } else {
      const double z = 2 * a - 1, r = std::sqrt(std::max(0.0, 1 - z * z));
      x.segment<3>(layout.attitude) =
          limit * std::cbrt(c) *
          Vector3d(r * std::cos(2 * M_PI * b), r * std::sin(2 * M_PI * b), z);
    }
  }
  return x;
}

Local Formulation::Parts::localise(const Eigen::VectorXd& x) const {
  Local out;
  out.x = x;
  out.configuration.phi = layout.joint_positions(problem, x);
  out.configuration.base = problem.base;
  out.configuration.base.orientation = layout.attitude_of(problem, x);
  out.configuration.contact_time = layout.contact_time(problem, x);
  const double t = out.configuration.contact_time;
  out.R_NB = out.configuration.base.orientation.toRotationMatrix();
  out.encounter.target_inverse_mass = 0;
  out.encounter.magnitude_given = problem.impulse.source == ImpulseSource::Given;
  out.encounter.closing_speed = problem.impulse.closing_speed;
  if (motion) {
    out.contact = motion->contact(chosen_feature(problem), t);
    if (problem.impulse.direction == std::nullopt) {
      out.encounter.closing_speed = out.contact->normal.dot(out.contact->velocity);
      out.closing_speed_rate = out.contact->normal_rate.dot(out.contact->velocity) +
                               out.contact->normal.dot(out.contact->velocity_rate);
    }
  }
  switch (frame) {
    case ContactFrame::Base:
      out.R_EB.setIdentity();
      break;
    case ContactFrame::Inertial:
      out.R_EB = out.R_NB;
      break;
    case ContactFrame::Target: {
      const TargetState state = motion->state(t);
      out.R_EB = state.pose.orientation.conjugate().toRotationMatrix() * out.R_NB;
      out.omega_EB = -(out.R_NB.transpose() * state.angular_velocity);
      break;
    }
  }
  out.encounter.F.head<3>() = out.R_EB.transpose() * F_E.head<3>();
  out.encounter.F.tail<3>() = out.R_EB.transpose() * F_E.tail<3>();
  if (out.contact && !problem.impulse.direction) {
    out.encounter.speed_stated = false;
    out.encounter.velocity = out.R_NB.transpose() * out.contact->velocity;
  }
  if (problem.impulse.source == ImpulseSource::PointMass) {
    out.encounter.target_mass = problem.target->mass;
    out.encounter.target_inverse_mass = 1 / problem.target->mass;
  } else if (problem.impulse.source == ImpulseSource::RigidBody) {
    const ContactFeature& feature = chosen_feature(problem);
    out.encounter.target_inverse_mass = target_inverse_mass(
        problem.target->mass, problem.target->inertia, feature.point, feature.normal);
    out.encounter.target_mass = problem.target->mass;
    out.encounter.r = out.R_EB.transpose() * feature.point;
    if (!problem.target->inertia.isZero(0)) {
      out.encounter.target_inverse_inertia =
          out.R_EB.transpose() * problem.target->inertia.inverse() * out.R_EB;
    }
  }
  return out;
}

Vector3d objective_quantity(ObjectiveQuantity quantity, const ImpactResponse<double>& response) {
  switch (quantity) {
    case ObjectiveQuantity::BaseAngularMomentum:
      return response.base;
    case ObjectiveQuantity::BaseAngularVelocity:
      return response.omega();
    case ObjectiveQuantity::TotalAngularMomentum:
      return response.total;
  }
  return Vector3d::Zero();
}

ResponseWeights<double> Formulation::Parts::quantity_weights(const Vector3d& u) const {
  ResponseWeights<double> weights;
  switch (problem.objective) {
    case ObjectiveQuantity::BaseAngularMomentum:
      weights.base = u;
      break;
    case ObjectiveQuantity::BaseAngularVelocity:
      weights.omega = u;
      break;
    case ObjectiveQuantity::TotalAngularMomentum:
      weights.total = u;
      break;
  }
  return weights;
}

void Formulation::Parts::add_contact_turn(const Local& local, const Vector3d& g,
                                          ScalarGradient& gradient) const {
  if (frame != ContactFrame::Base) gradient.theta += g;
  gradient.t += g.dot(local.omega_EB);
}

ScalarGradient Formulation::Parts::impact_gradient(const Local& local,
                                                   const PostureImpact<double>& posture,
                                                   const ImpactResponse<double>& response,
                                                   const ResponseWeights<double>& weights) const {
  const auto raw = response_gradient(problem.robot, posture, response, weights);
  ScalarGradient out(n());
  out.phi = raw.phi;
  // Turning B by theta (in B) changes the wrench in B by F x theta.
  const Vector3d g = raw.F.head<3>().cross(Vector3d(local.encounter.F.head<3>())) +
                     raw.F.tail<3>().cross(Vector3d(local.encounter.F.tail<3>()));
  add_contact_turn(local, g, out);
  return out;
}

Matrix3d Formulation::Parts::wanted_hand_axes(const Local& local) const {
  const HandSpec& hand = problem.hand;
  if (hand.orientation) {
    const Matrix3d R = hand.orientation->toRotationMatrix();
    return hand.frame == Frame::Base ? R : Matrix3d(local.R_NB.transpose() * R);
  }
  const Matrix3d facing =
      Eigen::Quaterniond::FromTwoVectors(hand.approach_axis, -n_E).toRotationMatrix();
  return local.R_EB.transpose() * rotation_exp(n_E * hand.roll).toRotationMatrix() * facing;
}

double Formulation::Parts::value_of(const Row& row, const Local& local,
                                    const PostureImpact<double>& posture,
                                    const ImpactResponse<double>& response) const {
  const Kinematics<double>& kin = posture.kinematics;
  const auto contact_point = [&]() -> Vector3d {
    return hand_point ? *hand_point : local.contact->point;
  };
  const Vector3d tangent = row.index == 0 ? u_E : (row.index == 1 ? v_E : n_E);
  switch (row.kind) {
    case RowKind::HandPosition:
      if (hand_point && problem.hand.frame == Frame::Base) {
        return kin.r_bh[row.index] - (*hand_point)[row.index];
      }
      return (local.R_NB * kin.r_bh + problem.base.position - contact_point())[row.index];
    case RowKind::StationBox:
      return (contact_point() - local.R_NB * kin.r_bh)[row.index];
    case RowKind::HandAxis:
      return tangent.dot(local.R_EB * (kin.R_hand * problem.hand.approach_axis));
    case RowKind::HandFacing:
      return n_E.dot(local.R_EB * (kin.R_hand * problem.hand.approach_axis));
    case RowKind::HandPose:
      return rotation_error(kin.R_hand, wanted_hand_axes(local))[row.index];
    case RowKind::PoseFacing:
      return (kin.R_hand.transpose() * wanted_hand_axes(local)).trace();
    case RowKind::CaseTotal:
      return tangent.dot(local.R_EB * response.total);
    case RowKind::CaseBase:
      return response.base[row.index];
    case RowKind::CaseCoupling:
      return response.coupling()[row.index];
    case RowKind::CouplingColumn:
      return posture.tilde.Htilde_omegaphi.col(row.index).dot(response.coupling());
    case RowKind::ClosingSpeed:
      return local.encounter.closing_speed;
    case RowKind::AttitudeAngle:
      return local.x.segment<3>(layout.attitude).squaredNorm();
  }
  return 0;
}

ScalarGradient Formulation::Parts::gradient_of(const Row& row, const Local& local,
                                               const PostureImpact<double>& posture,
                                               const ImpactResponse<double>& response) const {
  const RobotModel& robot = problem.robot;
  const Kinematics<double>& kin = posture.kinematics;
  ScalarGradient out(n());
  const Vector3d tangent = row.index == 0 ? u_E : (row.index == 1 ? v_E : n_E);
  // Turn of the hand per joint rate, in B.
  const auto turn = [&](int k) -> Vector3d { return posture.jacobian.J_phi.block<3, 1>(3, k); };

  switch (row.kind) {
    case RowKind::HandPosition:
    case RowKind::StationBox: {
      const bool in_base = hand_point && problem.hand.frame == Frame::Base;
      const double sign = row.kind == RowKind::HandPosition ? 1 : -1;
      const Vector3d axis = in_base ? Vector3d(Vector3d::Unit(row.index))
                                    : Vector3d(local.R_NB.row(row.index).transpose());
      for (int k = 0; k < n(); ++k) {
        out.phi[k] = sign * axis.dot(posture.jacobian.J_phi.block<3, 1>(0, k));
      }
      if (!in_base) out.theta = sign * kin.r_bh.cross(axis);
      if (!hand_point) out.t = -sign * local.contact->point_rate[row.index];
      return out;
    }
    case RowKind::HandAxis:
    case RowKind::HandFacing: {
      const Vector3d e = row.kind == RowKind::HandFacing ? n_E : tangent;
      const Vector3d e_B = local.R_EB.transpose() * e;
      const Vector3d a = kin.R_hand * problem.hand.approach_axis;
      for (int k = 0; k < n(); ++k) out.phi[k] = turn(k).cross(a).dot(e_B);
      add_contact_turn(local, a.cross(e_B), out);
      return out;
    }
    case RowKind::HandPose:
    case RowKind::PoseFacing: {
      // In B: turning B against the wanted axes turns them back.
      const Matrix3d D = wanted_hand_axes(local);
      const Vector3d g_R = row.kind == RowKind::HandPose
                               ? Vector3d(rotation_error_turn(kin.R_hand, D).row(row.index))
                               : Vector3d(2 * rotation_error(kin.R_hand, D));
      const Vector3d g_D = row.kind == RowKind::HandPose
                               ? Vector3d(-rotation_error_turn(D, kin.R_hand).row(row.index))
                               : Vector3d(-2 * rotation_error(kin.R_hand, D));
      for (int k = 0; k < n(); ++k) out.phi[k] = turn(k).dot(g_R);
      if (!problem.hand.orientation) {
        add_contact_turn(local, -g_D, out);
      } else if (problem.hand.frame == Frame::Inertial) {
        out.theta -= g_D;
      }
      return out;
    }
    case RowKind::CaseTotal: {
      ResponseWeights<double> weights;
      weights.total = local.R_EB.transpose() * tangent;
      out = impact_gradient(local, posture, response, weights);
      add_contact_turn(local, response.total.cross(weights.total), out);
      return out;
    }
    case RowKind::CaseBase: {
      ResponseWeights<double> weights;
      weights.base = Vector3d::Unit(row.index);
      return impact_gradient(local, posture, response, weights);
    }
    case RowKind::CaseCoupling:
    case RowKind::CouplingColumn: {
      ResponseWeights<double> weights;
      weights.total = row.kind == RowKind::CaseCoupling
                          ? Vector3d(Vector3d::Unit(row.index))
                          : Vector3d(posture.tilde.Htilde_omegaphi.col(row.index));
      weights.base = -weights.total;
      out = impact_gradient(local, posture, response, weights);
      if (row.kind == RowKind::CouplingColumn) {
        out.phi += coupling_column_gradient<double>(robot, posture, row.index, response.coupling());
      }
      return out;
    }
    case RowKind::ClosingSpeed:
      out.t = local.closing_speed_rate;
      return out;
    case RowKind::AttitudeAngle:
      // The rotation vector a is its own image under its right Jacobian: J_r(a)' 2 a = 2 a.
      out.theta = 2 * local.x.segment<3>(layout.attitude);
      return out;
  }
  return out;
}

Eigen::VectorXd Formulation::Parts::compress(const Eigen::VectorXd& x,
                                             const ScalarGradient& gradient) const {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(layout.size);
  for (std::size_t i = 0; i < layout.joints.size(); ++i) {
    out[static_cast<int>(i)] = gradient.phi[layout.joints[i]];
  }
  if (layout.attitude_size > 0) {
    out.segment(layout.attitude, layout.attitude_size) =
        layout.attitude_rates(problem, x).transpose() * gradient.theta;
  }
  if (layout.time >= 0) out[layout.time] = gradient.t;
  return out;
}

}  // namespace stillbase
