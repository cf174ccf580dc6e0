// Margins at the contact: closed-form distances, singular values, joint rates.
#include <catch2/catch.hpp>

#include <stillbase/core/error.hpp>
#include <stillbase/search/search.hpp>

#include "collision/closed_forms.hpp"
#include "collision/fcl_shape.hpp"
#include "formulation/constraints/clearance_kernel.hpp"
#include "formulation/formulation_parts.hpp"
#include "support/capture_problems.hpp"

namespace stillbase {
namespace {

ClearanceShape box(const Vector3d& size) {
  ClearanceShape shape;
  shape.is_box = true;
  shape.half = size / 2;
  return shape;
}

ClearanceShape capsule(double radius, double length) {
  ClearanceShape shape;
  shape.radius = radius;
  shape.half.z() = length / 2;
  return shape;
}

ClearanceShape cylinder(double radius, double length) {
  ClearanceShape shape = capsule(radius, length);
  shape.half.x() = shape.half.y() = radius;
  shape.is_cylinder = true;
  return shape;
}

PlacedShape<double> at(const ClearanceShape& shape, const Pose& pose) {
  return {&shape, pose.orientation.toRotationMatrix(), pose.position};
}

Pose random_pose(Random& random, double far) {
  return {far * random.unit_vector(), rotation_exp(2 * random.unit_vector())};
}

/// Least distance of sampled points of a capsule's axis from a box, by its definition.
double sampled(const Pose& round, double length, const Pose& box_pose, const Vector3d& size) {
  double least = kInfinity;
  for (int i = 0; i <= 20000; ++i) {
    const Vector3d p = round * Vector3d(0, 0, length * (i / 20000.0 - 0.5));
    const Vector3d q = (box_pose.inverse() * p).cwiseAbs() - size / 2;
    least = std::min(least, q.maxCoeff() > 0 ? Vector3d(q.cwiseMax(0)).norm() : q.maxCoeff());
  }
  return least;
}

}  // namespace

TEST_CASE("distances of spheres and capsules are those of the collision scene's closed form") {
  Random random(61);
  for (int trial = 0; trial < 500; ++trial) {
    const ClearanceShape a = capsule(0.1, trial % 3 == 0 ? 0 : 1), b = capsule(0.2, 0.7);
    const Pose pose_a = random_pose(random, 0.8), pose_b = random_pose(random, 0.4);
    const auto ends = [](const Pose& pose, double half, double radius) {
      return RoundSegment{pose * Vector3d(0, 0, -half), pose * Vector3d(0, 0, half), radius};
    };
    const double expected =
        round_distance(ends(pose_a, a.half.z(), a.radius), ends(pose_b, b.half.z(), b.radius));
    CHECK(separate<double>(at(a, pose_a), at(b, pose_b)).distance ==
          Approx(expected).epsilon(0).margin(1e-12));
  }
}

TEST_CASE("a capsule's distance from a box is the least over its axis, inside the box too") {
  Random random(62);
  int inside = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Vector3d size(0.8, 0.6, 0.4);
    const double length = trial % 4 == 0 ? 0.0 : 0.5;
    const ClearanceShape round = capsule(0.1, length), block = box(size);
    const Pose a = random_pose(random, random.uniform(0, 1)), b = random_pose(random, 0.1);
    const double found = separate<double>(at(round, a), at(block, b)).distance;
    const double expected = sampled(a, length, b, size) - 0.1;
    inside += expected < -0.1;
    CHECK(found <= expected + 1e-12);
    CHECK(found == Approx(expected).epsilon(0).margin(5e-5));
    CHECK(separate<double>(at(block, b), at(round, a)).distance == found);
  }
  CHECK(inside > 20);
}

