#include <stillbase/verification/trials.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/core/parallel.hpp>
#include <stillbase/core/random.hpp>

#include "verification/claim_list.hpp"
#include "verification/contact_case.hpp"
#include "verification/objective.hpp"

namespace stillbase {
namespace verification {
namespace {

/// Steps and errors of a trial, which is one of many.
struct TrialSimulationOptions {
  double longest_step = 0.01;  ///< s; shorter where the period of control is
  /// rad by which base and joints move in a step of the midpoint rule at most: its part of the
  /// error of a velocity is a 24th of the square, 1e-6. Faster motions take Runge and Kutta's.
  double step_angle = 0.005;
  /// Errors of a step of a compliant contact: trials are random, unlike verified motions.
  double relative_step = 1e-7, absolute_step = 1e-9;
  int together = 8;             ///< trials that are simulated side by side
  double just_kept = 1 + 1e-6;  ///< of a limit that is kept but for the integration
  /// Half ranges of what a problem with a target does not state: relative, and s.
  double closing_speed = 0.05, contact_time = 0.1;
};
constexpr TrialSimulationOptions kTrial;

/// A direction of the cone about n: uniform on the cap, or in the wedge.
Vector3d drawn_direction(const CaptureProblem& problem, const Vector3d& n, double half_angle,
                         Random& random, double& angle) {
  const double along = random.uniform(), around = 2 * kPi * random.uniform();
  angle = 0;
  if (!(half_angle > 0)) return n;
  const auto& plane = problem.uncertainty.cone_plane_normal;
  angle = plane ? half_angle * (2 * along - 1) : std::acos(1 - along * (1 - std::cos(half_angle)));
  return cone_direction(n, plane, angle, around);
}

/// A trial as drawn: its impact is known, the motion after it is still to be simulated.
struct DrawnTrial {
  CaptureProblem truth;
  TrialOutcome outcome;
  std::optional<ContactCase> subject;  ///< empty: no controller moves the robot after the impact
  SimulationOptions options;
};

/// The controller's model is the robot of the plan, with the errors that the problem states.
SimulationOptions trial_options(const PostImpactSpec& spec, const RobotModel& planned,
                                const Perturbations& sizes, std::uint64_t seed, int trial,
                                const StopCondition& stop) {
  SimulationOptions options = plant_options_of(spec, planned);
  options.integrator = IntegratorKind::Midpoint;
  options.step = std::min(kTrial.longest_step, spec.control_period);
  options.output_period = 0;
  if (!options.controller_robot) options.controller_robot = planned;
  if (spec.contact.model == ContactModel::Compliant) {
    // A contact of milliseconds sets the step.
    options.integrator = IntegratorKind::Dopri5;
    options.relative_tolerance = kTrial.relative_step;
    options.absolute_tolerance = kTrial.absolute_step;
  }
  options.sensors.base_rate_error = sizes.base_rate_error;
  options.sensors.joint_rate_error = sizes.joint_rate_error;
  options.sensors.seed = seed;
  // Streams of the sensors are apart from those that draw the trials.
  options.sensors.stream = (std::uint64_t{1} << 32) + static_cast<std::uint64_t>(trial);
  options.stop = stop;
  return options;
}

bool is_too_fast(const SimulationSummary& summary, const SimulationOptions& options) {
  const double rate = summary.peak_base_rate + summary.peak_joint_rate;
  return options.integrator == IntegratorKind::Midpoint &&
         !(rate * options.step <= kTrial.step_angle);
}

void put_motion(const CaptureProblem& truth, const SimulationResult& run, TrialOutcome& outcome) {
  const PostImpactSpec& spec = truth.post_impact;
  const SimulationSummary& summary = run.summary;
  outcome.finished = run.status == SimulationStatus::Finished;
  outcome.residual_base_rate = summary.residual_base_rate;
  outcome.attitude_turned = summary.attitude_turned;
  outcome.peak_rate_part =
      largest_fraction(truth.robot, summary.peak_joint_rates, &Joint::max_velocity);
  outcome.peak_torque_part =
      largest_fraction(truth.robot, summary.peak_demanded_torques, &Joint::max_effort);
  const GripSpec& grip = spec.grip;
  outcome.peak_grip_part = std::max(summary.peak_grip_force / grip.force.value_or(kInfinity),
                                    summary.peak_grip_moment / grip.moment.value_or(kInfinity));
  const WheelSpec& wheels = spec.wheels;
  for (int i = 0; i < 3 && wheels.exist(); ++i) {
    const double held = summary.peak_wheel_momenta[i];
    if (!(held > 0)) continue;
    outcome.peak_wheel_part = std::max(outcome.peak_wheel_part, held / wheels.momentum[i]);
  }
  outcome.rests = summary.rest_time.has_value();
  outcome.stop_hits = summary.stop_hits;
}

/// Errors of a target's estimate, normal and not cut.
EstimateVector drawn_error(const EstimateDeviations& deviations, Random& random) {
  EstimateVector error = covariance_of(deviations).diagonal().cwiseSqrt();
  for (double& x : error) x *= random.normal();
  return error;
}

/// [v; omega] in B by which the relative velocity is off: all of it where its covariance is stated,
/// else the hand's tracking alone. Gaussian, not cut.
Vector6d drawn_velocity_error(const ResidualVelocity& residual, const Situation& nominal,
                              Random& random) {
  Vector6d z;
  for (double& x : z) x = random.normal();
  if (!residual.covariance) {
    z.head<3>() *= residual.linear_tracking;
    z.tail<3>() *= residual.angular_tracking;
    return z;
  }
  const SymmetricEigen eigen = symmetric_eigen(*residual.covariance);
  const Vector6d error = eigen.vectors * eigen.values.cwiseMax(0).cwiseSqrt().cwiseProduct(z);
  const Matrix3d R_BN = nominal.at.base.orientation.conjugate().toRotationMatrix();
  const bool in_target = residual.frame == ResidualFrame::Target;
  const Matrix3d R = in_target ? Matrix3d(R_BN * nominal.event.R_NT.toRotationMatrix()) : R_BN;
  Vector6d out;
  out << R * error.head<3>(), R * error.tail<3>();
  return out;
}

/// [v; omega] of the target at the hand's origin, in B.
Vector6d velocity_of(const ContactEvent& event) {
  Vector6d out;
  out << *event.velocity, event.omega;
  return out;
}

/// Whether the contact takes place as drawn. The least closing speed is one towards a hand at rest:
/// it does not count where the hand moves along.
bool is_hit(const CaptureProblem& truth, const ContactEvent& event, const PostureResponse& response,
            const Vector3d& d, const Vector6d& Fbar) {
  if (truth.impulse.source == ImpulseSource::Given) return true;
  if (separates(truth, event, response, d)) return false;
  const bool would_pull = truth.impulse.contact == ContactLaw::Sticking && Fbar.isZero(0);
  if (response.before) return !would_pull;
  const double least = truth.constraints.closing_speed_min - kFeasibilityTolerance;
  return !would_pull && closing_speed(truth, event, d) >= least;
}

DrawnTrial draw_trial(const Situation& nominal, const Perturbations& sizes, std::uint64_t seed,
                      int trial, const StopCondition& stop) {
  Random random(seed, static_cast<std::uint64_t>(trial));
  DrawnTrial drawn_trial{nominal.problem, {}, {}, {}};
  CaptureProblem& truth = drawn_trial.truth;
  TrialOutcome& outcome = drawn_trial.outcome;
  Configuration at = nominal.at;
  const auto draw = [&](double size) {
    const double x = size * random.uniform(-1, 1);
    outcome.inputs.push_back(x);
    return x;
  };

  // The order of the draws is that of trial_input_names().
  double angle = 0;
  const Vector3d base_n = nominal.event.n;
  // A cone that follows from the covariance stands for the errors that are drawn below.
  const bool has_estimate = sizes.estimate && nominal.motion && !truth.impulse.direction;
  const bool is_cone_drawn = !(has_estimate && truth.uncertainty.cone_confidence);
  const Vector3d direction =
      drawn_direction(truth, base_n, is_cone_drawn ? sizes.cone_half_angle : 0, random, angle);
  outcome.inputs.push_back(angle);
  const double nominal_speed = closing_speed(truth, nominal.event, base_n);
  const bool is_absolute = sizes.closing_speed_error > 0 && nominal_speed > 0;
  const double faster =
      draw(is_absolute ? sizes.closing_speed_error / nominal_speed : sizes.closing_speed);
  truth.impulse.restitution =
      std::clamp(truth.impulse.restitution + draw(sizes.restitution), 0.0, 1.0);
  const double heavier = draw(sizes.target_mass), stiffer = draw(sizes.target_inertia);
  if (truth.target) {
    truth.target->mass *= 1 + heavier;
    truth.target->inertia *= 1 + stiffer;
  }
  const double radius = sizes.contact_point * std::sqrt(random.uniform());
  const double azimuth = 2 * kPi * random.uniform();
  outcome.inputs.push_back(radius);
  const double later = draw(sizes.contact_time);
  double robot_mass = 0;
  const auto scale_body = [&](Body& body) {
    const double factor = 1 + sizes.robot_mass * random.uniform(-1, 1);
    robot_mass += body.mass * (factor - 1);
    body.mass *= factor;
    body.inertia *= factor;
  };
  scale_body(truth.robot.base);
  for (Body& body : truth.robot.bodies) scale_body(body);
  outcome.inputs.push_back(robot_mass / nominal.response.dynamics.mass);

  double posture_error = 0;
  for (int k = 0; k < sizes.joint_position.size(); ++k) {
    const double error = sizes.joint_position[k] * random.uniform(-1, 1);
    at.phi[k] += error;
    posture_error = std::hypot(posture_error, error);
  }
  outcome.inputs.push_back(posture_error);
  EstimateVector error = EstimateVector::Zero();
  if (has_estimate) error = drawn_error(*sizes.estimate, random);
  for (const int part :
       {kPositionError, kOrientationError, kLinearVelocityError, kAngularVelocityError}) {
    outcome.inputs.push_back(error.segment<3>(part).norm());
  }

  // The contact at that time, its direction rotated as the nominal one was.
  if (nominal.motion && !truth.impulse.direction) at.contact_time += later;
  const TargetMotion* motion = nominal.target();
  std::optional<TargetMotion> drawn;
  if (has_estimate) {
    const TargetEstimate estimate = with_error({*truth.target, truth.target_state}, error);
    truth.target = estimate.body;
    truth.target_state = estimate.state;
    drawn = target_motion(truth, at, nominal.hand_N, at.contact_time);
    motion = &*drawn;
  }
  ContactEvent event = contact_event(truth, motion, at);
  const Eigen::Quaterniond deviation = rotation_between(base_n, direction);
  const Vector3d d = (deviation * event.n).normalized();
  if (has_estimate) outcome.inputs.front() = angle_between(base_n, d);
  truth.impulse.closing_speed *= 1 + faster;
  truth.impulse.magnitude *= 1 + faster;
  if (event.velocity) *event.velocity *= 1 + faster;
  event.omega *= 1 + faster;
  Vector6d off = Vector6d::Zero(), velocity_error = Vector6d::Zero();
  if (sizes.residual_velocity && event.velocity) {
    off = drawn_velocity_error(*sizes.residual_velocity, nominal, random);
    velocity_error = off;
    // A stated covariance is about the nominal velocity, wherever the drawn motion has led.
    if (sizes.residual_velocity->covariance) {
      velocity_error += (1 + faster) * velocity_of(nominal.event) - velocity_of(event);
    }
    *event.velocity += velocity_error.head<3>();
    event.omega += velocity_error.tail<3>();
  }
  outcome.inputs.push_back(off.head<3>().norm());
  outcome.inputs.push_back(off.tail<3>().norm());
  if (event.velocity) outcome.target_velocity = velocity_of(event);

  // The contact is off the hand's origin: its point on the hand is where the impulse acts.
  const Vector3d e1 = d.unitOrthogonal(), e2 = d.cross(e1);
  const Vector3d offset = radius * (std::cos(azimuth) * e1 + std::sin(azimuth) * e2);
  Vector3d miss = Vector3d::Zero();
  if (has_estimate) {
    const ContactEvent expected = contact_event(nominal.problem, nominal.target(), at);
    const Vector3d apart =
        at.base.orientation.conjugate() * Vector3d(event.feature->point - expected.feature->point);
    miss = apart - d.dot(apart) * d;
  }
  const Matrix3d R_Bhand = sizes.joint_position.size() > 0
                               ? posture_dynamics(truth, at.phi).dynamics.hand_rotation
                               : nominal.response.dynamics.hand_rotation;
  truth.robot.p_hand += truth.robot.R_hand * (R_Bhand.transpose() * (offset + miss));
  event.r += offset;
  velocity_error.head<3>() += velocity_error.tail<3>().cross(offset);  // of the point that is met
  const bool is_joining = truth.impulse.contact != ContactLaw::Frictionless;
  if (event.velocity && is_joining) *event.velocity += event.omega.cross(offset);

  PostureResponse response = posture_response(truth, at.phi);
  // The joints move as planned, whatever the target does.
  if (nominal.response.before) response.move(nominal.response.before->phidot);
  hold_latched(truth, event, response);
  const Vector6d Fbar = impulse_along(truth, event, response, d);
  outcome.impulse = Fbar.head<3>().norm();
  outcome.hit = is_hit(truth, event, response, d, Fbar);
  outcome.objective = objective_value(truth, response, Fbar, &nominal.problem.robot);
  const reference::Impact impact = response.impact(Fbar);
  outcome.base_rate_jump = impact.Delta_Omega.tail<3>().norm();
  outcome.finished = truth.post_impact.controllers.empty();
  if (outcome.finished) return drawn_trial;
  drawn_trial.options =
      trial_options(truth.post_impact, nominal.problem.robot, sizes, seed, trial, stop);
  ContactCase subject =
      contact_case(truth, motion, event, response, at, d, Fbar, 1 + faster, velocity_error);
  subject.known_target = nominal.problem.target;
  if (truth.post_impact.contact.model == ContactModel::Compliant) {
    subject.restitution = std::max(subject.restitution, kLeastRestitution);
  }
  drawn_trial.subject = std::move(subject);
  return drawn_trial;
}

/// Trials first .. first + count - 1, simulated side by side.
std::vector<TrialOutcome> run_together(const Situation& nominal, const Perturbations& sizes,
                                       std::uint64_t seed, int first, int count,
                                       const StopCondition& stop) {
  std::vector<DrawnTrial> trials;
  trials.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    trials.push_back(draw_trial(nominal, sizes, seed, first + i, stop));
  }
  const PostImpactSpec& spec = nominal.problem.post_impact;
  if (!spec.controllers.empty()) {
    const auto controller = chosen_controller(spec);
    if (!controller) throw std::invalid_argument("no controller " + spec.controllers.front());
    std::vector<ContactCase> subjects;
    std::vector<SimulationOptions> options;
    for (DrawnTrial& trial : trials) {
      subjects.push_back(std::move(trial.subject.value()));
      options.push_back(std::move(trial.options));
    }
    const auto runs = simulate_after_contacts(subjects, spec, *controller, options);
    for (std::size_t i = 0; i < trials.size(); ++i) {
      SimulationResult run = runs[i].simulation;
      if (is_too_fast(run.summary, options[i])) {
        options[i].integrator = IntegratorKind::Rk4;
        run = simulate_after_contact(subjects[i], spec, *controller, options[i]).simulation;
      }
      put_motion(trials[i].truth, run, trials[i].outcome);
    }
  }
  std::vector<TrialOutcome> outcomes;
  for (DrawnTrial& trial : trials) {
    trial.outcome.success = trial_failure(trial.outcome, trial.truth.post_impact).empty();
    outcomes.push_back(std::move(trial.outcome));
  }
  return outcomes;
}

}  // namespace
}  // namespace verification

