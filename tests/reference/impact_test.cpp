#include <catch2/catch.hpp>

#include "reference/planar_robots.hpp"
#include "reference/random_state.hpp"

using namespace stillbase;
using namespace stillbase::reference_test;
using Eigen::VectorXd;

namespace {

using Wrench = Eigen::Matrix<double, 6, 1>;

Wrench force(const Vector3d& f) {
  Wrench w = Wrench::Zero();
  w.head<3>() = f;
  return w;
}

Vector3d planar_direction(double degrees) {
  return {std::cos(degrees * kDegree), std::sin(degrees * kDegree), 0};
}

VectorXd paper_posture() { return Eigen::Vector2d(-80 * kDegree, 160 * kDegree); }

// Elastic impact of a point mass of 100 kg (times scale) at 1 m/s along the direction.
reference::Impact elastic_impact(const reference::Dynamics& d, double degrees, double* p,
                                 double scale = 1) {
  const Vector3d n = planar_direction(degrees);
  const auto unit = reference::impact(d, {}, {}, force(n));
  *p = 2 / (unit.hand_inverse_mass + 1 / (100 * scale));
  return reference::impact(d, {}, {}, force(*p * n));
}

struct Row {
  double degrees, p, omega, base, coupling, total, norm, rns, orthogonal;
};

const Row kReadingA[] = {
    {0, 47.4735, 0.032249, 42.1310, -49.9230, -7.7920, 0.796878, 0.782901, 0.148598},
    {30, 67.9638, 0.073547, 96.0832, -44.4617, 51.6215, 0.863540, 0.853339, 0.132342},
    {90, 134.8706, 0.133212, 174.0302, 69.1923, 243.2224, 0.509127, 0.465611, 0.205954},
    {170, 45.8438, -0.022806, -29.7945, 51.5609, 21.7664, 0.787129, 0.772022, 0.153473}};
const Row kReadingB[] = {
    {0, 47.5784, 0.026242, 30.2437, -85.6314, -55.3876, 0.805704, 0.600864, 0.536769},
    {30, 67.8578, 0.069735, 80.3687, -87.5943, -7.2256, 0.891095, 0.701833, 0.549073},
    {90, 131.6236, 0.144786, 166.8647, 70.5022, 237.3669, 0.468807, 0.156442, 0.441934},
    {170, 45.9371, -0.016177, -18.6442, 85.6941, 67.0499, 0.791124, 0.580805, 0.537162}};

template <std::size_t size>
void check_table(double mount_y, const Row (&rows)[size]) {
  const RobotModel robot = planar_two_link(mount_y);
  const auto d = reference::compute(robot, {paper_posture(), {}, {}});
  for (const Row& row : rows) {
    double p = 0;
    const auto impact = elastic_impact(d, row.degrees, &p);
    CAPTURE(row.degrees);
    CHECK(p == Approx(row.p).epsilon(0).margin(6e-5));
    CHECK(impact.Delta_Omega(5) == Approx(row.omega).epsilon(0).margin(6e-7));
    CHECK(impact.base.z() == Approx(row.base).epsilon(0).margin(6e-5));
    CHECK(impact.coupling.z() == Approx(row.coupling).epsilon(0).margin(6e-5));
    CHECK(impact.total.z() == Approx(row.total).epsilon(0).margin(6e-5));
    CHECK(impact.Delta_phidot.norm() == Approx(row.norm).epsilon(0).margin(6e-7));
    const VectorXd along = d.Htilde_omegaphi.row(2).transpose().normalized();
    CHECK((impact.Delta_phidot - along * along.dot(impact.Delta_phidot)).norm() ==
          Approx(row.rns).epsilon(0).margin(6e-7));
    CHECK(std::abs(along.dot(impact.Delta_phidot)) ==
          Approx(row.orthogonal).epsilon(0).margin(6e-7));
  }
}

}  // namespace