TEST_CASE("the distance of two boxes is exact, and negative when they overlap") {
  Random random(63);
  int apart = 0, overlapping = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const Vector3d size_a(0.8, 0.6, 0.4), size_b(0.3, 0.5, 0.9);
    const ClearanceShape a = box(size_a), b = box(size_b);
    Pose pose_a = random_pose(random, random.uniform(0, 1.5)), pose_b = random_pose(random, 0);
    // Faces that are parallel, exactly or nearly, also across each other.
    if (trial % 4 > 0) pose_b.orientation = pose_a.orientation;
    if (trial % 4 > 1) {
      const double tilt = trial % 4 == 3 ? 0 : std::pow(10.0, random.uniform(-12, -4));
      pose_b.orientation = pose_a.orientation *
                           rotation_exp(Vector3d(0, 0, random.uniform(-1.5, 1.5))) *
                           rotation_exp(tilt * Vector3d(random.normal(), random.normal(), 0));
    }
    const double gap = separate<double>(at(a, pose_a), at(b, pose_b)).distance;
    const double distance = fcl_distance(
        *make_fcl_shape(Box{size_a}), pose_a.orientation.toRotationMatrix(), pose_a.position,
        *make_fcl_shape(Box{size_b}), pose_b.orientation.toRotationMatrix(), pose_b.position);
    if (distance > 1e-3) {
      ++apart;
      const auto placed = [](const Vector3d& size, const Pose& pose) {
        return PlacedBox{size / 2, pose.orientation.toRotationMatrix(), pose.position};
      };
      CHECK(gap == Approx(separate_box_distance(placed(size_a, pose_a), placed(size_b, pose_b)))
                       .epsilon(0)
                       .margin(1e-9));
    } else if (distance <= 0) {
      ++overlapping;
      CHECK(gap <= 1e-9);
    }
  }
  CHECK(apart > 200);
  CHECK(overlapping > 100);
}

TEST_CASE("a bar over a parallel face is as far as its edges, whichever corner it cuts off") {
  Random random(69);
  const ClearanceShape block = box({1, 1, 1}), bar = box({2, 0.1, 0.1});
  for (int trial = 0; trial < 100; ++trial) {
    const Pose pose = random_pose(random, 1);
    const double x = trial % 2 == 0 ? 0.35 : -0.35, y = trial % 4 < 2 ? 0.35 : -0.35;
    const Pose across{{x, y, 0.5 + 0.05 + 0.03},
                      rotation_exp(Vector3d(0, 0, x * y > 0 ? -kPi / 4 : kPi / 4))};
    CHECK(separate<double>(at(block, pose), at(bar, pose * across)).distance ==
          Approx(0.03).epsilon(0).margin(1e-12));
  }
}

TEST_CASE("where faces of two boxes are parallel both sides of the kink are rows of their own") {
  Random random(68);
  CaptureProblem problem = tumbling_problem(random, random_robot(random, 7, false));
  problem.target->shapes = {{{}, Box{{0.6, 0.6, 0.6}}}};
  problem.robot.shapes = {{kBase, "base", {}, Box{{0.6, 0.6, 0.6}}}};
  problem.constraints.clearance = 0.05;
  const Formulation formulation(problem);
  const Eigen::VectorXd x =
      formulation.start_point(low_discrepancy_point(0, formulation.num_variables(), 1));
  nlp::Evaluation here;
  formulation.evaluate_value(x, here);
  const auto& rows = formulation.parts().rows.kept;
  std::vector<double> corners;
  std::optional<double> least;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i]->name.rfind("clearance_", 0) != 0) continue;
    const double value = here.constraints[static_cast<Eigen::Index>(i)];
    if (rows[i]->is_part) {
      corners.push_back(value);
    } else {
      REQUIRE_FALSE(least);
      least = value;
    }
  }
  REQUIRE(least);
  CHECK(corners.size() == 16);
  for (const double corner : corners) CHECK(corner >= *least - 1e-12);
  int reported = 0;
  for (const ConstraintValue& value : formulation.report(x)) {
    reported += value.name.rfind("clearance_", 0) == 0;
  }
  CHECK(reported == 1);
}

