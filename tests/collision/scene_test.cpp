#include <catch2/catch.hpp>

#include <array>
#include <cmath>
#include <set>
#include <thread>

#include <stillbase/collision/contact_survey.hpp>
#include <stillbase/collision/scene.hpp>
#include <stillbase/core/random.hpp>

#include "collision/planar_robot.hpp"

using namespace stillbase;
using namespace stillbase::test;

namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

JointVectord posture(std::initializer_list<double> degrees) {
  JointVectord phi(static_cast<Eigen::Index>(degrees.size()));
  Eigen::Index k = 0;
  for (const double d : degrees) phi[k++] = d * kDegree;
  return phi;
}

std::string hit_name(const CollisionScene& scene, const RobotModel& robot, const JointVectord& phi,
                     const Pose* target = nullptr, const Pose& base = {}, double margin = 0) {
  const auto hit = scene.first_hit(compute_kinematics<double>(robot, phi), base, target, margin);
  return hit ? to_string(*hit) : "";
}

}  // namespace

TEST_CASE("a link whose shoulder stands off the base is checked against the base") {
  const RobotModel robot = planar_robot(2, 1.4);
  const CollisionScene scene(robot, {});
  CHECK(scene.pair_count() == 2);  // link1 and link2 against the base; the elbow is exempt
  CHECK(hit_name(scene, robot, posture({-80, 160})).empty());
  CHECK(hit_name(scene, robot, posture({180, 0})) == "link1 with base");
  CHECK(hit_name(scene, robot, posture({100, 130})) == "link2 with base");
}

TEST_CASE("bodies joined where both shapes reach the joint are exempt") {
  const CollisionScene scene(planar_robot(2, 1.2), {});
  CHECK(scene.pair_count() == 1);  // link2 with base alone
}

TEST_CASE("joined shapes that overlap wherever the joint stands are exempt, others are not") {
  RobotModel robot = planar_robot(2, 1.2);
  // A flange in front of the elbow, on its axis: inside the end of link 1 at every angle.
  robot.shapes.back() = {1, "link2", Pose{Vector3d(0.03, 0, 0), Eigen::Quaterniond::Identity()},
                         Sphere{0.02}};
  CHECK(CollisionScene(robot, {}).pair_count() == 1);
  // Further out it leaves link 1 when the elbow is straight.
  robot.shapes.back().pose.position.x() = 0.3;
  CHECK(CollisionScene(robot, {}).pair_count() == 2);
}

TEST_CASE("allowed contacts are not looked at") {
  const RobotModel robot = planar_robot();
  SceneParts parts;
  parts.allowed_contacts = {{"base", "link1"}};
  const CollisionScene scene(robot, parts);
  CHECK(scene.pair_count() == 1);
  CHECK(hit_name(scene, robot, posture({180, 0})) == "link2 with base");
}

TEST_CASE("the margin decides between a collision and none at the distance that nearest() gives") {
  const RobotModel robot = planar_robot();
  const CollisionScene scene(robot, {});
  Random random(1);
  int apart = 0;
  for (int i = 0; i < 200; ++i) {
    const JointVectord phi = posture({random.uniform(-170, 170), random.uniform(-170, 170)});
    const auto kinematics = compute_kinematics<double>(robot, phi);
    const auto nearest = scene.nearest(kinematics, Pose{}, nullptr);
    REQUIRE(nearest);
    if (nearest->distance <= 0) {
      CHECK(scene.first_hit(kinematics, Pose{}, nullptr));
      continue;
    }
    ++apart;
    CHECK_FALSE(scene.first_hit(kinematics, Pose{}, nullptr, nearest->distance - 1e-9));
    CHECK(scene.first_hit(kinematics, Pose{}, nullptr, nearest->distance + 1e-9));
  }
  CHECK(apart > 50);
}