TEST_CASE("the paper's planar example gives the printed values, reading A") {
  const auto d = reference::compute(planar_two_link(0), {paper_posture(), {}, {}});
  CHECK(d.hand_position.x() == Approx(2.094593).epsilon(0).margin(6e-7));
  CHECK(std::abs(d.hand_position.y()) <= 1e-14);
  CHECK(d.centroid.x() == Approx(0.291216).epsilon(0).margin(6e-7));
  CHECK(d.centroid.y() == Approx(-0.164135).epsilon(0).margin(6e-7));
  CHECK(d.Htilde_omega(2, 2) == Approx(1306.4125).epsilon(0).margin(6e-5));
  CHECK(d.Htilde_omegaphi(2, 0) == Approx(335.4101).epsilon(0).margin(6e-5));
  CHECK(d.Htilde_omegaphi(2, 1) == Approx(-19.2206).epsilon(0).margin(6e-5));
  check_table(0, kReadingA);
}

TEST_CASE("the paper's planar example gives the printed values, reading B") {
  const auto d = reference::compute(planar_two_link(1.2), {paper_posture(), {}, {}});
  CHECK(d.hand_position.x() == Approx(2.094593).epsilon(0).margin(6e-7));
  CHECK(d.hand_position.y() == Approx(1.2).epsilon(0).margin(1e-14));
  CHECK(d.centroid.x() == Approx(0.291216).epsilon(0).margin(6e-7));
  CHECK(d.centroid.y() == Approx(0.035865).epsilon(0).margin(6e-7));
  CHECK(d.Htilde_omega(2, 2) == Approx(1152.4894).epsilon(0).margin(6e-5));
  CHECK(d.Htilde_omegaphi(2, 0) == Approx(138.4485).epsilon(0).margin(6e-5));
  CHECK(d.Htilde_omegaphi(2, 1) == Approx(79.2602).epsilon(0).margin(6e-5));
  check_table(1.2, kReadingB);
}

TEST_CASE(
    "the directions without change of base, coupling or total momentum are the printed ones") {
  // Each momentum is linear in the impulse: its zero direction follows from two directions.
  auto zero = [](double x, double y) {
    double degrees = std::atan2(-x, y) / kDegree;
    while (degrees < 0) degrees += 180;
    while (degrees >= 180) degrees -= 180;
    return degrees;
  };
  const double printed[2][3] = {{145.48, 63.99, 5.20}, {153.37, 73.43, 32.84}};
  for (int reading = 0; reading < 2; ++reading) {
    const auto d =
        reference::compute(planar_two_link(reading == 0 ? 0 : 1.2), {paper_posture(), {}, {}});
    const auto x = reference::impact(d, {}, {}, force(Vector3d::UnitX()));
    const auto y = reference::impact(d, {}, {}, force(Vector3d::UnitY()));
    CHECK(zero(x.base.z(), y.base.z()) == Approx(printed[reading][0]).epsilon(0).margin(6e-3));
    CHECK(zero(x.coupling.z(), y.coupling.z()) ==
          Approx(printed[reading][1]).epsilon(0).margin(6e-3));
    CHECK(zero(x.total.z(), y.total.z()) == Approx(printed[reading][2]).epsilon(0).margin(6e-3));
  }
}

TEST_CASE("a straight arm hit along the line through both centroids moves like one mass") {
  struct Anchor {
    double mount_y, phi1, direction;
  };
  for (const Anchor a : {Anchor{0, 0, 0}, Anchor{1.2, 40.6013, 40.6013}}) {
    const VectorXd phi = Eigen::Vector2d(a.phi1 * kDegree, 0);
    const auto d = reference::compute(planar_two_link(a.mount_y), {phi, {}, {}});
    double p = 0;
    const auto impact = elastic_impact(d, a.direction, &p);
    CHECK(p == Approx(184.615385).epsilon(0).margin(1e-5));
    CHECK(impact.Delta_Omega.head<3>().norm() == Approx(0.153846).epsilon(0).margin(1e-6));
    CHECK(std::abs(impact.Delta_Omega(5)) <= 1e-6);
    CHECK(impact.Delta_phidot.norm() <= 1e-5);
  }
}