TEST_CASE(
    "a cylinder's distance is never above the true one, and exact beside it and at its ends") {
  Random random(64);
  const double radius = 0.2, length = 0.3;
  const auto drum = make_fcl_shape(Cylinder{radius, length});
  const auto ball = make_fcl_shape(Sphere{0.1});
  int exact = 0, apart = 0, rims = 0;
  for (int trial = 0; trial < 600; ++trial) {
    const ClearanceShape a = cylinder(radius, length);
    const ClearanceShape b = trial % 2 == 0 ? cylinder(radius, length) : capsule(0.1, 0);
    const Pose pose_a = random_pose(random, random.uniform(0, 0.8)),
               pose_b = random_pose(random, 0);
    const double found = separate<double>(at(a, pose_a), at(b, pose_b)).distance;
    const double distance = fcl_distance(*drum, pose_a.orientation.toRotationMatrix(),
                                         pose_a.position, *(trial % 2 == 0 ? drum : ball),
                                         pose_b.orientation.toRotationMatrix(), pose_b.position);
    if (distance <= 0) {
      CHECK(found <= 1e-9);
      continue;
    }
    ++apart;
    CHECK(found <= distance + 1e-6);
    exact += found > distance - 1e-5;
    // Two rims: the box is 0.41 of the radius too far out, the capsule 0.41 of it at most there.
    CHECK(found >= distance - 2 * 0.42 * radius);
    rims += found < 0;
  }
  CHECK(apart > 200);
  CHECK(exact > apart / 5);
  CHECK(rims < apart / 10);
}

TEST_CASE("what lies before the end of a cylinder is as far as the end is") {
  const ClearanceShape drum = cylinder(0.12, 0.2), ball = capsule(0.05, 0);
  for (const double height : {0.16, 0.2, 0.5}) {
    const Pose above{Vector3d(0.03, 0.02, height), Eigen::Quaterniond::Identity()};
    const Separation<double> found = separate<double>(at(ball, above), at(drum, Pose{}));
    CHECK(found.distance == Approx(height - 0.1 - 0.05).epsilon(0).margin(1e-12));
    CHECK((found.normal - Vector3d::UnitZ()).norm() < 1e-12);
  }
}

TEST_CASE(
    "shapes that are surely beyond a distance are beyond it, and most that are far are known") {
  Random random(70);
  const ClearanceShape shapes[] = {box({0.75, 0.75, 0.75}), box({0.1, 0.5, 0.1}),
                                   capsule(0.06, 0.4),      capsule(0.1, 0),
                                   cylinder(0.06, 0.4),     cylinder(0.3, 0.1)};
  int far = 0, known = 0;
  for (const ClearanceShape& a : shapes) {
    for (const ClearanceShape& b : shapes) {
      for (int trial = 0; trial < 100; ++trial) {
        const Pose pose_a = random_pose(random, random.uniform(0, 1.5)),
                   pose_b = random_pose(random, 0);
        const double wanted = trial % 3 == 0 ? 0 : random.uniform(0, 0.2);
        const double distance = separate<double>(at(a, pose_a), at(b, pose_b)).distance;
        const bool is_known = is_beyond(at(a, pose_a), at(b, pose_b), wanted);
        if (is_known) CHECK(distance > wanted - 1e-12);
        far += distance > wanted + 0.2;
        known += is_known && distance > wanted + 0.2;
      }
    }
  }
  CHECK(far > 1000);
  CHECK(known > 0.9 * far);
}

