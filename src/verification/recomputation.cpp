#include "verification/recomputation.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/core/linear_algebra.hpp>

namespace stillbase::verification {
namespace {

/// What the joint resistance adds to the joint inertia during the impact (n). Servo: stiffness K
/// and damping D over a contact of duration h under a constant force add h D/2 + h^2 K/6, to
/// leading order.
Eigen::VectorXd added_inertia_of(const JointResistance& resistance, int n) {
  const double h = resistance.contact_duration;
  switch (resistance.model) {
    case ResistanceModel::RotorInertia:
      return resistance.rotor_inertia;
    case ResistanceModel::Servo:
      return h / 2 * resistance.damping + h * h / 6 * resistance.stiffness;
    case ResistanceModel::Free:
    case ResistanceModel::Locked:
      break;
  }
  return Eigen::VectorXd::Zero(n);
}

Matrix3d base_axes_of_inertial(const Configuration& at) {
  return at.base.orientation.conjugate().toRotationMatrix();
}

/// Part of the inverse mass along d, 1/kg, that the rotation of the target adds.
double rotational_inverse_mass(const Matrix3d& inertia, const Vector3d& r, const Vector3d& d) {
  const Vector3d arm = r.cross(d);
  return arm.dot(inertia.ldlt().solve(arm));
}

}  // namespace

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
      state.pose.orientation = rotation_between(feature->normal, n);
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
  const Matrix3d R_BN = base_axes_of_inertial(configuration);
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
      event.missing = "a rigid body's impulse is along the normal of its feature, not a stated one";
    }
    return event;
  }
  const auto feature = feature_of(problem);
  if (!feature || motion == nullptr) {
    event.missing = "neither a direction nor a contact feature fixes the impulse's direction";
    return event;
  }
  const double t = configuration.contact_time;
  event.feature = motion->contact(*feature, t);
  event.R_NT = motion->state(t).pose.orientation;
  event.n = R_BN * event.feature->normal;
  event.velocity = R_BN * event.feature->velocity;
  event.omega = R_BN * motion->state(t).angular_velocity;
  event.r = R_BN * event.feature->r;
  const Matrix3d R_BT = R_BN * event.R_NT.toRotationMatrix();
  event.target_inertia = R_BT * problem.target->inertia * R_BT.transpose();
  return event;
}

double closing_speed(const CaptureProblem& problem, const ContactEvent& event, const Vector3d& d) {
  return event.velocity ? d.dot(*event.velocity) : problem.impulse.closing_speed;
}

