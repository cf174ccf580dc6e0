#include "verification/recomputation.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace stillbase::verification {

// Servo: stiffness K and damping D over a contact of duration h under a constant force add
// h D/2 + h^2 K/6 to the joint inertia, to leading order.
Eigen::VectorXd added_inertia_of(const JointResistance& resistance, int n) {
  Eigen::VectorXd added = Eigen::VectorXd::Zero(n);
  const double h = resistance.contact_duration;
  switch (resistance.model) {
    case ResistanceModel::RotorInertia:
      added = resistance.rotor_inertia;
      break;
    case ResistanceModel::Servo:
      added = h / 2 * resistance.damping + h * h / 6 * resistance.stiffness;
      break;
    case ResistanceModel::Free:
    case ResistanceModel::Locked:
      break;
  }
  return added;
}

CaptureProblem problem_at(const CaptureProblem& problem, const Configuration& at) {
  CaptureProblem met = problem;
  if (!at.feature.empty()) met.variables.feature = at.feature;
  return met;
}

std::optional<ContactFeature> feature_of(const CaptureProblem& problem) {
  if (!problem.target || problem.variables.feature.empty()) return std::nullopt;
  for (const ContactFeature& feature : problem.target->features) {
    if (feature.name == problem.variables.feature) return feature;
  }
  return std::nullopt;
}

std::optional<TargetMotion> target_motion(const CaptureProblem& problem,
                                          const Configuration& configuration,
                                          const Vector3d& hand_N, double first_time) {
  if (!problem.target) return std::nullopt;
  TargetState state = problem.target_state;
  if (problem.impulse.direction) {
    const Vector3d n = problem.impulse.direction_frame == Frame::Base
                           ? configuration.base.orientation * *problem.impulse.direction
                           : *problem.impulse.direction;
    state = {};
    state.time = configuration.contact_time;
    state.linear_velocity = problem.impulse.closing_speed * n;
    Vector3d to_contact = Vector3d::Zero();
    if (const auto feature = feature_of(problem)) {
      state.pose.orientation = Eigen::Quaterniond::FromTwoVectors(feature->normal, n);
      to_contact = state.pose.orientation * feature->point;
    } else {
      double radius = 0;
      for (const TargetShape& shape : problem.target->shapes) {
        if (const auto* sphere = std::get_if<Sphere>(&shape.geometry)) {
          radius = std::max(radius, sphere->radius);
        }
      }
      to_contact = radius * n;
    }
    state.pose.position = hand_N - to_contact;
  }
  const double reach = std::max(std::abs(first_time - state.time),
                                std::abs(configuration.contact_time - state.time));
  return TargetMotion(*problem.target, state, reach + problem.uncertainty.contact_time + 1);
}

ContactEvent contact_event(const CaptureProblem& problem, const TargetMotion* motion,
                           const Configuration& configuration) {
  ContactEvent event;
  const Matrix3d R_BN = configuration.base.orientation.conjugate().toRotationMatrix();
  const ImpulseSpec& impulse = problem.impulse;
  const bool in_base = impulse.direction_frame == Frame::Base;
  if (impulse.source == ImpulseSource::Given) {
    event.moment = in_base ? impulse.moment : Vector3d(R_BN * impulse.moment);
  } else if (!problem.target) {
    event.missing = "the contact law needs a target";
  }
  if (impulse.direction) {
    event.n = in_base ? *impulse.direction : Vector3d(R_BN * *impulse.direction);
    if (impulse.source == ImpulseSource::RigidBody) {
      event.missing = "a rigid body hits along the normal of its feature, not a stated direction";
    }
    return event;
  }
  const auto feature = feature_of(problem);
  if (!feature || motion == nullptr) {
    event.missing = "neither a direction nor a contact feature says where the impulse comes from";
    return event;
  }
  const double t = configuration.contact_time;
  event.feature = motion->contact(*feature, t);
  event.R_NT = motion->state(t).pose.orientation;
  event.n = R_BN * event.feature->normal;
  event.velocity = R_BN * event.feature->velocity;
  event.r = R_BN * event.feature->r;
  const Matrix3d R_BT = R_BN * event.R_NT.toRotationMatrix();
  event.target_inertia = R_BT * problem.target->inertia * R_BT.transpose();
  return event;
}

