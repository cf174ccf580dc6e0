// The measures and the numerics that the verdict rests on.
#include <catch2/catch.hpp>

#include "../reference/random_state.hpp"
#include "verification/claim_list.hpp"
#include "verification/objective.hpp"
#include "verification/path_motion.hpp"

using namespace stillbase;
using namespace stillbase::verification;

TEST_CASE("the relative error of a vector sees small components beside large ones") {
  const Eigen::Vector3d found(100, 1e-3, 0);
  CHECK(relative_error(found, found) == 0);
  for (int i = 0; i < 2; ++i) {
    Eigen::Vector3d stated = found;
    stated(i) *= 1 + 1e-6;
    CHECK(relative_error(stated, found) > 5e-10);
  }
  Eigen::Vector3d rounded = found;
  rounded(2) = 1e-14;
  CHECK(relative_error(rounded, found) <= 1e-13);
  CHECK_FALSE(std::isfinite(relative_error(Eigen::Vector2d(1, 2), found)));
  CHECK_FALSE(std::isfinite(relative_error(Eigen::Vector3d(1, 2, std::nan("")), found)));
  CHECK_FALSE(std::isfinite(relative_error(1e-300, 0.0)));
  CHECK(relative_error(1e-14, 0.0, 1.0) <= 1e-11);
}

TEST_CASE("pose errors are exact for tiny and for large rotations") {
  const Pose a{{1, 2, 3}, rotation_exp({0.3, -0.4, 1.2})};
  for (const double angle : {1e-12, 1e-6, 0.5, 3.0}) {
    const Pose b{{1, 2, 3 + angle}, a.orientation * rotation_exp(angle * Vector3d(0.6, 0, 0.8))};
    CHECK(pose_error(a, b).angle == Approx(angle).epsilon(1e-3));
    CHECK(pose_error(a, b).position == Approx(angle).epsilon(1e-3));
  }
  CHECK(angle_between(Vector3d::UnitX(), -Vector3d::UnitX()) == Approx(M_PI));
  CHECK(angle_between(Vector3d::UnitX(), Vector3d(1, 1e-11, 0)) == Approx(1e-11));
}

TEST_CASE("a check whose value is not finite fails") {
  ClaimList claims;
  CHECK_FALSE(claims.all_pass());
  claims.at_most("fine", 1, 1, "1", "");
  CHECK(claims.all_pass());
  claims.at_most("nan", std::nan(""), 1, "1", "");
  claims.at_least("inf", kInfinity, 1, 0, "1", "");
  CHECK_FALSE(claims.all_pass());
  for (std::size_t i = 1; i < 3; ++i) {
    CHECK_FALSE(claims.claims()[i].value.has_value());
    CHECK_FALSE(claims.claims()[i].pass);
  }
}

TEST_CASE("extremes of a Hermite segment are those found by sampling") {
  Random random(51);
  for (int trial = 0; trial < 200; ++trial) {
    Approach approach;
    approach.times = {1, 1 + random.uniform(0.1, 2)};
    for (int i = 0; i < 2; ++i) {
      JointVectord phi(3), phidot(3);
      for (int k = 0; k < 3; ++k) {
        phi(k) = random.normal();
        phidot(k) = trial % 5 == 0 && i == 0 ? 0.0 : 3 * random.normal();
      }
      approach.joint_positions.push_back(phi);
      approach.joint_velocities.push_back(phidot);
    }
    const HermiteSegment segment(approach, 0);
    const double h = segment.duration();
    CHECK((segment.position(h) - approach.joint_positions[1]).norm() <= 1e-12);
    CHECK((segment.velocity(h) - approach.joint_velocities[1]).norm() <= 1e-11);
    const auto e = segment.extremes();
    Eigen::VectorXd lowest = segment.position(0), highest = lowest;
    Eigen::VectorXd rate = Eigen::VectorXd::Zero(3), acceleration = rate;
    for (int j = 0; j <= 2000; ++j) {
      const double s = h * j / 2000;
      lowest = lowest.cwiseMin(segment.position(s));
      highest = highest.cwiseMax(segment.position(s));
      rate = rate.cwiseMax(segment.velocity(s).cwiseAbs());
      acceleration = acceleration.cwiseMax(segment.acceleration(s).cwiseAbs());
    }
    CHECK((e.lowest - lowest).cwiseAbs().maxCoeff() <= 1e-4);
    CHECK((e.lowest - lowest).maxCoeff() <= 1e-12);
    CHECK((e.highest - highest).cwiseAbs().maxCoeff() <= 1e-4);
    CHECK((highest - e.highest).maxCoeff() <= 1e-12);
    CHECK((e.rate - rate).cwiseAbs().maxCoeff() <= 1e-3);
    CHECK((rate - e.rate).maxCoeff() <= 1e-12);
    CHECK((e.acceleration - acceleration).cwiseAbs().maxCoeff() <= 1e-9);
  }
}

