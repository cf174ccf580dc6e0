#include <catch2/catch.hpp>

#include "core/covariance.hpp"

using namespace stillbase;

namespace {

std::string objection_to(const Eigen::MatrixXd& A) {
  const auto objection = covariance_objection(A);
  return objection ? std::to_string(objection->row) + objection->text : "";
}

}  // namespace

TEST_CASE("the check without memory agrees with the one in words") {
  std::srand(7);
  int good = 0, indefinite = 0;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Matrix4d half = Eigen::Matrix4d::Random();
    Eigen::Matrix4d A = half * half.transpose();
    if (i % 2 == 0) A += (i % 3 == 0 ? 1.0 : 1e-9) * Eigen::Matrix4d::Random();
    if (i % 5 == 0) A.row(1).setZero(), A.col(1).setZero();
    CHECK(is_covariance(A) == (objection_to(A) == ""));
    good += is_covariance(A) ? 1 : 0;
    // Each correlation is below 1, which does not make them those of variables.
    Eigen::Matrix4d C = 0.9 * (half + half.transpose()) / 2;
    C.diagonal().setOnes();
    CHECK(is_covariance(C) == (objection_to(C) == ""));
    indefinite += is_covariance(C) ? 0 : 1;
  }
  CHECK(indefinite > 20);
  CHECK(indefinite < 180);
  CHECK(good > 50);
  CHECK(good < 150);
  CHECK_FALSE(is_covariance<2>(Eigen::Matrix2d::Constant(std::nan(""))));
}

TEST_CASE("a covariance is symmetric and positive semidefinite in any units") {
  using Catch::Contains;
  Eigen::Matrix3d A;
  A << 4, 1, 0, 1, 1, 0.5, 0, 0.5, 2;
  CHECK(objection_to(A) == "");
  CHECK(objection_to(Eigen::Matrix3d::Zero()) == "");
  CHECK(objection_to(Eigen::Matrix3d::Ones()) == "");
  // Metres beside small rates: an eigenvalue says little where its rows have other units.
  for (const double unit : {1.0, 1e-3, 1e-6}) {
    const Eigen::Vector3d units(1, unit, unit);
    const auto changed = [&](int i, int j, double x) {
      Eigen::Matrix3d B = A;
      B(i, j) = x;
      return objection_to(units.asDiagonal() * B * units.asDiagonal());
    };
    CAPTURE(unit);
    CHECK_THAT(changed(2, 2, -1), Contains("2[2][2]: is ") && Contains("is not negative"));
    CHECK_THAT(changed(2, 1, 0.6), Contains("2[2][1]: is ") && Contains("is symmetric"));
    A(1, 2) = A(2, 1) = 1.5;
    CHECK_THAT(changed(0, 0, 4), Contains("2[2][1]: is ") && Contains("must be at most"));
    A(1, 2) = A(2, 1) = 1.4;
    CHECK_THAT(changed(0, 0, 4), Contains("0: is not positive semidefinite"));
    A(1, 2) = A(2, 1) = 0.5;
    CHECK(changed(0, 0, 4) == "");
  }
}
