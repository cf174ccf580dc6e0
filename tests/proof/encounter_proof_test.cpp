// Proofs over base attitude, contact time and hand constraints, against every solution that Newton
// steps of the planner's own formulation find from many starts.
#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

#include <Eigen/QR>

#include <stillbase/core/random.hpp>
#include <stillbase/core/rotation.hpp>
#include <stillbase/dynamics/kinematics.hpp>
#include <stillbase/formulation/formulation.hpp>
#include <stillbase/proof/proof.hpp>

#include "support/random_robot.hpp"
#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

/// A flat client that comes from the right and turns about z; its feature looks towards -x at
/// first.
void add_turning_client(CaptureProblem& problem, const Vector3d& position, double rate) {
  TargetBody body;
  body.name = "client";
  body.mass = 50;
  body.inertia = Vector3d(3, 4, 5).asDiagonal();
  body.features.push_back({"face", {0.3, 0.12, 0}, Vector3d::UnitX()});
  problem.target = body;
  problem.target_state = {};
  problem.target_state.pose = {position, rotation_exp(M_PI * Vector3d::UnitZ())};
  problem.target_state.linear_velocity = {-0.05, 0, 0};
  problem.target_state.angular_velocity = {0, 0, rate};
  problem.variables.feature = "face";
  problem.impulse.direction.reset();
  problem.impulse.source = ImpulseSource::RigidBody;
  problem.impulse.restitution = 0.2;
  problem.hand.position.reset();
}

Proof proof_of(const CaptureProblem& problem, long max_boxes = 50000) {
  const Formulation formulation(problem);
  return prove(problem, {.max_boxes = max_boxes});
}

/// The equations (and the objective's vector, when it is to vanish) with their Jacobian.
struct Rows {
  Eigen::VectorXd values;
  Eigen::MatrixXd jacobian;
  bool inequalities_hold = true;
};

Rows rows_at(const Formulation& formulation, const Eigen::VectorXd& x, bool zero) {
  nlp::Evaluation at;
  formulation.evaluate(x, at);
  const Eigen::VectorXd lower = formulation.constraint_lower();
  const Eigen::VectorXd upper = formulation.constraint_upper();
  Rows out;
  const Eigen::Index n = x.size();
  const auto append = [&](double value, const Eigen::RowVectorXd& slope) {
    out.values.conservativeResize(out.values.size() + 1);
    out.values[out.values.size() - 1] = value;
    out.jacobian.conservativeResize(out.values.size(), n);
    out.jacobian.row(out.values.size() - 1) = slope;
  };
  for (Eigen::Index i = 0; i < lower.size(); ++i) {
    if (lower[i] == upper[i]) {
      append(at.constraints[i] - lower[i], at.jacobian.row(i));
    } else if (at.constraints[i] < lower[i] || at.constraints[i] > upper[i]) {
      out.inequalities_hold = false;
    }
  }
  if (!zero) return out;
  Eigen::VectorXd y;
  Eigen::MatrixXd J;
  formulation.objective_vector(x, y, J);
  for (Eigen::Index i = 0; i < y.size(); ++i) append(y[i], J.row(i));
  return out;
}

