#include "verification/contact_case.hpp"

#include <algorithm>
#include <cmath>

namespace stillbase::verification {

ContactCase contact_case(const CaptureProblem& problem, const TargetMotion* motion,
                         const ContactEvent& event, const PostureResponse& response,
                         const Configuration& configuration, const Vector3d& d,
                         const Vector6d& Fbar, double speed_factor,
                         const Vector6d& velocity_error) {
  const reference::Impact impact = response.impact(Fbar);
  const Pose& base = configuration.base;
  ContactCase subject;
  subject.robot = problem.robot;
  subject.resistance = problem.resistance;
  subject.before = state_at_rest(base, configuration.phi);
  subject.before.wheel_momentum = problem.post_impact.wheels.preset;
  if (response.before) {
    subject.before.Omega = response.before->Omega;
    subject.before.phidot = response.before->phidot;
  }
  subject.after = subject.before;
  subject.after.Omega = impact.Delta_Omega;
  subject.after.phidot = impact.Delta_phidot;
  subject.impulse = Fbar.head<3>().norm();
  subject.closing_speed = closing_speed(problem, event, d);
  subject.law = problem.impulse.contact;
  subject.restitution = problem.impulse.restitution;
  subject.normal_N = base.orientation * d;
  if (motion == nullptr || !problem.target) return subject;

  TargetAtContact target{*problem.target, {}};
  if (problem.impulse.source == ImpulseSource::PointMass) target.body.inertia.setZero();
  const TargetState state = motion->state(configuration.contact_time);
  target.state.pose = state.pose;
  if (event.feature) {
    const Vector3d hand_N = base * Vector3d(response.dynamics.hand_position);
    target.state.pose.position = hand_N - base.orientation * event.r;
  }
  const bool is_point_mass = problem.impulse.source == ImpulseSource::PointMass;
  const Vector3d v = velocity_error.head<3>(), omega = velocity_error.tail<3>();
  const Vector3d of_centroid = is_point_mass ? v : Vector3d(v - omega.cross(event.r));
  target.state.velocity = speed_factor * state.linear_velocity + base.orientation * of_centroid;
  const Vector3d omega_N = speed_factor * state.angular_velocity + base.orientation * omega;
  target.state.angular_velocity = state.pose.orientation.conjugate() * omega_N;
  subject.target = target;
  return subject;
}

double largest_fraction(const RobotModel& robot, const JointVectord& peaks, double Joint::*limit) {
  double fraction = 0;
  for (int k = 0; k < robot.n(); ++k) {
    const double most = robot.joints[k].*limit;
    if (std::isfinite(most) && peaks(k) > 0) fraction = std::max(fraction, peaks(k) / most);
  }
  return fraction;
}

}  // namespace stillbase::verification