TEST_CASE("out-of-plane inertias and the unit of mass change nothing in the plane") {
  for (const double mount_y : {0.0, 1.2}) {
    const auto d = reference::compute(planar_two_link(mount_y), {paper_posture(), {}, {}});
    const auto thick =
        reference::compute(planar_two_link(mount_y, 1, 1.4), {paper_posture(), {}, {}});
    const auto heavy =
        reference::compute(planar_two_link(mount_y, 1.37), {paper_posture(), {}, {}});
    for (const double degrees : {0.0, 30.0, 90.0, 170.0}) {
      double p = 0, p_thick = 0, p_heavy = 0;
      const auto impact = elastic_impact(d, degrees, &p);
      const auto same = elastic_impact(thick, degrees, &p_thick);
      const auto scaled = elastic_impact(heavy, degrees, &p_heavy, 1.37);
      CHECK(p_thick == Approx(p).epsilon(1e-12));
      CHECK((same.Delta_phidot - impact.Delta_phidot).norm() <= 1e-12);
      CHECK(p_heavy == Approx(1.37 * p).epsilon(1e-12));
      CHECK((scaled.Delta_Omega - impact.Delta_Omega).norm() <= 1e-12);
      CHECK(scaled.coupling.z() == Approx(1.37 * impact.coupling.z()).epsilon(1e-12));
    }
  }
}

TEST_CASE("an impulse is the momentum that the robot gains, with any joint resistance") {
  Random random(21);
  for (int trial = 0; trial < 60; ++trial) {
    const int n = 1 + random.index(9);
    const RobotModel robot = random_robot(random, n, trial % 2 == 0);
    const reference::State state = random_state(random, n);
    const auto d = reference::compute(robot, {state.phi, {}, {}});
    Wrench Fbar;
    Fbar << random_vector(random, 10), random_vector(random, 3);
    VectorXd added = VectorXd::Zero(n);
    std::vector<bool> locked(static_cast<std::size_t>(n), false);
    if (trial % 3 == 1)
      for (int k = 0; k < n; ++k) added(k) = random.uniform(0, 5);
    if (trial % 3 == 2)
      for (int k = 0; k < n; ++k) locked[static_cast<std::size_t>(k)] = random.uniform() < 0.5;
    const auto impact = reference::impact(d, added, locked, Fbar);
    for (int k = 0; k < n; ++k)
      if (locked[static_cast<std::size_t>(k)]) CHECK(impact.Delta_phidot(k) == 0);

    // Momenta of the moving robot against those of the impulse.
    const auto after =
        reference::compute(robot, {state.phi, impact.Delta_phidot, impact.Delta_Omega});
    CHECK((after.P - Fbar.head<3>()).norm() <= 1e-10 * Fbar.norm());
    CHECK((after.L_g - impact.total).norm() <= 1e-10 * (1 + Fbar.norm()));
    CHECK((impact.base + impact.coupling - impact.total).norm() <= 1e-10 * (1 + Fbar.norm()));

    // Work: twice the energy gained is the impulse times the hand velocity gained.
    VectorXd x(6 + n);
    x << impact.Delta_Omega, impact.Delta_phidot;
    const double energy =
        x.dot(d.H * x) + impact.Delta_phidot.dot(added.cwiseProduct(impact.Delta_phidot));
    CHECK(energy == Approx(Fbar.dot(d.J * x)).epsilon(1e-10));
    const Vector3d f = Fbar.head<3>();
    const auto push = reference::impact(d, added, locked, force(f));
    VectorXd y(6 + n);
    y << push.Delta_Omega, push.Delta_phidot;
    CHECK(impact.hand_inverse_mass ==
          Approx(f.dot(VectorXd(d.J * y).head<3>()) / f.squaredNorm()).epsilon(1e-10));
  }
}

TEST_CASE("with all joints locked the robot is hit like one rigid body") {
  Random random(22);
  const RobotModel robot = random_robot(random, 5, false);
  const reference::State state = random_state(random, 5);
  const auto d = reference::compute(robot, {state.phi, {}, {}});
  const Vector3d f = random_vector(random, 10);
  const auto impact = reference::impact(d, {}, std::vector<bool>(5, true), force(f));
  const Vector3d r = d.hand_position - d.centroid;
  const Vector3d omega = d.Htilde_omega.inverse() * r.cross(f);
  CHECK((impact.Delta_Omega.tail<3>() - omega).norm() <= 1e-12 * omega.norm());
  const Vector3d v = f / d.mass - omega.cross(d.centroid);
  CHECK((impact.Delta_Omega.head<3>() - v).norm() <= 1e-12 * v.norm());
}