double closing_speed(const CaptureProblem& problem, const ContactEvent& event, const Vector3d& d) {
  return event.velocity ? d.dot(*event.velocity) : problem.impulse.closing_speed;
}

std::optional<Eigen::Quaterniond> wanted_hand_axes(const CaptureProblem& problem,
                                                   const ContactEvent& event,
                                                   const Configuration& configuration) {
  const HandSpec& hand = problem.hand;
  if (hand.constraint != HandConstraint::Pose) return std::nullopt;
  if (hand.orientation) {
    return hand.frame == Frame::Base ? configuration.base.orientation * *hand.orientation
                                     : *hand.orientation;
  }
  // Zero roll is the shortest turn in the frame that the normal is given in.
  const auto against = [&hand](const Eigen::Quaterniond& R_NE, const Vector3d& n_E) {
    return R_NE * rotation_exp(hand.roll * n_E) *
           Eigen::Quaterniond::FromTwoVectors(hand.approach_axis, -n_E);
  };
  if (event.feature) {
    return against(event.R_NT, event.R_NT.conjugate() * event.feature->normal);
  }
  const ImpulseSpec& impulse = problem.impulse;
  if (!impulse.direction) return std::nullopt;
  const bool in_base = impulse.direction_frame == Frame::Base;
  return against(in_base ? configuration.base.orientation : Eigen::Quaterniond::Identity(),
                 *impulse.direction);
}

PostureResponse posture_response(const CaptureProblem& problem, const Eigen::VectorXd& phi) {
  PostureResponse response;
  response.phi = phi;
  response.dynamics = reference::compute(problem.robot, {phi, {}, {}});
  response.added_inertia = added_inertia_of(problem.resistance, problem.robot.n());
  if (problem.resistance.model == ResistanceModel::Locked) {
    response.locked = problem.resistance.locked;
  }
  response.r_gh = response.dynamics.hand_position - response.dynamics.centroid;
  for (int i = 0; i < 6; ++i) {
    const reference::Impact unit = response.impact(Vector6d::Unit(i));
    response.B.col(i) = unit.Delta_Omega.tail<3>();
    if (i >= 3) continue;
    Eigen::VectorXd x(6 + phi.size());
    x << unit.Delta_Omega, unit.Delta_phidot;
    response.W.col(i) = response.dynamics.J.topRows(3) * x;
  }
  return response;
}

Vector6d impulse_along(const CaptureProblem& problem, const ContactEvent& event,
                       const PostureResponse& response, const Vector3d& d) {
  const ImpulseSpec& impulse = problem.impulse;
  Vector6d Fbar;
  Fbar << Vector3d::Zero(), event.moment;
  if (impulse.source == ImpulseSource::Given) {
    Fbar.head<3>() = impulse.magnitude * d;
    return Fbar;
  }
  const double v_n = closing_speed(problem, event, d);
  double inverse_mass = d.dot(response.W * d) + 1 / problem.target->mass;
  if (impulse.source == ImpulseSource::RigidBody) {
    const Vector3d arm = event.r.cross(d);
    inverse_mass += arm.dot(event.target_inertia.ldlt().solve(arm));
  }
  if (v_n > 0) Fbar.head<3>() = (1 + impulse.restitution) * v_n / inverse_mass * d;
  return Fbar;
}

NullSpace null_space(const Eigen::MatrixXd& A, double relative_tolerance) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeFullV);
  NullSpace space;
  const auto& sigma = svd.singularValues();
  for (Eigen::Index i = 0; i < sigma.size(); ++i) {
    if (sigma(i) > relative_tolerance * sigma(0)) ++space.rank;
  }
  const Eigen::MatrixXd V = svd.matrixV().leftCols(space.rank);
  space.projector = Eigen::MatrixXd::Identity(A.cols(), A.cols()) - V * V.transpose();
  return space;
}

}  // namespace stillbase::verification