TEST_CASE("obstacles stay in their frame") {
  const RobotModel robot = planar_robot();
  const Vector3d beside_hand(5.4, 0.3, 0);
  const Pose moved{Vector3d(1, 2, 3),
                   Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Vector3d::UnitX()))};
  for (const Frame frame : {Frame::Base, Frame::Inertial}) {
    SceneParts parts;
    parts.obstacles = {
        {"panel", frame, Pose{beside_hand, Eigen::Quaterniond::Identity()}, Sphere{0.3}}};
    const CollisionScene scene(robot, parts);
    const std::string expected = "link2 with panel";
    CHECK(hit_name(scene, robot, posture({0, 0})) == expected);
    CHECK(hit_name(scene, robot, posture({0, 0}), nullptr, moved) ==
          (frame == Frame::Base ? expected : ""));
  }
}

TEST_CASE("a round point mass may touch the hand's link at the hand only") {
  const RobotModel robot = planar_robot();
  SceneParts parts;
  parts.target = point_target();
  parts.contact_allowance = 0.15;
  const CollisionScene scene(robot, parts);
  const JointVectord straight = posture({0, 0});  // hand at (5.4, 0, 0)
  const auto target_at = [](double x, double y) {
    return Pose{Vector3d(x, y, 0), Eigen::Quaterniond::Identity()};
  };
  const Pose at_hand = target_at(5.5, 0), on_link = target_at(4.5, 0.15),
             on_link1 = target_at(2, 0);
  const Pose in_base = target_at(0, 0), far = target_at(9, 9);
  CHECK(hit_name(scene, robot, straight, &at_hand).empty());
  CHECK(hit_name(scene, robot, straight, &on_link) == "target with link2");
  CHECK(hit_name(scene, robot, straight, &on_link1) == "target with link1");
  CHECK(hit_name(scene, robot, straight, &in_base) == "target with base");
  CHECK(hit_name(scene, robot, straight, &far).empty());
  CHECK(hit_name(scene, robot, straight).empty());
}

TEST_CASE("a scene reduced to the target's pairs finds collisions with the target alone") {
  const RobotModel robot = planar_robot();
  SceneParts parts;
  parts.target = point_target();
  const CollisionScene scene = CollisionScene(robot, parts).target_pairs_only();
  CHECK(scene.pair_count() == 3);
  const Pose in_base;
  CHECK(hit_name(scene, robot, posture({180, 0})).empty());
  CHECK(hit_name(scene, robot, posture({0, 0}), &in_base) == "target with base");
}

TEST_CASE("the hand may touch the target only where the feature is") {
  const RobotModel robot = planar_robot();
  SceneParts parts;
  parts.target = cube_target();
  parts.feature = parts.target->features.front();
  parts.contact_allowance = 0.15;
  const CollisionScene scene(robot, parts);
  const JointVectord straight = posture({0, 0});
  // The +x face of the cube turned towards the hand, which comes from -x.
  const Eigen::Quaterniond about_z(Eigen::AngleAxisd(180 * kDegree, Vector3d::UnitZ()));
  const Vector3d feature = about_z * parts.feature->point;
  const Pose touching{Vector3d(5.4, 0, 0) - feature, about_z};
  const Pose elsewhere{Vector3d(5.4, 0.25, 0) - feature, about_z};
  CHECK(hit_name(scene, robot, straight, &touching).empty());
  CHECK(hit_name(scene, robot, straight, &elsewhere) == "target with link2");
}

TEST_CASE("the target is checked against what is fixed to the base") {
  const RobotModel robot = planar_robot();
  SceneParts parts;
  parts.target = point_target();
  parts.obstacles = {{"antenna", Frame::Base,
                      Pose{Vector3d(0, 3, 0), Eigen::Quaterniond::Identity()}, Sphere{0.2}}};
  const CollisionScene scene(robot, parts);
  const Pose target{Vector3d(0, 3.1, 0), Eigen::Quaterniond::Identity()};
  CHECK(hit_name(scene, robot, posture({-80, 160}), &target) == "target with antenna");
}