Perturbations perturbations_for(const CaptureProblem& problem) {
  Perturbations sizes;
  sizes.cone_half_angle = problem.uncertainty.cone_half_angle;
  sizes.closing_speed = verification::kTrial.closing_speed;
  const bool is_predicted = problem.target && !problem.impulse.direction;
  sizes.contact_time = is_predicted ? verification::kTrial.contact_time : 0;
  // The problem's own statements come first.
  const UncertaintySpec& stated = problem.uncertainty;
  const auto take = [](double from, double& size) {
    if (from > 0) size = from;
  };
  if (problem.impulse.closing_speed > 0) {
    take(stated.closing_speed / problem.impulse.closing_speed, sizes.closing_speed);
  } else if (is_predicted) {
    sizes.closing_speed_error = stated.closing_speed;
  }
  sizes.joint_position = stated.joint_position;
  if (is_predicted && stated.residual_velocity) {
    sizes.residual_velocity = stated.residual_velocity;
    sizes.closing_speed = sizes.closing_speed_error = 0;  // a part of it
  }
  if (is_predicted) sizes.estimate = problem.target_deviations;
  take(stated.restitution, sizes.restitution);
  if (problem.impulse.contact != ContactLaw::Frictionless) sizes.restitution = 0;
  take(stated.target_mass, sizes.target_mass);
  take(stated.target_inertia, sizes.target_inertia);
  take(stated.contact_point, sizes.contact_point);
  take(problem.post_impact.sensor.base_rate_error, sizes.base_rate_error);
  take(problem.post_impact.sensor.joint_rate_error, sizes.joint_rate_error);
  if (is_predicted) take(stated.contact_time, sizes.contact_time);
  return sizes;
}

