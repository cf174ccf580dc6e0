// Propositions 1 and 2 and Corollaries 1 and 2 of the paper, on random robots and on those with a
// coupling matrix that lacks rank. Momenta come from the reference dynamics.
#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include <stillbase/core/file.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/dynamics/reaction_null_space.hpp>
#include <stillbase/impact/indices.hpp>
#include <stillbase/impact/summary.hpp>
#include <stillbase/reference/reference.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include "support/dense.hpp"
#include "support/random_robot.hpp"

namespace stillbase {
namespace {

using Eigen::VectorXd;

struct Posture {
  RobotModel robot;
  JointVectord phi;
  int rank = 0;  // of Htilde_omegaphi, known beforehand
};

RobotModel shipped_robot(const std::string& name) {
  const std::string path = std::string(STILLBASE_SOURCE_DIR) + "/problems/robots/" + name + ".urdf";
  return read_urdf(read_text_file(path), path, "");
}

/// Planar robots (rank 1), the arm of rank 2 and chains of full rank, at random postures.
std::vector<Posture> postures(Random& random) {
  std::vector<Posture> list;
  const auto add = [&](const RobotModel& robot, int rank) {
    JointVectord phi(robot.n());
    for (int k = 0; k < robot.n(); ++k) phi[k] = random.uniform(-2, 2);
    list.push_back({robot, phi, rank});
  };
  for (int i = 0; i < 10; ++i) {
    add(shipped_robot("planar_two_link_a"), 1);
    add(random_planar_robot(random, 3), 1);
    add(shipped_robot("spart_sc_3dof"), 2);
    add(shipped_robot("iiwa_on_cube"), 3);
  }
  return list;
}

JointVectord random_rates(Random& random, int n) {
  JointVectord rates(n);
  for (int k = 0; k < n; ++k) rates[k] = random.normal();
  return rates;
}

ReactionNullSpace null_space(const Posture& p) {
  const auto inertia = compute_inertia(p.robot, compute_kinematics<double>(p.robot, p.phi));
  return angular_reaction_null_space(compute_tilde_inertia(inertia));
}

/// Base velocity of a robot with zero momentum.
Vector6d base_velocity(const reference::Dynamics& d, const VectorXd& phidot) {
  const auto n = phidot.size();
  return test::solve(d.H.topLeftCorner(6, 6), -d.H.topRightCorner(6, n) * phidot);
}

}  // namespace

TEST_CASE("Proposition 1: the null-space part of the joint velocity carries no angular momentum") {
  Random random(701);
  for (const Posture& p : postures(random)) {
    INFO(p.robot.name);
    const int n = p.robot.n();
    const ReactionNullSpace space = null_space(p);
    CHECK(space.rank == p.rank);
    CHECK(space.rank_tolerance == kRankTolerance);
    const JointVectord phidot = random_rates(random, n);
    const auto parts = decompose_joint_velocity(space, phidot);
    Vector6d Omega;
    for (int i = 0; i < 6; ++i) Omega[i] = random.normal();
    const auto with = reference::compute(p.robot, {p.phi, phidot, Omega});
    const auto without = reference::compute(p.robot, {p.phi, parts.orthogonal, Omega});
    const double scale = with.Htilde_omega.norm() * Omega.norm();
    CHECK((with.L_g - without.L_g).norm() <= 1e-11 * scale);
    // The part exists: n - rank dimensions of it.
    CHECK(std::abs(space.P_RNS.trace() - (n - p.rank)) <= 1e-10);
    if (n > p.rank) CHECK(parts.rns.norm() > 1e-6);
    // (10): orthogonal parts.
    CHECK(std::abs(parts.rns.dot(parts.orthogonal)) <= 1e-12 * phidot.squaredNorm());
  }
}

TEST_CASE("Corollary 1: the orthogonal part alone makes the coupling momentum, with least rates") {
  Random random(702);
  for (const Posture& p : postures(random)) {
    const int n = p.robot.n();
    const auto d = reference::compute(p.robot, {p.phi, {}, {}});
    const ReactionNullSpace space = null_space(p);
    const JointVectord phidot = random_rates(random, n);
    const auto parts = decompose_joint_velocity(space, phidot);
    const Vector3d coupling = d.Htilde_omegaphi * VectorXd(phidot);
    CHECK((d.Htilde_omegaphi * VectorXd(parts.orthogonal) - coupling).norm() <=
          1e-11 * d.Htilde_omegaphi.norm() * phidot.norm());
    CHECK(parts.orthogonal.norm() <= phidot.norm() * (1 + 1e-14));
    // Least of all rates with this momentum, and unique: it is the pseudoinverse's.
    CHECK((parts.orthogonal - JointVectord(space.A_pinv * coupling)).norm() <=
          1e-9 * phidot.norm());
  }
}

TEST_CASE("Proposition 2: at zero momentum the base keeps its attitude for null-space rates only") {
  Random random(703);
  for (const Posture& p : postures(random)) {
    INFO(p.robot.name);
    const auto d = reference::compute(p.robot, {p.phi, {}, {}});
    const ReactionNullSpace space = null_space(p);
    const JointVectord phidot = random_rates(random, p.robot.n());
    const auto parts = decompose_joint_velocity(space, phidot);
    const double scale = base_velocity(d, phidot).norm() + 1e-3 * phidot.norm();
    // If: no turning.
    CHECK(base_velocity(d, parts.rns).tail<3>().norm() <= 1e-11 * scale);
    // Only if: the base turns at least as much as the smallest nonzero singular value says.
    const Vector3d omega = base_velocity(d, phidot).tail<3>();
    const double least = space.singular_values[space.rank - 1] * parts.orthogonal.norm();
    CHECK(least > 0);
    CHECK((d.Htilde_omega * omega).norm() >= least * (1 - 1e-9));
  }
}

TEST_CASE("Proposition 2 after an impact: stopping the joints turns the base unless (17) holds") {
  // Momentum is conserved when the joints are stopped at once, so the base then has all of it:
  // its rate changes by Htilde_omega^-1 times the coupling part.
  Random random(704);
  int disturbed = 0, undisturbed = 0;
  for (const Posture& p : postures(random)) {
    const auto posture =
        evaluate_posture<double>(p.robot, prepare_resistance({}, p.robot.n()), p.phi);
    const auto zero = case_directions(posture, all_directions());
    std::vector<Vector3d> forces = {random.unit_vector()};
    if (zero.coupling.directions.cols() > 0) forces.push_back(zero.coupling.directions.col(0));
    for (const Vector3d& f : forces) {
      Vector6d Fbar = Vector6d::Zero();
      Fbar.head<3>() = f;
      const ImpactSummary impact = summarize_impact(p.robot, p.phi, {}, Fbar, 0);
      const auto after =
          reference::compute(p.robot, {p.phi, impact.Delta_phidot, impact.Delta_Omega});
      const Vector3d stopped = after.Htilde_omega.inverse() * after.L_g;
      const double change = (after.Htilde_omega * (stopped - impact.Delta_Omega.tail<3>())).norm();
      const double scale = (after.hand_position - after.centroid).norm();
      const bool in_null_space =
          impact.Delta_phidot_orthogonal.norm() <= 1e-8 * impact.Delta_phidot.norm();
      CHECK((change <= 1e-8 * scale) == in_null_space);
      ++(in_null_space ? undisturbed : disturbed);
    }
  }
  CHECK(disturbed >= 40);
  CHECK(undisturbed >= 20);
}

TEST_CASE("Corollary 2: condition (17) is met in the cases G3 and C2 and in no other") {
  struct Expected {
    const char* robot;
    double first, second;  // deg
    ImpactCase impact_case;
    bool meets;
  };
  for (const Expected& e : {Expected{"planar_two_link_a", -80, 160, ImpactCase::G2, false},
                            Expected{"planar_two_link_a", -80, 160, ImpactCase::G3, true},
                            Expected{"planar_two_link_a", -80, 160, ImpactCase::C1, false},
                            Expected{"planar_two_link_a", 0, 0, ImpactCase::C2, true},
                            Expected{"planar_two_link_b", -80, 160, ImpactCase::G2, false},
                            Expected{"planar_two_link_b", -80, 160, ImpactCase::G3, true},
                            Expected{"planar_two_link_b", -80, 160, ImpactCase::C1, false}}) {
    INFO(e.robot << " " << to_string(e.impact_case));
    const RobotModel robot = shipped_robot(e.robot);
    JointVectord phi(2);
    phi << e.first * M_PI / 180, e.second * M_PI / 180;
    const auto posture = evaluate_posture<double>(robot, prepare_resistance({}, 2), phi);
    const auto zero = case_directions(posture, directions_in_xy_plane());
    const ZeroDirections& of = e.impact_case == ImpactCase::G2   ? zero.base
                               : e.impact_case == ImpactCase::G3 ? zero.coupling
                               : e.impact_case == ImpactCase::C1 ? zero.total
                                                                 : zero.all;
    REQUIRE(of.directions.cols() == 1);
    Vector6d Fbar = Vector6d::Zero();
    Fbar.head<3>() = 50 * of.directions.col(0);
    const ImpactSummary impact = summarize_impact(robot, phi, {}, Fbar, 0);
    CHECK(impact.judgement.impact_case == e.impact_case);
    CHECK((impact.Delta_phidot_orthogonal.norm() <= 1e-9) == e.meets);
  }
  // And G1, anywhere else.
  const RobotModel robot = shipped_robot("planar_two_link_a");
  JointVectord phi(2);
  phi << -80 * M_PI / 180, 160 * M_PI / 180;
  Vector6d Fbar = Vector6d::Zero();
  Fbar[1] = 50;
  const ImpactSummary impact = summarize_impact(robot, phi, {}, Fbar, 0);
  CHECK(impact.judgement.impact_case == ImpactCase::G1);
  CHECK(impact.Delta_phidot_orthogonal.norm() > 1e-3);
}

}  // namespace stillbase
