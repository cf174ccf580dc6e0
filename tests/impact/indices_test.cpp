// The indices of a posture against what impacts at that posture do.
#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include <stillbase/core/file.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/impact/contact.hpp>
#include <stillbase/impact/contact_impulse.hpp>
#include <stillbase/impact/indices.hpp>
#include <stillbase/impact/summary.hpp>
#include <stillbase/reference/reference.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include "support/dense.hpp"
#include "support/random_robot.hpp"

namespace stillbase {
namespace {

RobotModel shipped_robot(const std::string& name) {
  const std::string path = std::string(STILLBASE_SOURCE_DIR) + "/problems/robots/" + name + ".urdf";
  return read_urdf(read_text_file(path), path, "");
}

JointVectord degrees(std::initializer_list<double> values) {
  JointVectord phi(static_cast<Eigen::Index>(values.size()));
  Eigen::Index k = 0;
  for (const double value : values) phi[k++] = value * M_PI / 180;
  return phi;
}

PostureImpact<double> at(const RobotModel& robot, const JointVectord& phi) {
  return evaluate_posture<double>(robot, prepare_resistance({}, robot.n()), phi);
}

Vector6d unit_force(const Vector3d& f) {
  Vector6d F = Vector6d::Zero();
  F.head<3>() = f;
  return F;
}

/// Direction in the plane, in [0, 180) deg.
double angle(const Vector3d& direction) {
  const double a = std::atan2(direction.y(), direction.x()) * 180 / M_PI;
  return a < 0 ? a + 180 : (a >= 180 ? a - 180 : a);
}

struct Posture {
  RobotModel robot;
  JointVectord phi;
};

Posture random_posture(Random& random, int n) {
  Posture p{random_robot(random, n, random.uniform() < 0.5), JointVectord(n)};
  for (int k = 0; k < n; ++k) p.phi[k] = random.uniform(-2, 2);
  return p;
}

}  // namespace

TEST_CASE(
    "a straight arm with an impulse along its line shows its whole mass, and closes to the anchor "
    "impulse") {
  const auto posture = at(shipped_robot("planar_two_link_a"), degrees({0, 0}));
  const Matrix6d W = extended_inverse_inertia(posture.factor, posture.jacobian);
  CHECK(std::abs(effective_mass(W, Vector3d::UnitX()) - 1200) < 1e-9);
  CHECK(std::abs(impulse_index(W, Vector3d::UnitX(), 1, 1.0 / 100) - 184.615385) < 0.5e-6);
}

TEST_CASE(
    "impulse index times approach speed is the impulse; effective mass that of a wall at e = 0") {
  Random random(601);
  for (int trial = 0; trial < 50; ++trial) {
    const Posture p = random_posture(random, 1 + trial % 8);
    const auto posture = at(p.robot, p.phi);
    const Matrix6d W = extended_inverse_inertia(posture.factor, posture.jacobian);
    const Vector3d n = random.unit_vector();
    const double w = respond<double>(posture, unit_force(n)).hand_inverse_mass;
    const double index = impulse_index(W, n, 0.3, 0.02);
    CHECK(std::abs(2 * index - normal_impulse(0.3, 2, w, 0.02)) <= 1e-11 * index);
    CHECK(std::abs(effective_mass(W, n) - impulse_index(W, n, 0, 0)) <= 1e-11 * index);
    CHECK(effective_mass(W, n) <= p.robot.total_mass() * (1 + 1e-12));
  }
}

TEST_CASE("impulses that stop unit relative velocities lie on the impulse ellipsoid") {
  Random random(602);
  for (int trial = 0; trial < 50; ++trial) {
    const Posture p = random_posture(random, 2 + trial % 7);
    const auto posture = at(p.robot, p.phi);
    const Matrix6d W = extended_inverse_inertia(posture.factor, posture.jacobian);
    ContactTarget target;
    target.mass = 40;
    target.inertia = random_inertia(random, 40, 1);
    target.r = random_vector(random, 0.2, 1);
    const Ellipsoid ellipsoid = impulse_ellipsoid(W, target_inverse_inertia3(target));
    CHECK((ellipsoid.axes.transpose() * ellipsoid.axes - Matrix3d::Identity()).norm() < 1e-12);
    CHECK(ellipsoid.lengths[0] >= ellipsoid.lengths[1]);
    CHECK(ellipsoid.lengths[1] >= ellipsoid.lengths[2]);
    Contact sticking;
    sticking.law = ContactLaw::Sticking;
    for (int i = 0; i < 20; ++i) {
      target.velocity = random.unit_vector();
      sticking.n = target.velocity;
      const auto hit = contact_impulse(sticking, W, Vector6d::Zero(), target);
      REQUIRE(hit.status == ContactStatus::Hit);
      const Vector3d f = ellipsoid.axes.transpose() * hit.Fbar.head<3>();
      CHECK(std::abs(f.cwiseQuotient(ellipsoid.lengths).norm() - 1) < 1e-10);
    }
  }
}

TEST_CASE(
    "base rates of unit impulses fill the base-reaction ellipsoid, its axes have their causes") {
  Random random(603);
  for (int trial = 0; trial < 50; ++trial) {
    const Posture p = random_posture(random, 1 + trial % 8);
    const auto posture = at(p.robot, p.phi);
    const auto reaction = base_reaction_ellipsoid(posture);
    CHECK(reaction.rank == 3);
    const auto d = reference::compute(p.robot, {p.phi, {}, {}});
    const auto rate = [&](const Vector3d& f) -> Vector3d {
      return reference::impact(d, Eigen::VectorXd::Zero(p.robot.n()), {}, unit_force(f))
          .Delta_Omega.tail<3>();
    };
    for (int i = 0; i < 3; ++i) {
      const Vector3d expected = reaction.ellipsoid.axes.col(i) * reaction.ellipsoid.lengths[i];
      CHECK((rate(reaction.causes.col(i)) - expected).norm() <=
            1e-11 * reaction.ellipsoid.lengths[0]);
    }
    for (int i = 0; i < 20; ++i) {
      const double norm = rate(random.unit_vector()).norm();
      CHECK(norm <= reaction.ellipsoid.lengths[0] * (1 + 1e-11));
      CHECK(norm >= reaction.ellipsoid.lengths[2] * (1 - 1e-9));
    }
  }
}

TEST_CASE("a planar robot cannot rotate its base in more than two ways by a push at the hand") {
  const auto posture = at(shipped_robot("planar_two_link_a"), degrees({-80, 160}));
  CHECK(base_reaction_ellipsoid(posture).rank == 2);
}

TEST_CASE("no direction disturbs the base less than the favourable one, in space and in a plane") {
  Random random(604);
  for (int trial = 0; trial < 50; ++trial) {
    const Posture p = random_posture(random, 1 + trial % 8);
    const auto posture = at(p.robot, p.phi);
    for (const Directions& allowed : {all_directions(), directions_in_xy_plane()}) {
      const auto best = favourable_directions(posture, allowed);
      const auto m = allowed.cols();
      const Matrix3d projector = allowed * allowed.transpose();
      REQUIRE(best.directions.cols() == m);
      const auto reaction = [&](const Vector3d& f) {
        return respond<double>(posture, unit_force(f)).omega().norm();
      };
      for (Eigen::Index i = 0; i < m; ++i) {
        const Vector3d direction = best.directions.col(i);
        CHECK(std::abs(direction.norm() - 1) < 1e-12);
        CHECK((direction - projector * direction).norm() < 1e-12);
        CHECK(std::abs(reaction(direction) - best.base_reaction[i]) <=
              1e-10 * best.base_reaction[m - 1]);
      }
      for (int i = 0; i < 100; ++i) {
        Vector3d f = projector * random.unit_vector();
        f.normalize();
        CHECK(reaction(f) >= best.base_reaction[0] * (1 - 1e-9));
      }
    }
  }
}

TEST_CASE("the planar example has its zero directions where the tables say") {
  struct Row {
    const char* robot;
    double base, coupling, total;
  };
  for (const Row& row : {Row{"planar_two_link_a", 145.48, 63.99, 5.20},
                         Row{"planar_two_link_b", 153.37, 73.43, 32.84}}) {
    const RobotModel robot = shipped_robot(row.robot);
    const auto posture = at(robot, degrees({-80, 160}));
    const auto zero = case_directions(posture, directions_in_xy_plane());
    INFO(row.robot);
    REQUIRE(zero.base.directions.cols() == 1);
    REQUIRE(zero.coupling.directions.cols() == 1);
    REQUIRE(zero.total.directions.cols() == 1);
    CHECK(zero.base.rank == 1);
    CHECK(zero.all.directions.cols() == 0);
    CHECK(std::abs(angle(zero.base.directions.col(0)) - row.base) < 0.005);
    CHECK(std::abs(angle(zero.coupling.directions.col(0)) - row.coupling) < 0.005);
    CHECK(std::abs(angle(zero.total.directions.col(0)) - row.total) < 0.005);
    // Without the plane: the same zeros, the out-of-plane push adds none.
    CHECK(case_directions(posture, all_directions()).base.directions.cols() == 1);
    // The favourable direction is the zero of the base part.
    const auto best = favourable_directions(posture, directions_in_xy_plane());
    CHECK(best.base_reaction[0] <= 1e-12 * best.base_reaction[1]);
    CHECK(std::abs(angle(best.directions.col(0)) - row.base) < 0.005);

    const auto judged = [&](const ZeroDirections& directions) {
      return summarize_impact(robot, degrees({-80, 160}), {},
                              unit_force(directions.directions.col(0)), 0)
          .judgement.impact_case;
    };
    CHECK(judged(zero.base) == ImpactCase::G2);
    CHECK(judged(zero.coupling) == ImpactCase::G3);
    CHECK(judged(zero.total) == ImpactCase::C1);
  }
}

TEST_CASE("along a straight arm all three momenta have their zero: case C2") {
  const auto zero = case_directions(at(shipped_robot("planar_two_link_a"), degrees({0, 0})),
                                    directions_in_xy_plane());
  REQUIRE(zero.all.directions.cols() == 1);
  const double off = angle(zero.all.directions.col(0));
  CHECK(std::min(off, 180 - off) < 1e-6);
}

TEST_CASE(
    "in space the total vanishes along r_gh only, and a lost coupling direction gives zeros") {
  Random random(605);
  for (int trial = 0; trial < 50; ++trial) {
    const Posture p = random_posture(random, 5 + trial % 4);
    const auto posture = at(p.robot, p.phi);
    const auto maps = momentum_maps(posture);
    CHECK((maps.base + maps.coupling - maps.total).norm() <= 1e-11 * maps.total.norm());
    const auto zero = case_directions(posture, all_directions());
    REQUIRE(zero.total.directions.cols() == 1);
    const Vector3d r_gh = posture.kinematics.r_bh - posture.inertia.r_bg;
    CHECK(zero.total.directions.col(0).cross(r_gh).norm() <= 1e-12 * r_gh.norm());
    CHECK(zero.base.directions.cols() == 0);
    CHECK(zero.base.rank == 3);
  }
  // Rank 2 in every posture: some impulse leaves no momentum in the arm.
  const RobotModel spart = shipped_robot("spart_sc_3dof");
  const auto zero = case_directions(at(spart, degrees({20, -50, 70})), all_directions());
  CHECK(zero.coupling.rank == 2);
  REQUIRE(zero.coupling.directions.cols() == 1);
  const auto impact = summarize_impact(spart, degrees({20, -50, 70}), {},
                                       unit_force(zero.coupling.directions.col(0)), 0);
  CHECK(impact.judgement.coupling <= 1e-10);
}

TEST_CASE("locked joints leave no coupling: every direction is a zero of it") {
  Random random(606);
  const Posture p = random_posture(random, 4);
  JointResistance locked;
  locked.model = ResistanceModel::Locked;
  locked.locked.assign(4, true);
  const auto posture = evaluate_posture<double>(p.robot, prepare_resistance(locked, 4), p.phi);
  CHECK(case_directions(posture, all_directions()).coupling.directions.cols() == 3);
}

TEST_CASE("generalized Jacobian and coupling measures bound what joint rates do at zero momentum") {
  Random random(607);
  for (int trial = 0; trial < 50; ++trial) {
    const int n = 1 + trial % 8;
    const Posture p = random_posture(random, n);
    const auto posture = at(p.robot, p.phi);
    const auto jacobian = generalized_jacobian_indices(posture);
    const auto coupling = dynamic_coupling(posture);
    CHECK(jacobian.all.size() == std::min(n, 6));
    CHECK(jacobian.linear.size() == std::min(n, 3));
    CHECK((jacobian.linear_manipulability > 0) == (n >= 3));

    const auto d = reference::compute(p.robot, {p.phi, {}, {}});
    const Eigen::MatrixXd X = -test::solve(d.H.topLeftCorner(6, 6), d.H.topRightCorner(6, n));
    const Eigen::MatrixXd Jhat = d.J.rightCols(n) + d.J.leftCols(6) * X;
    // Sums of squares of singular values are squared Frobenius norms.
    CHECK(std::abs(jacobian.all.norm() - Jhat.norm()) <= 1e-11 * Jhat.norm());
    CHECK(std::abs(jacobian.angular.norm() - Jhat.bottomRows(3).norm()) <= 1e-11 * Jhat.norm());
    CHECK(std::abs(coupling.rotation_per_rate.norm() - X.bottomRows(3).norm()) <= 1e-11 * X.norm());
    CHECK(std::abs(coupling.translation_per_rate.norm() - X.topRows(3).norm()) <= 1e-11 * X.norm());
    if (n >= 3) {
      const Eigen::MatrixXd Jv = Jhat.topRows(3);
      CHECK(std::abs(jacobian.linear_manipulability -
                     std::sqrt(test::determinant(Jv * Jv.transpose()))) <=
            1e-8 * std::pow(Jv.norm(), 3));
      CHECK(coupling.hand_rank == 3);
    }
    for (int i = 0; i < 20; ++i) {
      JointVectord rates(n);
      for (int k = 0; k < n; ++k) rates[k] = random.normal();
      rates.normalize();
      CHECK((X.bottomRows(3) * rates).norm() <= coupling.rotation_per_rate[0] * (1 + 1e-11));
      // The least joint rates for their hand velocity: those in the row space.
      const Eigen::MatrixXd Jv = Jhat.topRows(3);
      const Eigen::VectorXd least = test::least_squares(Jv, Jv * rates);
      CHECK((X.bottomRows(3) * least).norm() <=
            coupling.rotation_per_hand[0] * (Jv * least).norm() * (1 + 1e-8));
    }
  }
}

}  // namespace stillbase