std::string trial_failure(const TrialOutcome& outcome, const PostImpactSpec& spec) {
  const double whole = verification::kTrial.just_kept;
  if (!outcome.hit) return "no contact";
  if (spec.controllers.empty()) return "";
  if (!outcome.finished) return "simulation";
  if (outcome.stop_hits > 0) return "joint stops";
  const auto exceeds = [](double value, double most) { return !(value <= most); };  // NaN does
  if (exceeds(outcome.residual_base_rate, spec.residual_base_rate_max)) return "base rate";
  if (exceeds(outcome.attitude_turned, spec.attitude_change_max)) return "attitude change";
  if (exceeds(outcome.peak_rate_part, whole)) return "joint rates";
  if (exceeds(outcome.peak_torque_part, whole)) return "joint torques";
  if (exceeds(outcome.peak_grip_part, whole)) return "load of the grip";
  if (exceeds(outcome.peak_wheel_part, whole)) return "full wheels";
  const auto controller = chosen_controller(spec);
  const bool must_rest = controller && controller->kind == ControllerKind::Detumble;
  return must_rest && !outcome.rests ? "no rest within the horizon" : "";
}

std::vector<std::string> trial_input_names() {
  return {"direction_angle", "closing_speed",     "restitution",       "target_mass",
          "target_inertia",  "contact_point",     "contact_time",      "robot_mass",
          "joint_position",  "estimate_position", "estimate_attitude", "estimate_velocity",
          "estimate_rate",   "velocity_error",    "rate_error"};
}