TEST_CASE("violations are those of all rows, whatever was not evaluated for them") {
  Random random(71);
  CaptureProblem problem = tumbling_problem(random, random_robot(random, 7, false));
  problem.target->shapes = {{{}, Box{{0.6, 0.6, 0.6}}}};
  problem.robot.shapes = {{kBase, "base", {}, Box{{0.6, 0.6, 0.6}}}};
  for (int k = 0; k < 6; ++k) {
    const Pose pose{Vector3d(0, 0, 0.1), Eigen::Quaterniond::Identity()};
    problem.robot.shapes.push_back(
        {k, "link" + std::to_string(k), pose,
         k % 2 == 0 ? Geometry(Cylinder{0.05, 0.2}) : Geometry(Box{{0.1, 0.1, 0.2}})});
  }
  problem.constraints.clearance = 0.05;
  const Formulation formulation(problem);
  const Eigen::VectorXd lower = formulation.constraint_lower(),
                        upper = formulation.constraint_upper();
  int inequalities = 0;
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::VectorXd x =
        formulation.start_point(low_discrepancy_point(trial, formulation.num_variables(), 1));
    nlp::Evaluation all;
    formulation.evaluate(x, all);
    const Eigen::VectorXd violation = nlp::signed_violation(all.constraints, lower, upper);
    for (const bool equations_alone : {false, true}) {
      std::vector<Eigen::Index> rows;
      for (Eigen::Index i = 0; i < violation.size(); ++i) {
        const bool is_equation = lower[i] == upper[i];
        if (is_equation || (!equations_alone && violation[i] != 0)) rows.push_back(i);
        inequalities += !is_equation && !equations_alone && violation[i] != 0;
      }
      Eigen::VectorXd found;
      Eigen::MatrixXd jacobian;
      formulation.evaluate_violated(x, equations_alone, false, found, jacobian);
      REQUIRE(found.size() == static_cast<Eigen::Index>(rows.size()));
      CHECK(found == violation(rows));
      CHECK(jacobian == all.jacobian(rows, Eigen::all));
    }
  }
  CHECK(inequalities > 50);
}

TEST_CASE("only bodies that may not touch are kept apart") {
  Random random(64);
  CaptureProblem problem = tumbling_problem(random, random_robot(random, 3, false));
  problem.robot.hand_body = 2;
  for (int k = 0; k < 3; ++k) problem.robot.joints[static_cast<std::size_t>(k)].parent = k - 1;
  problem.robot.shapes = {{kBase, "base", {}, Box{{1, 1, 1}}}};
  for (int k = 0; k < 3; ++k) {
    problem.robot.shapes.push_back({k, "link_" + std::to_string(k), {}, Sphere{0.05}});
  }
  problem.target->shapes = {{{}, Box{{0.6, 0.6, 0.6}}}};
  const auto names = [&problem] {
    std::string out;
    for (const ClearancePair& pair : clearance_pairs(problem)) out += pair.name.substr(10) + " ";
    return out;
  };
  const auto has = [&names](const std::string& name) {
    return names().find(name) != std::string::npos;
  };
  CHECK(has("1_3_base_link_1"));
  CHECK(has("2_4_link_0_link_2"));
  CHECK(has("1_5_base_target"));
  CHECK(has("3_5_link_1_target"));
  CHECK_FALSE(has("link_2_target"));  // the hand's body is to touch it
  problem.allowed_contacts = {{"link_2", "link_0"}};
  CHECK_FALSE(has("2_4_link_0_link_2"));
}

TEST_CASE("a search keeps the margins that the problem asks for") {
  Random random(65);
  CaptureProblem problem = tumbling_problem(random, random_robot(random, 7, false));
  for (Joint& joint : problem.robot.joints) joint.type = JointType::Revolute;
  problem.target->shapes = {{{}, Box{{0.6, 0.6, 0.6}}}};
  problem.robot.shapes = {{kBase, "base", {}, Box{{0.6, 0.6, 0.6}}}};
  problem.variables.base_position = PositionFreedom::Free;
  problem.constraints.joint_rate_max = JointVectord::Constant(7, 0.05);
  problem.constraints.coupling_singular_value_min = 0.5;
  problem.constraints.jacobian_singular_value_min = 0.05;
  problem.constraints.clearance = 0.05;
  const Formulation formulation(problem);
  SearchOptions options;
  options.starts = 16;
  const SearchResult found = search(problem, formulation, options);
  REQUIRE(found.distinct_solutions > 0);
  const Eigen::VectorXd& x = found.points.front();
  std::string names;
  for (const ConstraintValue& value : formulation.report(x)) {
    names += value.name + " ";
    CHECK(value.violation <= 1e-9);
  }
  for (const char* name : {"joint_rate_", "coupling_singular_value", "jacobian_singular_value",
                           "clearance_1_2_base_target"}) {
    CHECK_THAT(names, Catch::Contains(name));
  }
}