std::optional<Eigen::Quaterniond> demanded_hand_axes(const CaptureProblem& problem,
                                                     const ContactEvent& event,
                                                     const Configuration& configuration) {
  const HandSpec& hand = problem.hand;
  if (hand.constraint != HandConstraint::Pose) return std::nullopt;
  if (hand.orientation) {
    return hand.frame == Frame::Base ? configuration.base.orientation * *hand.orientation
                                     : *hand.orientation;
  }
  // Zero roll is the shortest rotation in the frame E that the normal is given in.
  const auto against = [&hand](const Eigen::Quaterniond& R_NE, const Vector3d& n_E) {
    return R_NE * rotation_exp(hand.roll * n_E) * rotation_between(hand.approach_axis, -n_E);
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

Eigen::MatrixXd base_response(const reference::Dynamics& d) {
  return -reference::solve_definite(d.H.topLeftCorner(6, 6), d.H.topRightCorner(6, d.H.cols() - 6));
}

Eigen::MatrixXd hand_response(const reference::Dynamics& d) {
  return d.J.leftCols(6) * base_response(d) + d.J.rightCols(d.H.cols() - 6);
}

Eigen::VectorXd velocity_jump(const reference::Impact& impact) {
  Eigen::VectorXd x(6 + impact.Delta_phidot.size());
  x << impact.Delta_Omega, impact.Delta_phidot;
  return x;
}

double PostureResponse::momentum_scale(const Vector6d& Fbar) const {
  if (held) return held->size;
  const double arms = dynamics.hand_position.norm() + dynamics.centroid.norm();
  if (r_gh.norm() <= 1e-6 * arms) return rounding_scale(Fbar);
  return Fbar.head<3>().norm() * r_gh.norm() + Fbar.tail<3>().norm();
}

double PostureResponse::rounding_scale(const Vector6d& Fbar) const {
  const double arms = dynamics.hand_position.norm() + dynamics.centroid.norm();
  return Fbar.head<3>().norm() * arms + Fbar.tail<3>().norm() + (held ? held->size : 0);
}

PostureResponse posture_dynamics(const CaptureProblem& problem, const Eigen::VectorXd& phi) {
  PostureResponse response;
  response.phi = phi;
  response.dynamics = reference::compute(problem.robot, {phi, {}, {}});
  response.added_inertia = added_inertia_of(problem.resistance, problem.robot.n());
  if (problem.resistance.model == ResistanceModel::Locked) {
    response.locked = problem.resistance.locked;
  }
  response.r_gh = response.dynamics.hand_position - response.dynamics.centroid;
  response.H_b = response.dynamics.H.topLeftCorner<6, 6>();
  return response;
}

void PostureResponse::hold(const reference::MetBody& body) {
  const Matrix6d T = reference::centroid_from_hand(body);
  Matrix6d M = Matrix6d::Zero();
  M.diagonal().head<3>().setConstant(body.mass);
  M.bottomRightCorner<3, 3>() = body.inertia;
  // The body's kinetic energy is one of the hand's velocity.
  const Eigen::MatrixXd& J = dynamics.J;
  const Eigen::MatrixXd H = dynamics.H + J.transpose() * (T.transpose() * M * T) * J;
  const Eigen::Index n = H.cols() - 6;
  H_b = H.topLeftCorner<6, 6>();
  // (2), the translation eliminated.
  const Matrix3d H_vomega = H_b.topRightCorner<3, 3>();
  const double mass = dynamics.mass + body.mass;
  dynamics.Htilde_omega = H_b.bottomRightCorner<3, 3>() - H_vomega.transpose() * H_vomega / mass;
  dynamics.Htilde_omegaphi =
      H.block(3, 6, 3, n) - H_vomega.transpose() * H.block(0, 6, 3, n) / mass;

  const Vector3d centroid = dynamics.hand_position - body.r;
  const Vector3d common = (dynamics.mass * dynamics.centroid + body.mass * centroid) / mass;
  const Vector3d spin = body.inertia * body.omega;
  const double reduced = dynamics.mass * body.mass / mass;
  held = HeldMomentum{
      spin + body.mass * Vector3d(centroid - common).cross(body.velocity),
      spin.norm() + reduced * (centroid - dynamics.centroid).norm() * body.velocity.norm()};
}

reference::Impact PostureResponse::jump(const Vector6d& Fbar) const {
  reference::Impact out = reference::impact(dynamics, added_inertia, locked, Fbar);
  if (held) out.total = Fbar.isZero(0) ? Vector3d(Vector3d::Zero()) : held->total;
  return out;
}

reference::Impact PostureResponse::impact(const Vector6d& Fbar) const {
  reference::Impact out = jump(Fbar);
  if (!before) return out;
  out.Delta_Omega += before->Omega;
  out.Delta_phidot += before->phidot;
  out.base = dynamics.Htilde_omega * out.Delta_Omega.tail<3>();
  out.coupling = dynamics.Htilde_omegaphi * out.Delta_phidot;
  if (held) out.total = held->total;  // the robot brings none along
  return out;
}

PostureResponse posture_response(const CaptureProblem& problem, const Eigen::VectorXd& phi) {
  PostureResponse response = posture_dynamics(problem, phi);
  for (int i = 0; i < 6; ++i) {
    const reference::Impact unit = response.impact(Vector6d::Unit(i));
    response.B.col(i) = unit.Delta_Omega.tail<3>();
    response.W.col(i) = response.dynamics.J * velocity_jump(unit);
  }
  return response;
}

reference::MetBody met_body(const CaptureProblem& problem, const ContactEvent& event) {
  const bool is_rigid = problem.impulse.source == ImpulseSource::RigidBody;
  reference::MetBody body;
  body.mass = problem.target->mass;
  body.velocity = event.velocity ? *event.velocity : problem.impulse.closing_speed * event.n;
  if (!is_rigid) return body;
  body.inertia = event.target_inertia;
  body.r = event.r;
  body.omega = event.omega;
  body.velocity -= event.omega.cross(event.r);
  return body;
}

void hold_latched(const CaptureProblem& problem, const ContactEvent& event,
                  PostureResponse& response) {
  if (problem.impulse.contact == ContactLaw::Latch) response.hold(met_body(problem, event));
}

namespace {

/// @param body as it moves in N
Vector6d joining_impulse(const CaptureProblem& problem, reference::MetBody body,
                         const PostureResponse& response) {
  // Only the velocities relative to the hand count: all move as if it were at rest.
  if (response.before) {
    const Vector3d v = response.before->hand.head<3>(), omega = response.before->hand.tail<3>();
    body.velocity -= v - omega.cross(body.r);
    body.omega -= omega;
  }
  return reference::impulse_that_joins(response.dynamics, response.added_inertia, response.locked,
                                       body, problem.impulse.contact == ContactLaw::Latch);
}

bool is_rigid_contact(const CaptureProblem& problem) {
  return problem.impulse.contact != ContactLaw::Frictionless;
}

}  // namespace

bool separates(const CaptureProblem& problem, const ContactEvent& event,
               const PostureResponse& response, const Vector3d& d) {
  if (response.before && problem.impulse.contact == ContactLaw::Latch) return false;
  const double of_hand = response.before ? d.dot(response.before->hand.head<3>()) : 0;
  return !(closing_speed(problem, event, d) - of_hand > 0);
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
  if (separates(problem, event, response, d)) return Vector6d::Zero();
  if (is_rigid_contact(problem)) {
    Fbar = joining_impulse(problem, met_body(problem, event), response);
    const bool pulls = problem.impulse.contact == ContactLaw::Sticking && d.dot(Fbar.head<3>()) < 0;
    return pulls ? Vector6d(Vector6d::Zero()) : Fbar;
  }
  double inverse_mass = d.dot(response.W.topLeftCorner<3, 3>() * d) + 1 / problem.target->mass;
  if (impulse.source == ImpulseSource::RigidBody) {
    inverse_mass += rotational_inverse_mass(event.target_inertia, event.r, d);
  }
  const double v_n = closing_speed(problem, event, d);
  Fbar.head<3>() = (1 + impulse.restitution) * v_n / inverse_mass * d;
  return Fbar;
}

Vector6d case_wrench(const CaptureProblem& problem, const ContactEvent& event,
                     const PostureResponse& response) {
  if (is_rigid_contact(problem)) return impulse_along(problem, event, response, event.n);
  Vector6d unit;
  unit << event.n, event.moment;
  if (problem.impulse.source == ImpulseSource::Given) unit.tail<3>() /= problem.impulse.magnitude;
  return unit;
}

Vector6d scenario_impulse(const CaptureProblem& problem, const TargetMotion* motion,
                          const Configuration& configuration, PostureResponse& response,
                          const Scenario& scenario) {
  const ImpulseSpec& impulse = problem.impulse;
  const Matrix3d R_BN = base_axes_of_inertial(configuration);
  // Of the frame E in which the scenario's vectors are given.
  Matrix3d R_BE = Matrix3d::Identity();
  if (impulse.direction && impulse.direction_frame == Frame::Inertial) R_BE = R_BN;

  double closing_speed = impulse.closing_speed;
  reference::MetBody body;
  Vector3d r = Vector3d::Zero();  // from the target's centroid to the contact, in E
  if (!impulse.direction) {
    const TargetState state = motion->state(configuration.contact_time + scenario.time_offset);
    R_BE = R_BN * state.pose.orientation.toRotationMatrix();
    r = feature_of(problem)->point + scenario.contact_offset;
    const Vector3d velocity_N =
        state.linear_velocity + state.angular_velocity.cross(state.pose.orientation * r);
    closing_speed = velocity_N.dot(state.pose.orientation * scenario.direction);
    const bool is_point_mass = impulse.source == ImpulseSource::PointMass;
    body.velocity = R_BN * (is_point_mass ? velocity_N : state.linear_velocity);
    body.omega = R_BN * state.angular_velocity;
  } else {
    body.velocity = closing_speed * (R_BE * *impulse.direction);
  }
  if (is_rigid_contact(problem)) {
    const Vector3d n = impulse.direction ? *impulse.direction : feature_of(problem)->normal;
    body.velocity += scenario.closing_speed_offset * (R_BE * n);
    body.mass = problem.target->mass * scenario.target_mass_factor;
    if (impulse.source == ImpulseSource::RigidBody) {
      body.r = R_BE * r;
      body.inertia =
          R_BE * problem.target->inertia * R_BE.transpose() * scenario.target_inertia_factor;
    }
    if (impulse.contact == ContactLaw::Latch) response.hold(body);
    return joining_impulse(problem, body, response);
  }
  closing_speed += scenario.closing_speed_offset;

  const Vector3d d = R_BE * scenario.direction;
  Vector6d unit;
  unit << d, (R_BE * scenario.contact_offset).cross(d);
  if (impulse.source == ImpulseSource::Given) {
    Vector6d Fbar = impulse.magnitude * unit;
    Fbar.tail<3>() += R_BE * impulse.moment;
    return Fbar;
  }
  if (!(closing_speed > 0)) return Vector6d::Zero();
  double inverse_mass =
      unit.dot(response.W * unit) + 1 / (problem.target->mass * scenario.target_mass_factor);
  if (impulse.source == ImpulseSource::RigidBody) {
    inverse_mass += rotational_inverse_mass(problem.target->inertia, r, scenario.direction) /
                    scenario.target_inertia_factor;
  }
  return (1 + scenario.restitution) * closing_speed / inverse_mass * unit;
}

namespace {

/// Nothing when a configuration uses the contact feature that the problem names itself.
std::optional<CaptureProblem> with_feature(const CaptureProblem& problem, const Configuration& at) {
  if (at.feature.empty() || at.feature == problem.variables.feature) return std::nullopt;
  CaptureProblem other = problem;
  other.variables.feature = at.feature;
  return other;
}

}  // namespace

Situation::Situation(const CaptureProblem& stated, const Configuration& configuration,
                     std::optional<double> first_time)
    : other_feature_(with_feature(stated, configuration)),
      problem(other_feature_ ? *other_feature_ : stated),
      at(configuration),
      response_(posture_response(problem, at.phi)),
      response(response_),
      hand_N(at.base * Vector3d(response.dynamics.hand_position)),
      R_NH(at.base.orientation * Eigen::Quaterniond(Matrix3d(response.dynamics.hand_rotation))),
      motion(target_motion(problem, at, hand_N, first_time.value_or(at.contact_time))),
      event(contact_event(problem, target(), at)) {
  if (event.missing.empty()) prepare_contact(problem, event, at, response_);
}

std::optional<Pose> Situation::target_pose() const {
  if (!motion) return std::nullopt;
  return motion->state(at.contact_time).pose;
}

VanishingMomenta vanishing_momenta(CaseConstraint wanted) {
  using reference::Impact;
  switch (wanted) {
    case CaseConstraint::None:
      break;
    case CaseConstraint::C:
    case CaseConstraint::C1:
      return {{&Impact::total}, "total momentum"};
    case CaseConstraint::C2:
      return {{&Impact::total, &Impact::base, &Impact::coupling},
              "total momentum, base part and coupling part"};
    case CaseConstraint::G2:
      return {{&Impact::base}, "base part"};
    case CaseConstraint::G3:
      return {{&Impact::coupling}, "coupling part"};
  }
  return {};
}

CaseResiduals case_residuals(const CaptureProblem& problem, const PostureResponse& response,
                             const Vector6d& Fbar) {
  const reference::Impact impact = response.impact(Fbar);
  const double scale = response.momentum_scale(Fbar);
  const double divisor = scale > 0 ? scale : 1;
  CaseResiduals out{impact.total.norm() / divisor, impact.base.norm() / divisor,
                    impact.coupling.norm() / divisor, 0};
  for (const auto momentum : vanishing_momenta(problem.constraints.impact_case).momenta) {
    out.wanted = std::max(out.wanted, (impact.*momentum).norm() / divisor);
  }
  return out;
}

NullSpace null_space(const Eigen::MatrixXd& A, double relative_tolerance) {
  const Svd svd = right_svd(A);
  NullSpace space;
  space.rank = numerical_rank(svd.sigma, relative_tolerance);
  const Eigen::MatrixXd V = svd.V.leftCols(space.rank);
  space.projector = Eigen::MatrixXd::Identity(A.cols(), A.cols()) - V * V.transpose();
  return space;
}

}  // namespace stillbase::verification