/// Every isolated solution that Newton steps find from `starts` evenly spread points.
std::vector<Eigen::VectorXd> solutions_by_newton(const CaptureProblem& problem, bool zero,
                                                 int starts) {
  const Formulation formulation(problem);
  Eigen::VectorXd lower = formulation.lower(), upper = formulation.upper();
  std::vector<Eigen::VectorXd> found;
  for (int s = 0; s < starts; ++s) {
    Eigen::VectorXd x =
        formulation.start_point(low_discrepancy_point(s, formulation.num_variables(), 0));
    Rows at = rows_at(formulation, x, zero);
    for (int i = 0; i < 60 && at.values.norm() > 1e-13; ++i) {
      Eigen::VectorXd step = -at.jacobian.completeOrthogonalDecomposition().solve(at.values);
      // Times are of other size than angles: at most a tenth of a bounded range at once.
      for (Eigen::Index k = 0; k < step.size(); ++k) {
        const double range = upper[k] - lower[k];
        const double most = std::isfinite(range) ? 0.1 * range : 0.5;
        if (std::abs(step[k]) > most) step *= most / std::abs(step[k]);
      }
      x = (x + step).cwiseMax(lower).cwiseMin(upper);
      at = rows_at(formulation, x, zero);
    }
    const auto rank = at.jacobian.colPivHouseholderQr().rank();
    if (at.values.norm() > 1e-10 || rank < x.size() || !at.inequalities_hold) continue;
    x = formulation.normalised(x);
    const bool known = std::any_of(found.begin(), found.end(), [&](const Eigen::VectorXd& other) {
      return formulation.distance(x, other) < 1e-5;
    });
    if (!known) found.push_back(x);
  }
  return found;
}

bool holds(const CaptureProblem& problem, const JointBox& box, const Eigen::VectorXd& x) {
  constexpr double kNear = 1e-7;
  const auto inside = [&](double value, double lower, double upper, bool wraps) {
    double apart = value - (lower + upper) / 2;
    if (wraps) apart = wrap_angle(apart);
    return std::abs(apart) <= (upper - lower) / 2 + kNear;
  };
  Eigen::Index i = 0;
  bool all = true;
  for (int k = 0; k < problem.robot.n(); ++k) {
    if (!problem.variables.joints[static_cast<std::size_t>(k)]) continue;
    const bool wraps =
        problem.robot.joints[static_cast<std::size_t>(k)].type == JointType::Continuous;
    all = all && inside(x[i++], box.lower[k], box.upper[k], wraps);
  }
  if (box.base_angle)
    all = all && inside(x[i++], box.base_angle->lower, box.base_angle->upper, true);
  if (box.contact_time) {
    all = all && inside(x[i++], box.contact_time->lower, box.contact_time->upper, false);
  }
  return all && i == x.size();
}

/// Complete, and the enclosed solutions are those that Newton steps find.
Proof check_against_newton(const CaptureProblem& problem, bool zero, int starts = 600) {
  const Proof proof = proof_of(problem);
  const auto found = solutions_by_newton(problem, zero, starts);
  CAPTURE(proof.statement, proof.boxes, found.size());
  CHECK(proof.status == ProofStatus::Complete);
  CHECK(proof.solutions.size() == found.size());
  for (const Eigen::VectorXd& x : found) {
    CAPTURE(x.transpose());
    const auto has = [&](const JointBox& box) { return holds(problem, box, x); };
    CHECK(std::count_if(proof.solutions.begin(), proof.solutions.end(), has) == 1);
  }
  for (const JointBox& box : proof.solutions) {
    CHECK((box.upper - box.lower).maxCoeff() < 1e-6);
    CHECK(box.base_angle.has_value() == (problem.variables.base_attitude == AttitudeFreedom::Axis));
    CHECK(box.contact_time.has_value() ==
          (problem.variables.contact_time_upper > problem.variables.contact_time_lower));
  }
  return proof;
}

/// Three turning joints in no special arrangement.
CaptureProblem robot_in_space(std::uint64_t seed) {
  Random random(seed);
  CaptureProblem problem = test::shipped("planar_three_link_null");
  problem.robot = random_robot(random, 3, false);
  for (Joint& joint : problem.robot.joints) {
    joint.type = JointType::Continuous;
    joint.lower = -kInfinity;
    joint.upper = kInfinity;
  }
  problem.start = JointVectord::Zero(3);
  return problem;
}

CaptureProblem turning_base(const char* name) {
  CaptureProblem problem = test::shipped(name);
  problem.variables.base_attitude = AttitudeFreedom::Axis;
  problem.variables.base_attitude_axis = Vector3d::UnitZ();
  problem.variables.base_attitude_max = M_PI;
  problem.impulse.direction_frame = Frame::Inertial;
  return problem;
}

}  // namespace

