#include <catch2/catch.hpp>

#include <stillbase/robot/physical_checks.hpp>

#include "support/random_robot.hpp"

using namespace stillbase;

TEST_CASE("random robots are physically possible and in depth-first order") {
  Random random(1);
  int prismatic = 0, branches = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const bool tree = trial % 2 == 0;
    const RobotModel robot = random_robot(random, 2 + random.index(11), tree);
    CHECK(inertia_fault(robot.base.inertia).empty());
    for (int k = 0; k < robot.n(); ++k) {
      CHECK(inertia_fault(robot.bodies[k].inertia).empty());
      CHECK(mass_fault(robot.bodies[k].mass).empty());
      prismatic += robot.joints[k].is_prismatic();
      branches += robot.joints[k].parent != k - 1;
      if (!tree) CHECK(robot.joints[k].parent == k - 1);
      // Depth-first: the parent is the joint before or one of its ancestors.
      int ancestor = k - 1;
      while (ancestor != robot.joints[k].parent) {
        REQUIRE(ancestor != kBase);
        ancestor = robot.joints[ancestor].parent;
      }
    }
    CHECK(leaf_links(robot).size() >= 1);
    CHECK(robot.hand == "hand");
    CHECK(robot.moves_hand[robot.hand_body]);
  }
  CHECK(prismatic > 50);
  CHECK(branches > 50);
}

TEST_CASE("random planar robots stay in their plane") {
  Random random(2);
  for (int trial = 0; trial < 50; ++trial) {
    const RobotModel robot = random_planar_robot(random, 1 + random.index(5));
    CHECK(robot.p_hand.z() == 0);
    for (int k = 0; k < robot.n(); ++k) {
      CHECK(robot.joints[k].R.matrix().col(2) == Vector3d::UnitZ());
      CHECK(robot.joints[k].p.z() == 0);
      CHECK(robot.bodies[k].centroid.z() == 0);
      CHECK(inertia_fault(robot.bodies[k].inertia).empty());
    }
  }
}