TEST_CASE("what a sweep calls clear stays clear everywhere in the interval") {
  const RobotModel robot = planar_robot(3);
  SceneParts parts;
  parts.target = cube_target();
  parts.feature = parts.target->features.front();
  parts.contact_allowance = 0.15;
  parts.obstacles = {{"panel", Frame::Inertial,
                      Pose{Vector3d(3, 2, 0), Eigen::Quaterniond::Identity()}, Sphere{0.3}}};
  const CollisionScene scene(robot, parts);
  Random random(7);
  const double margin = 0.01;
  int clear = 0, unsure = 0, hits = 0;
  for (int i = 0; i < 300; ++i) {
    const JointVectord phi =
        posture({random.uniform(-90, 90), random.uniform(-90, 90), random.uniform(-90, 90)});
    SceneTravel travel;
    travel.joints = JointVectord::Constant(3, random.uniform(0, 0.1));
    travel.base_translation = random.uniform(0, 0.1);
    travel.base_rotation = random.uniform(0, 0.05);
    travel.target_translation = random.uniform(0, 0.1);
    travel.target_rotation = random.uniform(0, 0.1);
    const Pose target{Vector3d(random.uniform(4, 8), random.uniform(-4, 4), 0),
                      rotation_exp(random.uniform() * random.unit_vector())};
    const SweepResult result =
        scene.sweep(compute_kinematics<double>(robot, phi), Pose{}, &target, travel, margin);
    if (result.verdict == SweepVerdict::Unsure) ++unsure;
    if (result.verdict == SweepVerdict::Hit) {
      ++hits;
      CHECK(result.closest.distance < margin);
    }
    if (result.verdict != SweepVerdict::Clear) continue;
    ++clear;
    for (int s = 0; s < 30; ++s) {
      JointVectord near = phi;
      for (Eigen::Index k = 0; k < 3; ++k)
        near[k] += (random.uniform() < 0.5 ? -1 : 1) * travel.joints[k];
      const Pose base{travel.base_translation * random.unit_vector(),
                      rotation_exp(travel.base_rotation * random.unit_vector())};
      const Pose near_target{
          target.position + travel.target_translation * random.unit_vector(),
          rotation_exp(travel.target_rotation * random.unit_vector()) * target.orientation};
      CHECK_FALSE(
          scene.first_hit(compute_kinematics<double>(robot, near), base, &near_target, margin));
    }
  }
  CHECK(clear > 20);
  CHECK(unsure > 20);
  CHECK(hits > 20);
}

TEST_CASE("in a part of an interval only the pairs that were unsure need another look") {
  const RobotModel robot = planar_robot(3);
  SceneParts parts;
  parts.target = cube_target();
  parts.feature = parts.target->features.front();  // which the hand never is at
  const CollisionScene scene(robot, parts);
  Random random(12);
  const double margin = 0.01;
  std::array<int, 3> verdicts{};
  for (int i = 0; i < 3000; ++i) {
    const JointVectord phi =
        posture({random.uniform(-90, 90), random.uniform(-90, 90), random.uniform(-90, 90)});
    JointVectord half(3);  // how far the joints move to either end
    for (double& joint : half) joint = random.uniform(-0.3, 0.3);
    const Pose target{Vector3d(random.uniform(4, 8), random.uniform(-4, 4), 0),
                      rotation_exp(random.uniform() * random.unit_vector())};
    SceneTravel travel;
    travel.joints = half.cwiseAbs();
    const SweepResult whole =
        scene.sweep(compute_kinematics<double>(robot, phi), Pose{}, &target, travel, margin);
    CHECK(whole.unsure.empty() == (whole.verdict != SweepVerdict::Unsure));
    if (whole.verdict != SweepVerdict::Unsure) continue;
    travel.joints /= 2;
    const auto of_part = compute_kinematics<double>(robot, JointVectord(phi + half / 2));
    const SweepResult all = scene.sweep(of_part, Pose{}, &target, travel, margin);
    const SweepResult among = scene.sweep(of_part, Pose{}, &target, travel, margin, &whole.unsure);
    CHECK(among.verdict == all.verdict);
    CHECK(among.unsure == all.unsure);
    CHECK(scene.sweep_each(of_part, Pose{}, {target}, travel, margin, &whole.unsure).verdict ==
          all.verdict);
    const std::vector<std::size_t> none;
    CHECK(scene.sweep(of_part, Pose{}, &target, travel, margin, &none).verdict ==
          SweepVerdict::Clear);
    ++verdicts[static_cast<std::size_t>(all.verdict)];
  }
  for (const int count : verdicts) CHECK(count > 10);
}

