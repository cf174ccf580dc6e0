// Articulated bodies over boxes against those of the dynamics at their points.
#include <catch2/catch.hpp>

#include <cmath>
#include <optional>

#include <stillbase/core/random.hpp>
#include <stillbase/dynamics/articulated_body.hpp>
#include <stillbase/dynamics/inertia.hpp>

#include "dynamics/kinematics_kernel.hpp"
#include "proof/articulated_forms.hpp"
#include "proof/taylor.hpp"
#include "support/random_robot.hpp"

namespace stillbase::proof {
namespace {

using S = Form<2>;

struct Case {
  RobotModel robot;
  JointVectord phi, added;
  std::vector<bool> locked;
};

/// Chains and trees with prismatic joints among the others.
Case random_case(int trial) {
  Random random(91, static_cast<std::uint64_t>(trial));
  const int n = 1 + random.index(6);
  Case out;
  out.robot = random_robot(random, n, trial % 3 != 0);
  out.phi.resize(n);
  out.added = JointVectord::Zero(n);
  for (int k = 0; k < n; ++k) {
    out.phi[k] = random.uniform(-2, 2);
    if (trial % 2 == 1) out.added[k] = random.uniform(0, 2);
    if (trial % 5 >= 3) out.locked.push_back(random.uniform() < 0.4);
  }
  return out;
}

/// At a point of the box, eps in [-1, 1]^2.
double at(const S& form, const std::array<double, 2>& eps) {
  double sum = 0;
  for (std::size_t k = 0; k < form.coefficient.size(); ++k) {
    const auto& powers = S::Terms::kPowers[k];
    sum += form.coefficient[k] * std::pow(eps[0], powers[0]) * std::pow(eps[1], powers[1]);
  }
  return sum;
}

}  // namespace

TEST_CASE("articulated and composite inertias over a box hold those at its points") {
  int close = 0, compared = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Case problem = random_case(trial);
    const RobotModel& robot = problem.robot;
    const int n = robot.n();
    const double half = trial % 2 == 0 ? 0.02 : 0.1;
    std::optional<ArticulatedForms<S>> forms;
    {
      const RoundUpward upward;
      JointVector<S> phi = problem.phi.cast<S>();
      for (int i = 0; i < std::min(n, 2); ++i) {
        phi[i] = S(Interval(problem.phi[i] - half, problem.phi[i] + half), i);
      }
      forms.emplace(robot, phi, problem.added, problem.locked, true);
    }
    Random random(5, static_cast<std::uint64_t>(trial));
    for (int point = 0; point < 4; ++point) {
      const std::array<double, 2> eps{random.uniform(-1, 1), random.uniform(-1, 1)};
      JointVectord phi = problem.phi;
      for (int i = 0; i < std::min(n, 2); ++i) phi[i] += half * eps[static_cast<std::size_t>(i)];
      const Kinematics<double> kin = compute_kinematics<double>(robot, phi);
      const auto bodies = factorize_articulated_bodies(robot, kin, problem.added, problem.locked);
      const auto inertia = compute_inertia<double>(robot, kin);
      const auto compare = [&](const S& form, double exact) {
        ++compared;
        if (!form.is_bounded()) return;
        const double off = std::abs(at(form, eps) - exact);
        if (!(off <= form.r + 1e-12 * (1 + std::abs(exact)))) {
          FAIL("trial " << trial << ": off by " << off << ", said " << form.r);
        }
        if (form.r < 0.01 * (1 + std::abs(exact))) ++close;
      };
      for (int k = 0; k < n; ++k) {
        CHECK(forms->moves[k] == (bodies.inverse_D[k] > 0));
        if (forms->moves[k]) compare(forms->inverse_D[k], bodies.inverse_D[k]);
      }
      for (int j = 0; j < 6; ++j) {
        for (int i = 0; i < 6; ++i) {
          compare(forms->composite.column(j)[i], inertia.H_b(i, j));
        }
      }
      // Twists that the base takes from a wrench on it: the factor's own layout is left out.
      Vector6d b = Vector6d::Zero();
      for (int i = 0; i < 6; ++i) b[i] = random.uniform(-1, 1);
      const auto motion =
          solve_articulated_bodies(robot, bodies, b, JointVectord(JointVectord::Zero(n)));
      const RoundUpward upward;
      for (int i = 0; i < 6; ++i) {
        S momentum(0.0);
        for (int j = 0; j < 6; ++j)
          momentum += forms->articulated.column(j)[i] * S(motion.Omega[j]);
        compare(momentum, b[i]);
      }
      for (int i = 0; i < 3; ++i) {
        compare(forms->hand_position()[i], kin.r_bh[i]);
        for (int j = 0; j < 3; ++j) compare(forms->hand_axes()(i, j), kin.R_hand(i, j));
      }
    }
  }
  CHECK(close > compared / 2);
}

}  // namespace stillbase::proof