std::vector<TrialOutcome> run_trials(const Plan& plan, const Perturbations& sizes,
                                     std::uint64_t seed, int first, int count, int workers,
                                     const StopCondition& stop,
                                     const std::function<void(int, int)>& on_progress) {
  const double earliest = plan.configuration.contact_time - 2 * sizes.contact_time - 1;
  const verification::Situation nominal(plan.problem, plan.configuration, earliest);
  if (!nominal.event.missing.empty()) throw std::invalid_argument(nominal.event.missing);

  const int together = size_of_group(count, workers);
  const int groups = (count + together - 1) / together;
  std::vector<std::vector<TrialOutcome>> found(static_cast<std::size_t>(groups));
  const auto work = [&](int i) {
    const int before = i * together;
    const int size = std::min(together, count - before);
    auto outcomes = verification::run_together(nominal, sizes, seed, first + before, size, stop);
    if (!stop.reached()) found[static_cast<std::size_t>(i)] = std::move(outcomes);
  };
  const auto take = [&](int i) {
    if (on_progress) on_progress(std::min(count, (i + 1) * together), count);
  };
  for_each_index(workers, groups, stop, work, take);
  // Nothing is known of those that were stopped. What follows them is left out, too: the place of
  // an outcome is the number of its trial.
  std::vector<TrialOutcome> outcomes;
  for (auto& group : found) {
    if (group.empty()) break;
    std::move(group.begin(), group.end(), std::back_inserter(outcomes));
  }
  return outcomes;
}

}  // namespace stillbase