TEST_CASE("a sweep beside several poses of the target says what the worst of them says") {
  const RobotModel robot = planar_robot(3);
  SceneParts parts;
  parts.target = cube_target();
  const CollisionScene scene = CollisionScene(robot, parts).target_pairs_only();
  Random random(8);
  std::array<int, 3> verdicts{};
  for (int i = 0; i < 300; ++i) {
    const auto kinematics = compute_kinematics<double>(
        robot,
        posture({random.uniform(-90, 90), random.uniform(-90, 90), random.uniform(-90, 90)}));
    SceneTravel travel;
    travel.joints = JointVectord::Constant(3, random.uniform(0, 0.1));
    std::vector<Pose> targets;
    std::set<std::size_t> unsure;
    SweepVerdict worst = SweepVerdict::Clear;
    for (int k = 0; k < 4; ++k) {
      targets.push_back({Vector3d(random.uniform(4, 8), random.uniform(-4, 4), 0),
                         rotation_exp(random.uniform() * random.unit_vector())});
      const SweepResult one = scene.sweep(kinematics, Pose{}, &targets.back(), travel, 0.01);
      worst = std::max(worst, one.verdict);
      unsure.insert(one.unsure.begin(), one.unsure.end());
    }
    const SweepResult each = scene.sweep_each(kinematics, Pose{}, targets, travel, 0.01);
    CHECK(each.verdict == worst);
    if (worst == SweepVerdict::Unsure) {
      CHECK(std::set<std::size_t>(each.unsure.begin(), each.unsure.end()) == unsure);
    }
    ++verdicts[static_cast<std::size_t>(worst)];
  }
  for (const int count : verdicts) CHECK(count > 20);
}

TEST_CASE("a pair of any two shapes is hit from its distance on") {
  // A box as a mesh whose frame is at a corner.
  ConvexMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.push_back(
        Vector3d((i & 1) != 0 ? 0.6 : 0, (i & 2) != 0 ? 0.4 : 0, (i & 4) != 0 ? 1.0 : 0));
  }
  mesh.faces = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  const std::vector<Geometry> shapes = {Sphere{0.3}, Capsule{0.1, 0.8}, Cylinder{0.2, 0.9},
                                        Box{Vector3d(0.3, 0.5, 1.2)}, mesh};
  Random random(11);
  const auto random_pose = [&random](double spread) {
    return Pose{spread * random.uniform() * random.unit_vector(),
                rotation_exp(3.0 * random.uniform() * random.unit_vector())};
  };
  int apart = 0;
  for (const Geometry& of_robot : shapes) {
    for (const Geometry& of_target : shapes) {
      for (int i = 0; i < 40; ++i) {
        RobotModel robot = planar_robot(1);
        robot.shapes = {{0, "link1", random_pose(0.5), of_robot}};
        SceneParts parts;
        parts.target = cube_target();
        parts.target->shapes = {{random_pose(0.5), of_target}};
        parts.feature = parts.target->features.front();
        const CollisionScene scene(robot, parts);
        REQUIRE(scene.pair_count() == 1);
        const auto kinematics = compute_kinematics<double>(robot, posture({20}));
        const Pose target{kinematics.o[0] + 1.5 * random.uniform() * random.unit_vector(),
                          rotation_exp(3.0 * random.uniform() * random.unit_vector())};
        const auto nearest = scene.nearest(kinematics, Pose{}, &target);
        REQUIRE(nearest);
        if (nearest->distance < 1e-3) continue;
        ++apart;
        CHECK_FALSE(
            scene.first_hit(kinematics, Pose{}, &target, nearest->distance - kDistanceTolerance));
        CHECK(scene.first_hit(kinematics, Pose{}, &target, nearest->distance + kDistanceTolerance));
      }
    }
  }
  CHECK(apart > 200);
}

