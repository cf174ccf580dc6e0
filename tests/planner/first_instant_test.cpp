// What a plan says of its impact is how the simulation begins, whatever the contact.
#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>

#include <stillbase/encounter/encounter.hpp>
#include <stillbase/planner/post_impact.hpp>
#include <stillbase/search/search.hpp>

#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

/// Contacts that the problem's target allows.
std::vector<ContactLaw> contacts_of(const CaptureProblem& problem) {
  if (problem.hand_motion.moves()) return {problem.impulse.contact};
  std::vector<ContactLaw> out = {ContactLaw::Frictionless};
  if (problem.impulse.source != ImpulseSource::Given) out.push_back(ContactLaw::Sticking);
  if (problem.impulse.source == ImpulseSource::RigidBody) out.push_back(ContactLaw::Latch);
  return out;
}

double first_instant_error(const CaptureProblem& problem, const Configuration& at,
                           const ImpactSummary& impact) {
  const AfterContact run = simulate_post_impact(problem, at, impact, "none", {});
  const TraceSample& first = run.simulation.trace.front();
  // Sizes of what cancels: the impulse with a lever of 1 m, what the target brings, and the parts.
  const double momentum = impact.Fbar.norm() + impact.base.norm() + impact.coupling.norm();
  const Vector6d Omega = impact.Omega_after();
  const JointVectord phidot = impact.phidot_after();
  const double rate = std::max(Omega.norm(), phidot.norm());
  double worst = 0;
  for (const double error :
       {(impact.base - first.base).norm() / momentum,
        (impact.coupling - first.coupling).norm() / momentum,
        (impact.total - first.total).norm() / momentum, (Omega - first.state.Omega).norm() / rate,
        (phidot - first.state.phidot).norm() / rate}) {
    worst = std::isnan(error) ? kInfinity : std::max(worst, error);
  }
  return worst;
}

}  // namespace

TEST_CASE("every shipped problem's simulation begins with what is predicted, for every contact") {
  int latched = 0, stuck = 0, moving = 0;
  const std::string folder = std::string(STILLBASE_SOURCE_DIR) + "/problems";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".yaml") continue;
    CaptureProblem problem = test::shipped(entry.path().stem().string());
    problem.post_impact.horizon = 0.01;
    problem.post_impact.contact = {};
    if (problem.post_impact.controllers.empty()) problem.post_impact.controllers = {"none"};
    const Configuration at = start_configuration(problem);
    for (const ContactLaw law : contacts_of(problem)) {
      problem.impulse.contact = law;
      if (law != ContactLaw::Frictionless) problem.impulse.restitution = 0;
      const ImpactSummary impact = impact_at(problem, at);
      INFO(problem.name << " " << static_cast<int>(law));
      // A hand that matches the target's motion takes no impulse but rounding.
      CHECK((problem.hand_motion.moves() || !impact.Fbar.isZero(0)));
      moving += problem.hand_motion.moves();
      latched += law == ContactLaw::Latch;
      stuck += law == ContactLaw::Sticking;
      CHECK(first_instant_error(problem, at, impact) < 1e-9);
    }
  }
  CHECK(latched >= 28);
  CHECK(stuck >= 30);
  CHECK(moving >= 4);
}

TEST_CASE("bodies that separate exchange no impulse in any contact") {
  CaptureProblem problem = test::shipped("servicer_latch");
  problem.target_state.linear_velocity *= -10;
  const Configuration at = start_configuration(problem);
  for (const ContactLaw law : contacts_of(problem)) {
    problem.impulse.contact = law;
    const ImpactSummary impact = impact_at(problem, at);
    REQUIRE(impact.closing_speed < 0);
    CHECK(impact.Fbar.isZero(0));
    CHECK(impact.total.isZero(0));
  }
}

}  // namespace stillbase