TEST_CASE("the base drifts so that system centroid and momentum stay") {
  Random random(52);
  const RobotModel robot = reference_test::random_robot(random, 5, true);
  Approach approach;
  approach.times = {0, 2};
  for (int i = 0; i < 2; ++i) {
    const auto state = reference_test::random_state(random, 5);
    approach.joint_positions.push_back(state.phi);
    approach.joint_velocities.push_back(state.phidot);
  }
  const HermiteSegment segment(approach, 0);
  const Pose start{{1, 2, 3}, rotation_exp({0.3, 0.2, -0.5})};
  const Pose end = drifted_base(robot, segment, start, 0.01);
  auto centroid_N = [&](const Pose& base, double s) {
    return base * Vector3d(reference::compute(robot, {segment.position(s), {}, {}}).centroid);
  };
  CHECK((centroid_N(end, 2) - centroid_N(start, 0)).norm() <= 1e-8);

  const auto Omega = drifting_base_velocity(robot, segment.position(1), segment.velocity(1));
  const auto d = reference::compute(robot, {segment.position(1), segment.velocity(1), Omega});
  CHECK(d.P.norm() <= 1e-12);
  CHECK(d.L_g.norm() <= 1e-12);

  // Fourth order: a step ten times shorter changes the end by the error of the longer one.
  const Pose finer = drifted_base(robot, segment, start, 0.001);
  CHECK(pose_error(end, finer).largest() <= 1e-8);
  const Pose coarse = drifted_base(robot, segment, start, 0.2);
  const Pose half = drifted_base(robot, segment, start, 0.1);
  const double order =
      std::log2(pose_error(coarse, finer).largest() / pose_error(half, finer).largest());
  CHECK(order == Approx(4).epsilon(0).margin(0.7));
}

TEST_CASE("the base between two steps is where finer steps bring it, within the bound") {
  Random random(53);
  const RobotModel robot = reference_test::random_robot(random, 5, true);
  Approach approach;
  approach.times = {0, 0.5};
  for (int i = 0; i < 2; ++i) {
    const auto state = reference_test::random_state(random, 5);
    approach.joint_positions.push_back(state.phi * 0.2);
    approach.joint_velocities.push_back(state.phidot);
  }
  const HermiteSegment segment(approach, 0);
  const BaseTrack track(robot, segment, Pose{}, 0.005), finer(robot, segment, Pose{}, 0.0007);
  double tightest = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const double a = random.uniform(0, 0.5), b = random.uniform(0, 0.5), t = random.uniform(a, b);
    CHECK(pose_error(track.pose(t), finer.pose(t)).largest() <= 1e-9);
    const double s0 = std::min(a, b), s1 = std::max(a, b);
    const auto bound = track.bound(s0, s1, segment.peak_rates(s0, s1) * (s1 - s0));
    const PoseError moved = pose_error(finer.pose(a), finer.pose(t));
    CHECK(moved.position <= bound.translation);
    CHECK(moved.angle <= bound.rotation);
    if (bound.rotation > 0) tightest = std::max(tightest, moved.angle / bound.rotation);
  }
  CHECK(tightest > 0.1);
}

TEST_CASE("the worst direction is found inside the cone, on its rim and in a wedge") {
  const Vector3d n = Vector3d(1, 2, -1).normalized();
  const double half_angle = 0.2;
  auto off_axis = [&](double angle) -> Vector3d {
    return rotation_exp(angle * n.unitOrthogonal()) * n;
  };
  // A bump around a direction inside the cone, not at a sample.
  const Vector3d peak = off_axis(0.1234);
  auto bump = [&](const Vector3d& d) { return std::exp(-50 * (d - peak).squaredNorm()); };
  const WorstDirection inside = worst_over_cone(bump, n, half_angle, std::nullopt, 1000);
  CHECK(inside.value == Approx(1).epsilon(1e-9));
  CHECK(angle_between(inside.direction, peak) <= 1e-5);

  // Growing towards a direction far outside: the rim point nearest to it.
  const Vector3d away = off_axis(1.3);
  auto slope = [&](const Vector3d& d) { return d.dot(away); };
  const WorstDirection rim = worst_over_cone(slope, n, half_angle, std::nullopt, 1000);
  CHECK(rim.value == Approx(std::cos(1.3 - half_angle)).epsilon(1e-9));
  CHECK(angle_between(rim.direction, n) == Approx(half_angle).epsilon(1e-9));

  // In the wedge only turns about the plane's normal count.
  const Vector3d m = n.unitOrthogonal();
  const WorstDirection wedge = worst_over_cone(slope, n, half_angle, m, 400);
  CHECK(wedge.value == Approx(std::cos(1.3 - half_angle)).epsilon(1e-9));
  const Vector3d other = n.cross(m);
  auto sideways = [&](const Vector3d& d) { return d.dot(m); };
  CHECK(std::abs(worst_over_cone(sideways, n, half_angle, m, 400).value) <= 1e-12);
  CHECK(worst_over_cone(sideways, n, half_angle, other, 400).value ==
        Approx(std::sin(half_angle)).epsilon(1e-9));

  // No cone: the axis itself.
  CHECK(worst_over_cone(slope, n, 0, std::nullopt, 1000).value == Approx(n.dot(away)));
}