TEST_CASE("one joint and the base attitude: every C2 configuration for an impulse given in N") {
  CaptureProblem problem = turning_base("planar_two_link_c2_a");
  problem.variables.joints = {false, true};
  problem.base.orientation = rotation_exp({0, 0, 0.3});
  for (const double most : {M_PI, 1.0}) {
    problem.variables.base_attitude_max = most;
    const Proof proof = check_against_newton(problem, false);
    CHECK_FALSE(proof.solutions.empty());
  }
}

TEST_CASE("two joints and the base attitude: the hand at a point of N in case C") {
  CaptureProblem problem = turning_base("planar_two_link_c2_a");
  problem.constraints.impact_case = CaseConstraint::C;
  problem.hand.constraint = HandConstraint::Position;
  problem.hand.position = Vector3d(2.4, 1.4, 0);
  problem.hand.frame = Frame::Inertial;
  const Proof proof = check_against_newton(problem, false);
  CHECK_FALSE(proof.solutions.empty());
}

TEST_CASE("two joints and the base attitude: the hand at a turning client, base kept still") {
  CaptureProblem problem = turning_base("planar_three_link_null");
  add_turning_client(problem, {5.5, 0.42, 0}, 5 * M_PI / 180);
  problem.variables.joints = {false, true, true};
  problem.variables.contact_time_lower = problem.variables.contact_time_upper = 71;
  problem.hand.constraint = HandConstraint::Position;
  problem.target_state.linear_velocity = {-0.045, 0, 0};
  problem.constraints.closing_speed_min = 1e-3;
  const Proof proof = check_against_newton(problem, true);
  CHECK_FALSE(proof.solutions.empty());
}

TEST_CASE("a free contact time: two joints reach a rotating client in case C") {
  CaptureProblem problem = test::shipped("planar_two_link_c2_a");
  problem.constraints.impact_case = CaseConstraint::C;
  add_turning_client(problem, {5.9, 0.42, 0}, 5 * M_PI / 180);
  problem.hand.constraint = HandConstraint::Position;
  problem.variables.contact_time_lower = 40;
  problem.variables.contact_time_upper = 80;
  const Proof proof = check_against_newton(problem, false, 1500);
  CHECK_FALSE(proof.solutions.empty());
}

TEST_CASE("a free contact time and station: the attitude of the client decides the impulse alone") {
  CaptureProblem problem = test::shipped("planar_two_link_c2_a");
  add_turning_client(problem, {5.9, 0.42, 0}, 5 * M_PI / 180);
  problem.variables.base_position = PositionFreedom::Free;
  problem.variables.joints = {false, true};
  problem.variables.contact_time_lower = 20;
  problem.variables.contact_time_upper = 80;
  problem.constraints.closing_speed_min = 0.01;
  const Proof proof = check_against_newton(problem, false);
  CHECK_FALSE(proof.solutions.empty());
  SECTION("a bounded station leaves some of them out") {
    problem.variables.base_position = PositionFreedom::Box;
    problem.variables.base_position_lower = {0, -10, -1};
    problem.variables.base_position_upper = {20, 0, 1};
    CHECK(check_against_newton(problem, false).solutions.size() < proof.solutions.size());
  }
  SECTION("and so does a faster contact") {
    problem.constraints.closing_speed_min = 0.045;
    CHECK(check_against_newton(problem, false).solutions.size() < proof.solutions.size());
  }
}

