#include "verification/example_plans.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/core/rotation.hpp>
#include <stillbase/reference/reference.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include <Eigen/LU>

namespace stillbase::verification_test {

namespace {

constexpr double kDegree = kPi / 180;

Eigen::MatrixXd solve(const Eigen::MatrixXd& A, const Eigen::MatrixXd& b) {
  return PivotedQr(A).solve_columns(b);
}

reference::Dynamics planner_dynamics(const RobotModel& robot, const Eigen::VectorXd& phi,
                                     Flip flip) {
  reference::Dynamics d = reference::compute(robot, {phi, {}, {}});
  const auto n = phi.size();
  auto flip_block = [&](Eigen::Index row, Eigen::Index col, Eigen::Index rows, Eigen::Index cols) {
    d.H.block(row, col, rows, cols) *= -1;
    d.H.block(col, row, cols, rows) *= -1;
  };
  switch (flip) {
    case Flip::LinearCoupling:
      flip_block(0, 6, 3, n);
      break;
    case Flip::AngularCoupling:
      flip_block(3, 6, 3, n);
      d.Htilde_omegaphi *= -1;
      break;
    case Flip::LinearAngular:
      flip_block(0, 3, 3, 3);
      break;
    case Flip::HandLever:
      d.J.block<3, 3>(0, 3) *= -1;
      break;
    case Flip::HandJacobian:
      d.J.col(6) *= -1;
      break;
    case Flip::SystemCentroid:
      d.centroid *= -1;
      break;
    default:
      break;
  }
  return d;
}

/// The planner's numbers of the impact along n (in B).
struct PlannedImpact {
  ImpactSummary summary;
  ObjectiveValue objective;
};

struct PlannedContact {
  Vector3d n, velocity;  ///< in B
  double target_inverse_mass = 0;
  Vector3d r;  ///< contact point from the target's centroid, B
  Matrix3d inertia = Matrix3d::Zero();
  double target_mass = 0;
};

PlannedImpact plan_impact(const CaptureProblem& problem, const Eigen::VectorXd& phi,
                          const PlannedContact& contact, Flip flip) {
  const reference::Dynamics d = planner_dynamics(problem.robot, phi, flip);
  const auto n = phi.size();
  Eigen::MatrixXd H = d.H;
  if (problem.resistance.model == ResistanceModel::RotorInertia) {
    H.diagonal().tail(n) += problem.resistance.rotor_inertia;
  }
  const Eigen::MatrixXd J3 = d.J.topRows(3);
  const Eigen::MatrixXd response = solve(H, J3.transpose());
  const Matrix3d W = J3 * response;
  const bool rigid = problem.impulse.source == ImpulseSource::RigidBody;
  auto closing = [&](const Vector3d& dir) {
    const double v = rigid ? dir.dot(contact.velocity) : problem.impulse.closing_speed;
    return flip == Flip::ClosingSpeed ? -v : v;
  };
  auto impulse = [&](const Vector3d& dir) -> Vector3d {
    double inverse = dir.dot(W * dir) + 1 / contact.target_mass;
    if (rigid) {
      const Vector3d arm = contact.r.cross(dir);
      inverse += arm.dot(contact.inertia.inverse() * arm);
    }
    // A planner with the wrong sign here takes the magnitude.
    return (1 + problem.impulse.restitution) * std::abs(closing(dir)) / inverse * dir;
  };
  auto objective = [&](const Vector3d& dir) {
    const Eigen::VectorXd x = response * impulse(dir);
    return Vector3d(d.Htilde_omega * x.segment<3>(3)).norm();
  };

  PlannedImpact planned;
  ImpactSummary& s = planned.summary;
  const Vector3d f = impulse(contact.n);
  const Eigen::VectorXd x = response * f;
  s.Fbar << f, Vector3d::Zero();
  s.Delta_Omega = x.head<6>();
  s.Delta_phidot = x.tail(n);
  const Svd svd = right_svd(d.Htilde_omegaphi);
  s.rank_tolerance = 1e-10;
  s.rank = numerical_rank(svd.sigma, s.rank_tolerance);
  const Eigen::MatrixXd V = svd.V.leftCols(s.rank);
  s.Delta_phidot_orthogonal = V * (V.transpose() * s.Delta_phidot);
  s.Delta_phidot_rns = s.Delta_phidot - s.Delta_phidot_orthogonal;
  const Vector3d r_gh = d.hand_position - d.centroid;
  s.total = r_gh.cross(f);
  s.base = d.Htilde_omega * s.Delta_Omega.tail<3>();
  s.coupling = d.Htilde_omegaphi * s.Delta_phidot;
  const double scale = f.norm() * r_gh.norm();
  s.judgement = judge_case(s.total, s.base, s.coupling, scale);
  s.closing_speed = closing(contact.n);
  s.resistance = problem.resistance;

  ObjectiveValue& o = planned.objective;
  o.name = "base_angular_momentum";
  o.unit = "N m s";
  o.nominal = o.worst_case = objective(contact.n);
  o.worst_direction = contact.n;
  const Vector3d e1 = contact.n.unitOrthogonal(), e2 = contact.n.cross(e1);
  const double cone = problem.uncertainty.cone_half_angle;
  const int rings = cone > 0 ? 50 : 0, azimuths = 300;
  double worst_theta = 0, worst_psi = 0;
  for (int i = 1; i <= rings; ++i) {
    const double theta = cone * i / rings;
    for (int j = 0; j < azimuths; ++j) {
      const double psi = j * 360 * kDegree / azimuths;
      const Vector3d dir =
          std::cos(theta) * contact.n + std::sin(theta) * (std::cos(psi) * e1 + std::sin(psi) * e2);
      const double value = objective(dir);
      if (value > o.worst_case) {
        o.worst_case = value;
        o.worst_direction = dir;
        worst_theta = theta;
        worst_psi = psi;
      }
    }
  }
  // From the best of the grid on with ever smaller steps.
  for (double step = rings > 0 ? 1e-3 : 0; step > 1e-8; step /= 2) {
    bool better = true;
    while (better) {
      better = false;
      for (const auto& [d_theta, d_psi] :
           {std::pair{step, 0.0}, {-step, 0.0}, {0.0, step}, {0.0, -step}}) {
        const double theta = std::min(worst_theta + d_theta, cone), psi = worst_psi + d_psi;
        const Vector3d dir = std::cos(theta) * contact.n +
                             std::sin(theta) * (std::cos(psi) * e1 + std::sin(psi) * e2);
        const double value = objective(dir);
        if (!(value > o.worst_case)) continue;
        o.worst_case = value;
        o.worst_direction = dir;
        worst_theta = theta;
        worst_psi = psi;
        better = true;
      }
    }
  }
  o.value = o.nominal;
  o.terms = {{o.name, o.nominal}};
  return planned;
}

RobotModel read_robot(const std::string& name, const std::string& hand = "") {
  const std::string path = std::string(STILLBASE_SOURCE_DIR) + "/problems/robots/" + name;
  return read_urdf(read_text_file(path, 1 << 20), path, hand);
}

/// Joint torques at the samples, with the base's acceleration by differences along the segments
/// instead of by its equation of motion.
void state_torques(const CaptureProblem& problem, Approach& a) {
  const auto n = problem.robot.n();
  const bool held = problem.approach.base == BaseMode::Held;
  auto Omega = [&](const Eigen::VectorXd& phi, const Eigen::VectorXd& phidot) -> Vector6d {
    if (held) return Vector6d::Zero();
    const auto d = reference::compute(problem.robot, {phi, {}, {}});
    return -solve(d.H.topLeftCorner(6, 6), d.H.topRightCorner(6, n) * phidot);
  };
  auto torques = [&](const JointVectord& phi, const JointVectord& phidot,
                     const JointVectord& phiddot) -> JointVectord {
    // Richardson's extrapolation of central differences.
    auto slope = [&](double h) -> Vector6d {
      return (Omega(phi + h * phidot + h * h / 2 * phiddot, phidot + h * phiddot) -
              Omega(phi - h * phidot + h * h / 2 * phiddot, phidot - h * phiddot)) /
             (2 * h);
    };
    Eigen::VectorXd acceleration(6 + n);
    acceleration << (4 * slope(1e-3) - slope(2e-3)) / 3, phiddot;
    const auto d = reference::compute(problem.robot, {phi, phidot, Omega(phi, phidot)});
    JointVectord tau = (d.H * acceleration + d.c).tail(n);
    if (problem.resistance.model == ResistanceModel::RotorInertia) {
      tau += problem.resistance.rotor_inertia.cwiseProduct(phiddot);
    }
    return tau;
  };
  for (std::size_t i = 0; i + 1 < a.times.size(); ++i) {
    const double h = a.times[i + 1] - a.times[i];
    const JointVectord &q0 = a.joint_positions[i], &v0 = a.joint_velocities[i];
    const JointVectord& a0 = a.joint_accelerations[i];
    const JointVectord jerk = (a.joint_velocities[i + 1] - v0 - h * a0) * 2 / (h * h);
    a.joint_torques.push_back(torques(q0, v0, a0));
    for (int look = 0; look <= 8; ++look) {
      const double s = h * look / 8;
      const JointVectord tau = torques(q0 + s * (v0 + s / 2 * (a0 + s / 3 * jerk)),
                                       v0 + s * (a0 + s / 2 * jerk), a0 + s * jerk);
      for (int k = 0; k < n; ++k) {
        a.effort_used =
            std::max(a.effort_used, std::abs(tau[k]) / problem.robot.joints[k].max_effort);
      }
    }
  }
  a.joint_torques.push_back(JointVectord::Zero(n));
}

/// A straight joint path with a time law of degree five, at rest at both ends, and the wait.
void plan_approach_motion(Plan& plan, Flip flip) {
  const CaptureProblem& problem = plan.problem;
  Approach& a = plan.approach;
  const int samples = 80;
  const double duration = 20, end = plan.configuration.contact_time - problem.approach.wait;
  const JointVectord from = problem.start, step = plan.configuration.phi - problem.start;
  a.status = ApproachStatus::Found;
  for (int i = 0; i <= samples; ++i) {
    const double u = static_cast<double>(i) / samples;
    const double s = u * u * u * (10 + u * (-15 + 6 * u));
    const double s_rate = 30 * u * u * (1 - u) * (1 - u) / duration;
    a.times.push_back(end - duration * (1 - u));
    a.joint_positions.push_back(from + s * step);
    a.joint_velocities.push_back(s_rate * step);
  }
  a.joint_positions.back() = plan.configuration.phi;

  for (int i = 0; i <= samples; ++i) {
    JointVectord acceleration = JointVectord::Zero(step.size());
    if (i < samples) {
      const auto now = static_cast<std::size_t>(i), next = now + 1;
      const double h = a.times[next] - a.times[now];
      acceleration = 6 / (h * h) * (a.joint_positions[next] - a.joint_positions[now]) -
                     (4 * a.joint_velocities[now] + 2 * a.joint_velocities[next]) / h;
    }
    a.joint_accelerations.push_back(acceleration);
  }

  auto Omega = [&](const JointVectord& phi, const JointVectord& phidot) -> Vector6d {
    if (problem.approach.base == BaseMode::Held) return Vector6d::Zero();
    const auto d = planner_dynamics(problem.robot, phi, flip);
    const double sign = flip == Flip::BaseDrift ? 1 : -1;
    return sign * solve(d.H.topLeftCorner(6, 6), d.H.topRightCorner(6, phi.size()) * phidot);
  };
  // Displacement over a segment: a product of many short constant twists, taken at their middles
  // and extrapolated over the number of them.
  auto displacement = [&](std::size_t i, int steps) {
    const double h = a.times[i + 1] - a.times[i];
    const JointVectord &x0 = a.joint_positions[i], &x1 = a.joint_positions[i + 1];
    const JointVectord &v0 = a.joint_velocities[i], &v1 = a.joint_velocities[i + 1];
    Pose pose;
    for (int j = 0; j < steps; ++j) {
      const double u = (j + 0.5) / steps;
      const JointVectord x = (2 * u * u * u - 3 * u * u + 1) * x0 +
                             (u * u * u - 2 * u * u + u) * h * v0 +
                             (3 * u * u - 2 * u * u * u) * x1 + (u * u * u - u * u) * h * v1;
      const JointVectord v = ((6 * u * u - 6 * u) * (x0 - x1)) / h + (3 * u * u - 4 * u + 1) * v0 +
                             (3 * u * u - 2 * u) * v1;
      const Vector6d xi = h / steps * Omega(x, v);
      const Vector3d turn = xi.tail<3>();
      const Vector3d shift = rotation_right_jacobian(-turn) * xi.head<3>();
      pose = pose * Pose{shift, rotation_exp(turn)};
    }
    return pose;
  };
  std::vector<Pose> poses{plan.configuration.base};
  for (std::size_t i = a.times.size() - 1; i-- > 0;) {
    const Pose coarse = displacement(i, 8), fine = displacement(i, 16);
    // Midpoint rule: the error of the finer one is a third of the difference.
    const Pose difference = coarse.inverse() * fine;
    const Pose better = fine * Pose{difference.position / 3,
                                    rotation_exp(rotation_log(difference.orientation) / 3)};
    poses.push_back(poses.back() * better.inverse());
  }
  a.base_poses.assign(poses.rbegin(), poses.rend());
  for (std::size_t i = 0; i < a.times.size(); ++i) {
    a.base_velocities.push_back(Omega(a.joint_positions[i], a.joint_velocities[i]));
    a.attitude_excursion =
        std::max(a.attitude_excursion, 2 * std::asin((a.base_poses[i].orientation.conjugate() *
                                                      plan.configuration.base.orientation)
                                                         .vec()
                                                         .norm()));
  }
  a.duration = duration;
  a.path_length = chord_length(a);
  state_torques(problem, a);
  a.times.push_back(plan.configuration.contact_time);
  a.joint_positions.push_back(plan.configuration.phi);
  a.joint_velocities.push_back(JointVectord::Zero(plan.configuration.phi.size()));
  a.joint_accelerations.push_back(JointVectord::Zero(plan.configuration.phi.size()));
  a.joint_torques.push_back(JointVectord::Zero(plan.configuration.phi.size()));
  a.base_poses.push_back(plan.configuration.base);
  a.base_velocities.push_back(Vector6d::Zero());
}

/// The constraints of the two problems below; all equations are satisfied.
void state_constraints(Plan& plan, const Vector3d& n) {
  const CaptureProblem& problem = plan.problem;
  const auto add = [&](const std::string& name, double value, double lower, double upper) {
    plan.constraints.push_back({name, value, lower, upper, 0});
  };
  const auto hand = reference::compute(problem.robot, {plan.configuration.phi, {}, {}});
  add("closing_speed", plan.impact.closing_speed, problem.constraints.closing_speed_min, kInfinity);
  for (int k = 0; k < problem.robot.n(); ++k) {
    const Joint& joint = problem.robot.joints[k];
    if (joint.type == JointType::Continuous) continue;
    add("joint_limit_" + joint.name, plan.configuration.phi[k], joint.lower, joint.upper);
  }
  if (problem.hand.constraint == HandConstraint::Axis) {
    add("hand_axis_1", 0, 0, 0);
    add("hand_axis_2", 0, 0, 0);
    add("hand_facing", n.dot(hand.hand_rotation.col(2)), -kInfinity, 0);
  } else {
    add("case_total_1", 0, 0, 0);
    add("case_coupling_1", 0, 0, 0);
  }
}

/// Everything about the impact and the objective, from configuration and contact.
void state_impact(Plan& plan, const PlannedContact& contact, Flip flip) {
  const PlannedImpact planned = plan_impact(plan.problem, plan.configuration.phi, contact, flip);
  plan.impact = planned.summary;
  plan.objective = planned.objective;
  plan.candidates = {{plan.configuration, planned.objective.nominal, planned.objective.worst_case,
                      0, 1, true, "", planned.objective.value}};
  plan.nominal_optimum = {plan.configuration, planned.objective.nominal,
                          planned.objective.worst_case, planned.objective.value};
  plan.problem.search.starts = 1;
  plan.certificate.starts = 1;
  plan.certificate.distinct_solutions = 1;
  plan.optimizer = plan.problem.search.optimizer;
  plan.solver_calls = {{plan.optimizer, 1}};
  plan.certificate.proof.statement =
      "no proof: nothing was proven, the program has no prover (stillbase::proof)";
  state_constraints(plan, contact.n);
  plan.status = PlanStatus::Optimal;
}

/// Nothing depends on the angle of the last joint.
void state_roll(Plan& plan) {
  const Eigen::Index last = plan.configuration.phi.size() - 1;
  const Joint& joint = plan.problem.robot.joints[static_cast<std::size_t>(last)];
  SolutionFamily roll;
  roll.points.assign(2, plan.configuration);
  roll.points.front().phi[last] = joint.lower;
  roll.points.back().phi[last] = joint.upper;
  roll.length = joint.upper - joint.lower;
  roll.is_complete = true;
  roll.starts = 1;
  plan.families = {roll};
  plan.candidates.front().family = 0;
}

}  // namespace

double chord_length(const Approach& a) {
  double length = 0;
  for (std::size_t i = 0; i + 1 < a.times.size(); ++i) {
    const double h = a.times[i + 1] - a.times[i];
    JointVectord last = a.joint_positions[i];
    for (int j = 1; j <= 8; ++j) {
      const double u = j / 8.0, w = 1 - u;
      const JointVectord next =
          w * w * (1 + 2 * u) * a.joint_positions[i] +
          u * u * (3 - 2 * u) * a.joint_positions[i + 1] +
          u * w * h * (w * a.joint_velocities[i] - u * a.joint_velocities[i + 1]);
      length += (next - last).norm();
      last = next;
    }
  }
  return length;
}

Plan arm_plan(Flip flip, BaseMode base_mode) {
  Plan plan;
  CaptureProblem& problem = plan.problem;
  problem.robot = read_robot("iiwa_on_cube.urdf");
  problem.resistance.model = ResistanceModel::RotorInertia;
  problem.resistance.rotor_inertia = JointVectord::Constant(7, 0.5);
  problem.start.resize(7);
  problem.start << 0.7, 0.2, -0.1, -0.9, 0.0, 0.7, 0.4;
  plan.configuration.phi.resize(7);
  plan.configuration.phi << 0.3, 0.7, 0.2, -0.5, 0.3, 0.4, 0.1;
  plan.configuration.base = {{0.4, -0.2, 0.1}, rotation_exp({0.2, -0.1, 0.3})};
  plan.configuration.contact_time = 60;
  problem.base = plan.configuration.base;
  problem.variables.joints.assign(7, true);
  problem.variables.base_position = PositionFreedom::Free;
  problem.variables.contact_time_lower = problem.variables.contact_time_upper = 60;
  problem.variables.feature = "plus_x";
  problem.allowed_contacts = {{"link_6", "link_7"}};  // their shapes overlap in every posture

  TargetBody client;
  client.name = "client_50";
  client.mass = 50;
  client.inertia = 3 * Matrix3d::Identity();
  client.shapes = {{Pose{}, Box{Vector3d::Constant(0.6)}}};
  client.features = {{"plus_x", {0.3, 0.12, 0.06}, Vector3d::UnitX()}};
  problem.target = client;

  // The target at the contact, then back to time zero: a sphere's inertia turns at a constant rate.
  const auto hand = reference::compute(problem.robot, {plan.configuration.phi, {}, {}});
  const Pose& base = plan.configuration.base;
  const Vector3d axis_N = base.orientation * hand.hand_rotation.col(2);
  const Vector3d hand_N = base * Vector3d(hand.hand_position);
  // The shortest rotation from the feature's normal to the hand, then 0.4 rad about the axis.
  const Vector3d x = Vector3d::UnitX(), turn_axis = x.cross(-axis_N);
  const double angle = std::atan2(turn_axis.norm(), x.dot(-axis_N));
  const Eigen::Quaterniond R_NT =
      rotation_exp(0.4 * axis_N) * rotation_exp(angle * turn_axis.normalized());
  const Vector3d normal = R_NT * Vector3d::UnitX();
  const Vector3d r = R_NT * client.features[0].point;
  const Vector3d omega = 2 * kDegree * Vector3d(1, 2, 2) / 3;
  const Vector3d v = 0.05 * normal + Vector3d(0.002, -0.001, 0.003);
  problem.target_state = {0, {hand_N - r - 60 * v, rotation_exp(-60 * omega) * R_NT}, v, omega};
  problem.impulse.source = ImpulseSource::RigidBody;
  problem.impulse.restitution = 0.3;
  problem.hand.constraint = HandConstraint::Axis;
  problem.uncertainty.cone_half_angle = 10 * kDegree;
  problem.approach.acceleration_limit = JointVectord::Constant(7, 0.5);
  problem.approach.base = base_mode;
  problem.approach.velocity_scale = 0.5;
  problem.post_impact.controllers = {"rns_damped", "joint_damping"};
  problem.post_impact.horizon = 4;
  problem.post_impact.residual_base_rate_max = 0.01;
  problem.post_impact.attitude_change_max = 0.2;

  PlannedContact contact;
  const Matrix3d R_BN = base.orientation.conjugate().toRotationMatrix();
  contact.n = R_BN * normal;
  contact.r = R_BN * r;
  contact.velocity = R_BN * (v + omega.cross(r));
  contact.inertia = client.inertia;
  contact.target_mass = client.mass;
  state_impact(plan, contact, flip);
  state_roll(plan);
  // Nobody has minimised anything: the residual of the first order is large.
  plan.status = PlanStatus::Feasible;
  plan.certificate.kkt_residual = 0.421204;
  plan.certificate.reduced_hessian_min_eigenvalue = -5.4185;
  plan_approach_motion(plan, flip);
  return plan;
}

Plan straight_plan() {
  Plan plan;
  CaptureProblem& problem = plan.problem;
  problem.robot = read_robot("planar_two_link_a.urdf");
  problem.start = JointVectord::Zero(2);
  problem.variables.joints.assign(2, true);
  TargetBody ball;
  ball.name = "point_mass";
  ball.mass = 100;
  ball.is_point_mass = true;
  ball.shapes = {{Pose{}, Sphere{0.1}}};
  problem.target = ball;
  problem.impulse.source = ImpulseSource::PointMass;
  problem.impulse.direction = -Vector3d::UnitX();
  problem.impulse.closing_speed = 1;
  problem.impulse.restitution = 1;
  problem.constraints.impact_case = CaseConstraint::C2;
  problem.approach.enabled = false;
  plan.configuration.phi = JointVectord::Zero(2);
  PlannedContact contact;
  contact.n = -Vector3d::UnitX();
  contact.target_mass = 100;
  state_impact(plan, contact, Flip::None);
  return plan;
}

}  // namespace stillbase::verification_test