TEST_CASE("a margin counts the singular values of the generic rank only") {
  Random random(66);
  CaptureProblem problem = point_mass_problem(random_planar_robot(random, 3), {0.6, 0.8, 0});
  problem.constraints.coupling_singular_value_min = 1e-3;
  const CaptureModel model(problem, encounter_model(problem));
  const auto at =
      model.place<double>(model.layout.start_point(problem, low_discrepancy_point(3, 3, 0)));
  const auto posture = model.posture(at);
  const auto impact = model.impact(at, posture, model.nominal);
  int margins = 0;
  for (const auto& row : constraints_of(model).rows) {
    if (row->name != "coupling_singular_value") continue;
    ++margins;
    // Of rank 1, the matrix of a planar robot has one singular value: the length of its row.
    CHECK(row->value({model, at, posture, impact}) ==
          Approx(posture.tilde.Htilde_omegaphi.row(2).norm()).epsilon(1e-12));
  }
  CHECK(margins == 1);
}

TEST_CASE("clearances that the problem leaves undefined are refused") {
  Random random(67);
  CaptureProblem problem = tumbling_problem(random, random_robot(random, 4, false));
  problem.target->shapes = {{{}, Box{{0.6, 0.6, 0.6}}}};
  problem.constraints.clearance = 0.01;
  problem.hand.position = Vector3d(1, 2, 3);
  CHECK_THROWS_AS(Formulation(problem), InputError);
  CaptureProblem along = point_mass_problem(random_robot(random, 4, false), {0.6, 0.8, 0});
  along.target->shapes = {{{}, Sphere{0.1}}};
  along.constraints.clearance = 0.01;
  CHECK_NOTHROW(Formulation(along));
  along.variables.base_attitude = AttitudeFreedom::Free;
  CHECK_THROWS_AS(Formulation(along), InputError);
}

TEST_CASE("distances that are larger by far may be cut, all other rows are as they are") {
  constexpr double kFar = 0.2;
  Random random(71);
  CaptureProblem problem = tumbling_problem(random, random_robot(random, 7, false));
  problem.target->shapes = {{{}, Box{{0.6, 0.6, 0.6}}}};
  problem.robot.shapes = {{kBase, "base", {}, Box{{0.6, 0.6, 0.6}}},
                          {2, "link_3", {}, Capsule{0.1, 0.3}},
                          {4, "link_5", {}, Sphere{0.15}}};
  problem.constraints.clearance = 0.05;
  const Formulation formulation(problem);
  const std::vector<Scenario> many(5, formulation.nominal_scenario());
  int cut = 0, distances = 0;
  for (int i = 1; i <= 20; ++i) {
    const Eigen::VectorXd x =
        formulation.start_point(low_discrepancy_point(i, formulation.num_variables(), 9));
    nlp::Evaluation whole, near;
    near.far = kFar;
    formulation.evaluate(x, whole);
    formulation.evaluate(x, near);
    ScenarioEvaluation beside;
    beside.far = kFar;
    formulation.evaluate_scenarios(x, many, true, beside);
    CHECK(beside.constraints == near.constraints);
    CHECK(beside.jacobian == near.jacobian);
    for (Eigen::Index row = 0; row < whole.constraints.size(); ++row) {
      const Constraint& constraint = *formulation.parts().rows.kept[static_cast<std::size_t>(row)];
      const bool is_distance = constraint.name.rfind("clearance_", 0) == 0;
      distances += is_distance;
      if (near.constraints[row] == whole.constraints[row]) {
        CHECK(near.jacobian.row(row) == whole.jacobian.row(row));
        continue;
      }
      CAPTURE(constraint.name);
      CHECK(is_distance);
      CHECK(near.constraints[row] == constraint.lower + kFar);
      CHECK(whole.constraints[row] > near.constraints[row]);
      CHECK(near.jacobian.row(row).isZero(0.0));
      ++cut;
    }
  }
  CHECK(cut > distances / 4);
  CHECK(cut < distances);
}

}  // namespace stillbase