TEST_CASE("the hand against the normal of a turning client, and case C") {
  CaptureProblem problem = test::shipped("planar_two_link_c2_a");
  add_turning_client(problem, {5.9, 0.42, 0}, 5 * M_PI / 180);
  problem.constraints.impact_case = CaseConstraint::C;
  problem.hand.constraint = HandConstraint::Axis;
  problem.hand.approach_axis = Vector3d::UnitX();
  problem.variables.base_position = PositionFreedom::Free;
  SECTION("at a fixed time") {
    problem.variables.contact_time_lower = problem.variables.contact_time_upper = 66;
    const Proof proof = check_against_newton(problem, false);
    CHECK_FALSE(proof.solutions.empty());
  }
  SECTION("with the base held and three joints it must be at the client too") {
    CaptureProblem held = test::shipped("planar_three_link_null");
    add_turning_client(held, {5.9, 0.42, 0}, 5 * M_PI / 180);
    held.hand.constraint = HandConstraint::Axis;
    held.variables.contact_time_lower = held.variables.contact_time_upper = 73;
    const Proof proof = check_against_newton(held, false);
    CHECK_FALSE(proof.solutions.empty());
  }
}

TEST_CASE("the pose of a hand in the plane: position and both ways of the elbow") {
  CaptureProblem problem = test::shipped("planar_three_link_null");
  problem.hand.constraint = HandConstraint::Pose;
  problem.hand.orientation = rotation_exp({0, 0, 0.4});
  const Proof proof = check_against_newton(problem, false);
  CHECK(proof.solutions.size() == 2);
}

TEST_CASE("a robot in space reaches a client that tumbles about no principal axis") {
  CaptureProblem problem = robot_in_space(11);
  const JointVectord known = Vector3d(0.8, 1.1, -0.7);
  const double time = 20;
  problem.start = known;
  problem.hand.constraint = HandConstraint::Position;
  add_turning_client(problem, Vector3d::Zero(), 0);
  problem.impulse.source = ImpulseSource::Given;
  problem.variables.contact_time_lower = problem.variables.contact_time_upper = time;
  problem.constraints.closing_speed_min = -10;  // whatever it is
  TargetState& state = problem.target_state;
  state.pose.orientation = rotation_exp({0.3, 0.2, -0.5});
  state.angular_velocity = {0.05, -0.1, 0.08};
  state.linear_velocity = {0.1, 0.02, -0.03};
  // Its feature is at the hand of a known posture at that time.
  const Vector3d hand = compute_kinematics<double>(problem.robot, known).r_bh;
  const TargetMotion motion(*problem.target, state, 100);
  state.pose.position = hand - motion.contact(problem.target->features[0], time).point;
  SECTION("three joints at a fixed time") {
    const Proof proof = check_against_newton(problem, false, 800);
    CHECK_FALSE(proof.solutions.empty());
  }
  SECTION("two joints and the time") {
    problem.variables.joints = {true, true, false};
    problem.variables.contact_time_lower = 0;
    problem.variables.contact_time_upper = 60;
    const Proof proof = check_against_newton(problem, false, 800);
    CHECK_FALSE(proof.solutions.empty());
    bool has_known = false;
    for (const JointBox& box : proof.solutions) {
      has_known = has_known || holds(problem, box, Vector3d(known[0], known[1], time));
    }
    CHECK(has_known);
  }
  SECTION("two joints and the base attitude about a slanting axis") {
    problem.variables.joints = {true, true, false};
    problem.variables.base_attitude = AttitudeFreedom::Axis;
    problem.variables.base_attitude_axis = Vector3d(1, 2, -1).normalized();
    problem.variables.base_attitude_max = 1.2;
    const Proof proof = check_against_newton(problem, false, 800);
    CHECK_FALSE(proof.solutions.empty());
  }
}

TEST_CASE("all three axes of a hand in space, the opposite attitude excluded") {
  CaptureProblem problem = robot_in_space(3);
  problem.variables.base_position = PositionFreedom::Free;
  problem.hand.constraint = HandConstraint::Pose;
  problem.hand.frame = Frame::Base;
  const JointVectord known = Vector3d(0.8, 1.1, -0.7);
  problem.hand.orientation = compute_kinematics<double>(problem.robot, known).R_hand;
  const Proof proof = check_against_newton(problem, false, 800);
  CHECK_FALSE(proof.solutions.empty());
}