TEST_CASE("the nearest pair below a distance is the nearest one or none") {
  const RobotModel robot = planar_robot(3);
  SceneParts parts;
  parts.target = cube_target();
  const CollisionScene scene(robot, parts);
  const Pose target{Vector3d(6, 1, 0), Eigen::Quaterniond::Identity()};
  Random random(9);
  for (int i = 0; i < 100; ++i) {
    const auto kinematics = compute_kinematics<double>(
        robot,
        posture({random.uniform(-60, 60), random.uniform(-60, 60), random.uniform(-60, 60)}));
    const auto nearest = scene.nearest(kinematics, Pose{}, &target);
    REQUIRE(nearest);
    const double d = nearest->distance;
    if (d <= 0) continue;
    CHECK_FALSE(scene.nearest(kinematics, Pose{}, &target, true, d));
    const auto below = scene.nearest(kinematics, Pose{}, &target, true, 1.01 * d);
    REQUIRE(below);
    CHECK(to_string(*below) == to_string(*nearest));
    CHECK(below->distance == d);
  }
}

TEST_CASE("bodies that overlap are a hit whatever the margin") {
  SceneParts parts;
  parts.target = cube_target();
  const CollisionScene scene(planar_robot(3), parts);
  const auto kinematics = compute_kinematics<double>(planar_robot(3), posture({0, 0, 0}));
  SceneTravel travel;
  travel.joints = JointVectord::Zero(3);
  CHECK(scene.sweep(kinematics, Pose{}, nullptr, travel, -10).verdict != SweepVerdict::Hit);
  const Pose inside;  // the target is in the base
  CHECK(scene.sweep(kinematics, Pose{}, &inside, travel, -10).verdict == SweepVerdict::Hit);
}

TEST_CASE("numbers that are not finite are refused before they reach FCL") {
  const RobotModel robot = planar_robot();
  SceneParts parts;
  parts.target = cube_target();
  const CollisionScene scene(robot, parts);
  const auto good = compute_kinematics<double>(robot, posture({0, 0}));
  JointVectord phi = posture({0, 0});
  phi[1] = std::nan("");
  CHECK_THROWS_AS(scene.nearest(compute_kinematics<double>(robot, phi), Pose{}, nullptr),
                  std::invalid_argument);
  Pose bad;
  bad.position.x() = kInfinity;
  CHECK_THROWS_AS(scene.first_hit(good, Pose{}, &bad), std::invalid_argument);
  parts.target->shapes.front().geometry = Sphere{std::nan("")};
  CHECK_THROWS_AS(CollisionScene(robot, parts), std::invalid_argument);
}

TEST_CASE("copies of a scene answer alike in several threads") {
  const RobotModel robot = planar_robot(3);
  SceneParts parts;
  parts.target = cube_target();
  const CollisionScene scene(robot, parts);
  const auto answers = [&robot](const CollisionScene& copy) {
    std::vector<double> distances;
    Random random(9);
    for (int i = 0; i < 300; ++i) {
      const JointVectord phi =
          posture({random.uniform(-90, 90), random.uniform(-90, 90), random.uniform(-90, 90)});
      const Pose target{Vector3d(4, random.uniform(-2, 2), 0), Eigen::Quaterniond::Identity()};
      distances.push_back(
          copy.nearest(compute_kinematics<double>(robot, phi), Pose{}, &target)->distance);
    }
    return distances;
  };
  const std::vector<double> expected = answers(scene);
  std::vector<double> first, second;
  {
    std::jthread a([&, copy = scene] { first = answers(copy); });
    std::jthread b([&, copy = scene] { second = answers(copy); });
  }
  CHECK(first == expected);
  CHECK(second == expected);
}

TEST_CASE("a problem whose target lacks the feature asked for has no scene") {
  CaptureProblem problem;
  problem.robot = planar_robot();
  problem.target = cube_target();
  problem.variables.feature = "face";
  CHECK_NOTHROW(CollisionScene(problem));
  problem.variables.feature = "other";
  CHECK_THROWS_AS(CollisionScene(problem), std::invalid_argument);
}

