#include "verification/contact_case.hpp"

#include <algorithm>
#include <cmath>

namespace stillbase::verification {

ContactCase contact_case(const CaptureProblem& problem, const TargetMotion* motion,
                         const ContactEvent& event, const PostureResponse& response,
                         const Configuration& configuration, const Vector3d& d,
                         const Vector6d& Fbar, double speed_factor) {
  const reference::Impact impact = response.impact(Fbar);
  const Pose& base = configuration.base;
  ContactCase subject;
  subject.robot = problem.robot;
  subject.resistance = problem.resistance;
  subject.before = state_at_rest(base, configuration.phi);
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
  target.state.velocity = speed_factor * state.linear_velocity;
  target.state.angular_velocity =
      state.pose.orientation.conjugate() * Vector3d(speed_factor * state.angular_velocity);
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