TEST_CASE("seven joints that move, of which two or one and the base attitude are free: case C") {
  // The total momentum does not ask how the joints give way.
  CaptureProblem problem = test::shipped("iiwa_case_c");
  problem.constraints.clearance.reset();
  problem.hand.constraint = HandConstraint::None;
  problem.variables.base_attitude = AttitudeFreedom::Fixed;
  problem.variables.joints.assign(7, false);
  SECTION("two joints") {
    problem.variables.joints[0] = problem.variables.joints[1] = true;
    CHECK(check_against_newton(problem, false, 200).solutions.size() == 2);
  }
  SECTION("two others, in vain") {
    problem.variables.joints[1] = problem.variables.joints[3] = true;
    const Proof proof = check_against_newton(problem, false, 200);
    CHECK(proof.solutions.empty());
    CHECK(proof.statement == "proven: there is no solution within the joint limits");
  }
  SECTION("one joint and the base attitude") {
    problem.variables.joints[3] = true;
    problem.variables.base_attitude = AttitudeFreedom::Axis;
    problem.variables.base_attitude_axis = Vector3d(0, 1, 1).normalized();
    problem.variables.base_attitude_max = M_PI;
    CHECK(check_against_newton(problem, false, 200).solutions.size() == 2);
  }
}

TEST_CASE("seven joints that move, of which three are free: base part zero, coupling part zero") {
  CaptureProblem problem = test::shipped("iiwa_case_c");
  problem.constraints.clearance.reset();
  problem.hand.constraint = HandConstraint::None;
  problem.variables.base_attitude = AttitudeFreedom::Fixed;
  problem.variables.joints.assign(7, false);
  const auto set_free = [&](std::size_t joint, double lower, double upper) {
    problem.variables.joints[joint] = true;
    problem.robot.joints[joint].lower = lower;
    problem.robot.joints[joint].upper = upper;
  };
  problem.constraints.joint_limit_margin = 0;
  SECTION("coupling part") {
    problem.constraints.impact_case = CaseConstraint::G3;
    set_free(0, 1.2, 2.4);
    set_free(1, 0.9, 2.1);
    set_free(3, -2.1, -1.2);
    CHECK(check_against_newton(problem, false, 300).solutions.size() == 2);
  }
  SECTION("base part") {
    problem.constraints.impact_case = CaseConstraint::G2;
    set_free(0, -1, 0.6);
    set_free(1, 0.6, 2);
    set_free(3, 0.2, 1.8);
    CHECK(check_against_newton(problem, false, 300).solutions.size() == 1);
  }
}

TEST_CASE("what cannot be proven says why") {
  CaptureProblem problem = turning_base("planar_two_link_c2_a");
  const auto says = [&](const std::string& words) {
    const Proof proof = proof_of(problem);
    CAPTURE(proof.statement);
    CHECK(proof.status == ProofStatus::NotApplicable);
    CHECK(proof.statement.find(words) != std::string::npos);
  };
  says("2 equations for 3 free variables");
  SECTION("attitudes about more than one axis") {
    problem.variables.base_attitude = AttitudeFreedom::Free;
    says("one to three free variables, here are 5");
    problem.variables.joints = {false, false};
    says("more than one axis");
  }
  SECTION("an impulse fixed to the base does not feel its attitude") {
    problem.impulse.direction_frame = Frame::Base;
    problem.variables.joints = {false, true};
    says("no equation depends on the base attitude");
  }
  SECTION("four variables") {
    problem.variables.contact_time_upper = problem.variables.contact_time_lower + 1;
    says("one to three free variables, here are 4");
  }
  SECTION("clearances that are not judged") {
    problem.constraints.clearance = 0.1;
    CHECK(prove(problem).statement.find("are not judged") != std::string::npos);
  }
}

}  // namespace stillbase
