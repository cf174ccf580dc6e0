#include "verification/recomputation.hpp"

#include <stdexcept>

namespace stillbase::verification {
namespace {

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

}  // namespace

std::optional<ContactFeature> chosen_feature(const CaptureProblem& problem) {
  if (!problem.target || problem.variables.feature.empty()) return std::nullopt;
  for (const ContactFeature& feature : problem.target->features) {
    if (feature.name == problem.variables.feature) return feature;
  }
  return std::nullopt;
}

ContactEvent contact_event(const CaptureProblem& problem, const TargetMotion* motion,
                           const Configuration& configuration) {
  ContactEvent event;
  const Matrix3d R_BN = configuration.base.orientation.conjugate().toRotationMatrix();
  if (const auto feature = chosen_feature(problem); feature && motion != nullptr) {
    const double t = configuration.contact_time;
    event.feature = motion->contact(*feature, t);
    const Matrix3d R_BT = R_BN * motion->state(t).pose.orientation.toRotationMatrix();
    event.velocity = R_BN * event.feature->velocity;
    event.r = R_BN * event.feature->r;
    event.target_inertia = R_BT * problem.target->inertia * R_BT.transpose();
  }
  const ImpulseSpec& impulse = problem.impulse;
  const Matrix3d to_base =
      impulse.direction_frame == Frame::Base ? Matrix3d::Identity().eval() : R_BN;
  if (impulse.direction) {
    event.n = to_base * *impulse.direction;
  } else if (event.feature) {
    event.n = R_BN * event.feature->normal;
  } else {
    event.missing = "neither a direction nor a contact feature says where the impulse comes from";
  }
  if (impulse.source == ImpulseSource::Given) event.moment = to_base * impulse.moment;
  return event;
}

std::optional<double> closing_speed(const CaptureProblem& problem, const ContactEvent& event,
                                    const Vector3d& d) {
  if (problem.impulse.source == ImpulseSource::PointMass && problem.impulse.direction) {
    return problem.impulse.closing_speed;
  }
  if (event.velocity) return d.dot(*event.velocity);
  return std::nullopt;
}

PostureResponse posture_response(const CaptureProblem& problem, const Eigen::VectorXd& phi) {
  PostureResponse response;
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
  const auto v_n = closing_speed(problem, event, d);
  if (!v_n) throw std::logic_error("nothing says how fast target and hand close");
  double inverse_mass = d.dot(response.W * d) + 1 / problem.target->mass;
  if (impulse.source == ImpulseSource::RigidBody) {
    const Vector3d arm = event.r.cross(d);
    inverse_mass += arm.dot(event.target_inertia.ldlt().solve(arm));
  }
  if (*v_n > 0) Fbar.head<3>() = (1 + impulse.restitution) * *v_n / inverse_mass * d;
  return Fbar;
}

double objective_value(ObjectiveQuantity quantity, const PostureResponse& response,
                       const Vector6d& Fbar) {
  const Vector3d Delta_omega = response.B * Fbar;
  switch (quantity) {
    case ObjectiveQuantity::BaseAngularMomentum:
      return (response.dynamics.Htilde_omega * Delta_omega).norm();
    case ObjectiveQuantity::BaseAngularVelocity:
      return Delta_omega.norm();
    case ObjectiveQuantity::TotalAngularMomentum:
      return (response.r_gh.cross(Vector3d(Fbar.head<3>())) + Fbar.tail<3>()).norm();
  }
  throw std::logic_error("no such objective");
}

double objective_scale(ObjectiveQuantity quantity, const PostureResponse& response,
                       const Vector6d& Fbar) {
  const double momentum = response.momentum_scale(Fbar);
  return quantity == ObjectiveQuantity::BaseAngularVelocity
             ? 3 * momentum / response.dynamics.Htilde_omega.trace()
             : momentum;
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