TEST_CASE("links that are always closer than a margin are listed as if they touched") {
  RobotModel robot = test::planar_robot();
  // Caps end 5 mm before the joint: 10 mm apart when straight, in contact when bent.
  for (CollisionShape& shape : robot.shapes) {
    if (shape.body != kBase) shape.geometry = Capsule{0.08, 1.83};
  }
  CHECK(survey_contacts(robot).always.empty());
  const auto close = survey_contacts(robot, {.margin = 0.02}).always;
  REQUIRE(close.size() == 1);
  CHECK(close[0] == std::pair<std::string, std::string>("link1", "link2"));
  // They touch where the joint bends by more than 40 degrees: in 78 % of its range.
  CHECK(survey_contacts(robot, {.postures = 1000, .share = 0.7}).always.size() == 1);
  CHECK(survey_contacts(robot, {.postures = 1000, .share = 0.85}).always.empty());
}

TEST_CASE("the points of the nearest pair are in the base frame, wherever the base is") {
  const RobotModel robot = planar_robot(2, 1.4);
  SceneParts parts;
  // A ball that stands still in N, 0.1 m beside the tip of the straight arm.
  parts.obstacles = {{"ball", Frame::Inertial, Pose{Vector3d(3, 9, 0.2)}, Sphere{0.25}}};
  const CollisionScene scene(robot, parts);
  const Pose base{Vector3d(3 - 5.4 - 0.08 - 0.25 - 0.1, 9, 0.2), Eigen::Quaterniond::Identity()};
  for (const Pose& turn : {Pose{}, Pose{Vector3d(0, 0, 7), rotation_exp(Vector3d(0.4, 1, 2))}}) {
    SceneParts moved = parts;
    moved.obstacles.front().pose = turn * parts.obstacles.front().pose;
    const auto kinematics = compute_kinematics<double>(robot, posture({0, 0}));
    const auto nearest =
        CollisionScene(robot, moved).nearest_points(kinematics, turn * base, nullptr);
    REQUIRE(nearest);
    CHECK(to_string(nearest->pair) == "link2 with ball");
    CHECK(nearest->pair.distance == Approx(0.1));
    CHECK((nearest->on_first - Vector3d(5.48, 0, 0)).norm() < 1e-9);
    CHECK((nearest->on_second - Vector3d(5.58, 0, 0)).norm() < 1e-9);
  }
  // The ball inside the link: there are no such points.
  const auto kinematics = compute_kinematics<double>(robot, posture({0, 0}));
  const Pose inside{base.position + Vector3d(1, 0, 0), base.orientation};
  CHECK_FALSE(scene.nearest_points(kinematics, inside, nullptr));
}

TEST_CASE("the first of many poses of the target at which it is hit is that of single queries") {
  const RobotModel robot = planar_robot(3, 1.2);
  SceneParts parts;
  parts.target = TargetBody{};
  parts.target->shapes.push_back({Pose{}, Sphere{0.3}});
  const CollisionScene scene(robot, parts);
  Random random(41);
  int hits = 0, clear = 0, later = 0;
  for (int trial = 0; trial < 300; ++trial) {
    JointVectord phi(3);
    for (double& angle : phi) angle = random.uniform(-2.5, 2.5);
    const auto kinematics = compute_kinematics<double>(robot, phi);
    const Vector3d from = 4 * random.unit_vector(), step = 0.4 * random.unit_vector();
    const auto pose = [&](int i) { return Pose{from + i * step, Eigen::Quaterniond::Identity()}; };
    constexpr int kPoses = 12;
    const double margin = trial % 2 == 0 ? 0 : 0.1;
    int asked = 0;
    const auto found = scene.first_hit_of_each(
        kinematics, Pose{}, kPoses,
        [&](int i) {
          ++asked;
          return pose(i);
        },
        margin);
    std::string wanted;
    int at = 0;
    for (; at < kPoses && wanted.empty(); ++at) {
      const Pose target = pose(at);
      const auto hit = scene.first_hit(kinematics, Pose{}, &target, margin);
      if (hit) wanted = to_string(*hit);
    }
    CHECK((found ? to_string(*found) : "") == wanted);
    CHECK(asked == at);
    if (wanted.empty()) {
      ++clear;
    } else {
      ++hits;
      if (at > 1) ++later;
    }
  }
  CHECK(hits > 20);
  CHECK(later > 5);
  CHECK(clear > 20);
}
