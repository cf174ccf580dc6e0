#include <catch2/catch.hpp>

#include <limits>

#include "support/random_robot.hpp"

using namespace stillbase;

TEST_CASE("constant axes are permuted when each is one of the other frame's, exactly") {
  Random random(8);
  ConstantAxes axes;
  CHECK(axes.matrix() == Matrix3d::Identity());
  CHECK(axes.are_permuted());
  for (int i = 0; i < 3; ++i) {
    for (const int j : {(i + 1) % 3, (i + 2) % 3}) {
      for (int signs = 0; signs < 4; ++signs) {
        Matrix3d R;
        R.col(0) = Vector3d::Unit(i) * (signs % 2 == 0 ? 1 : -1);
        R.col(1) = Vector3d::Unit(j) * (signs / 2 == 0 ? 1 : -1);
        R.col(2) = R.col(0).cross(R.col(1));
        axes = R;
        CHECK(axes.matrix() == R);
        REQUIRE(axes.are_permuted());
        CHECK(axes.row(0) == i);
        CHECK(axes.row(1) == j);
        CHECK(axes.row(2) == 3 - i - j);
        const Eigen::Index at = random.index(9);
        for (const double off : {1e-300, 1e-9, std::numeric_limits<double>::quiet_NaN()}) {
          Matrix3d other = R;
          double& entry = other.reshaped()[at];
          if (entry != 0) continue;
          entry = off;
          axes = other;
          CHECK(!axes.are_permuted());
        }
      }
    }
  }
  axes = random_rotation(random);
  CHECK(!axes.are_permuted());
  axes = Matrix3d::Identity();
  CHECK(axes.are_permuted());
}
