// Which candidate a plan chooses, why no better one, and which limits decide its value.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include <stillbase/nlp/optimizer.hpp>
#include <stillbase/planner/planner.hpp>

#include "support/shipped_problem.hpp"
#include "verification/failed_claims.hpp"

#include "formulation/measures/measure.hpp"
#include "planner/choice.hpp"

namespace stillbase {
namespace {

/// Candidates with values 1, 1.5 and 2 of a nominal objective, the second one chosen.
Plan second_of_three() {
  Plan plan;
  plan.problem = test::shipped("planar_two_link_c2_a");
  plan.problem.measure.kind = RiskMeasure::WorstCase;
  plan.status = PlanStatus::Optimal;
  for (int i = 0; i < 3; ++i) {
    Candidate& candidate = plan.candidates.emplace_back();
    candidate.configuration.phi = JointVectord::Constant(2, i);
    candidate.value = candidate.worst_case = 1 + 0.5 * i;
    candidate.starts_reached = 1;
    candidate.excluded = "at the contact: arm with base";
  }
  plan.configuration = plan.candidates[1].configuration;
  return plan;
}

/// From few starts and without proofs.
Plan quick_plan(CaptureProblem problem) {
  problem.search.starts = 8;
  PlannerOptions options;
  options.prover = nullptr;
  return make_plan(problem, options);
}

}  // namespace

TEST_CASE("the best good candidate is gone for before the others, as long as that takes little") {
  const CaptureProblem problem = test::shipped("iiwa_cone");
  PlannerOptions options;
  options.prover = nullptr;
  const Plan alone = make_plan(problem, options);
  options.approach.path.iterations_to_best = 0;
  const Plan of_set = make_plan(problem, options);
  constexpr const char* kOfSet = " of a set of ";
  CHECK(alone.approach.detail.find(kOfSet) == std::string::npos);
  CHECK(of_set.approach.detail.find(kOfSet) != std::string::npos);
  CHECK(alone.objective.value <= of_set.objective.value * (1 + 1e-9));
}

TEST_CASE("a chosen candidate that is not the best one is feasible, with its loss") {
  Plan plan = second_of_three();
  state_choice(plan, 1e-9, 1e-6);
  CHECK(plan.status == PlanStatus::Feasible);
  CHECK(plan.choice.better == 1);
  REQUIRE(plan.choice.loss_percent);
  CHECK(*plan.choice.loss_percent == Approx(50));
  CHECK(plan.candidates[0].excluded == "at the contact: arm with base");
  CHECK(plan.candidates[1].excluded.empty());
  CHECK(plan.candidates[2].excluded.empty());
}

TEST_CASE("a chosen candidate whose measure is the least one stays optimal") {
  Plan plan = second_of_three();
  plan.candidates[0].value = plan.candidates[1].value;
  plan.candidates[0].excluded.clear();
  state_choice(plan, 1e-9, 1e-6);
  CHECK(plan.status == PlanStatus::Optimal);
  CHECK(plan.choice.better == 1);  // it stands before, as good
  CHECK(plan.choice.loss_percent == 0.0);
  CHECK(plan.candidates[0].excluded == "not tried: approach.effort is first");
}

TEST_CASE("the loss against a least measure of zero is not known in percent") {
  Plan plan = second_of_three();
  plan.candidates[0].value = 0;
  state_choice(plan, 1e-9, 1e-6);
  CHECK(plan.status == PlanStatus::Feasible);
  CHECK_FALSE(plan.choice.loss_percent.has_value());
}

TEST_CASE("every candidate that ranks before the chosen one says what excluded it") {
  // Of eight zeros five collide.
  const Plan plan = make_plan(test::shipped("planar_two_link_c2_a"));
  const auto chosen =
      std::find_if(plan.candidates.begin(), plan.candidates.end(), [&](const Candidate& candidate) {
        return is_same_configuration(candidate.configuration, plan.configuration);
      });
  REQUIRE(chosen != plan.candidates.end());
  CHECK(plan.choice.better == chosen - plan.candidates.begin());
  for (auto other = plan.candidates.begin(); other != plan.candidates.end(); ++other) {
    CHECK(other->excluded.empty() == (other >= chosen));
    if (other < chosen && !other->collision_free) {
      CHECK(other->excluded == "at the contact: " + other->collision);
    }
  }
}

TEST_CASE("the multiplier of a binding limit is how fast the least value falls beyond it") {
  const std::string name = GENERATE("iiwa_client_50", "servicer_6dof_held");
  const CaptureProblem problem = test::without_path(name);
  const Plan plan = quick_plan(problem);
  INFO(name);
  const auto optimizer = nlp::make_optimizer("sqp");
  const auto least = [&](const CaptureProblem& moved) {
    const Formulation formulation(moved);
    Measure measure(moved, formulation);
    const Eigen::VectorXd from = formulation.variables(plan.configuration)
                                     .cwiseMax(formulation.lower())
                                     .cwiseMin(formulation.upper());
    return measure.reported(measure.finish(*optimizer, {}, from).x);
  };
  int compared = 0;
  for (const BindingLimit& limit : plan.binding) {
    INFO(limit.name);
    CHECK(std::abs(limit.margin) < 1e-6);
    CHECK(limit.multiplier > 0);
    // Outwards, where the chosen configuration stays feasible; quadratic in the step.
    constexpr double kStep = 1e-3;
    const auto value = [&](double outwards) {
      CaptureProblem moved = problem;
      if (limit.name == "contact_time") {
        VariableSpec& free = moved.variables;
        (limit.is_upper ? free.contact_time_upper : free.contact_time_lower) +=
            limit.is_upper ? outwards : -outwards;
      }
      if (limit.name == "base_attitude") moved.variables.base_attitude_max += outwards;
      for (Joint& joint : moved.robot.joints) {
        if (joint.name != limit.name) continue;
        (limit.is_upper ? joint.upper : joint.lower) += limit.is_upper ? outwards : -outwards;
      }
      return least(moved);
    };
    const double here = value(0), half = value(kStep / 2), beyond = value(kStep);
    if (here == beyond) continue;  // a limit that is neither
    ++compared;
    const double slope = (3 * here - 4 * half + beyond) / kStep;
    CHECK(slope == Approx(limit.multiplier).epsilon(0.02));
  }
  CHECK((compared > 0 || plan.binding.empty()));
  if (name == "iiwa_client_50") CHECK(compared > 0);
  if (name != "servicer_6dof_held") return;
  // The angle that the problem states, of a row that bounds its square.
  const auto attitude =
      std::find_if(plan.binding.begin(), plan.binding.end(),
                   [](const BindingLimit& limit) { return limit.name == "base_attitude"; });
  REQUIRE(attitude != plan.binding.end());
  CHECK(attitude->unit == "rad");
  CHECK(attitude->value == problem.variables.base_attitude_max);
  CHECK(attitude->is_upper);
  CHECK(failures(plan).find("binding") == std::string::npos);
  Plan altered = plan;
  altered.binding[static_cast<std::size_t>(attitude - plan.binding.begin())].multiplier *= 1.05;
  CHECK(failures(altered).find("binding_multipliers") != std::string::npos);
}

TEST_CASE("a binding limit with another multiplier is found") {
  Plan plan = quick_plan(test::without_path("iiwa_client_50"));
  REQUIRE_FALSE(plan.binding.empty());
  CHECK(failures(plan).find("binding") == std::string::npos);
  plan.binding.front().multiplier *= 1.2;
  CHECK(failures(plan).find("binding_multipliers") != std::string::npos);
  plan.binding.front().margin = 0.1;
  CHECK(failures(plan).find("binding_limits") != std::string::npos);
}

TEST_CASE("a plan that hides its loss is found") {
  Plan plan = quick_plan(test::without_path("iiwa_client_50"));
  const auto fails = [&] { return failures(plan).find("choice") != std::string::npos; };
  const auto worse =
      std::find_if(plan.candidates.begin(), plan.candidates.end(),
                   [&](const Candidate& x) { return x.value > 1.001 * plan.candidates[0].value; });
  REQUIRE(worse != plan.candidates.end());
  CHECK_FALSE(fails());
  plan.configuration = worse->configuration;
  CHECK(fails());  // optimal, though the first one is better
  state_choice(plan, 1e-9, 1e-6);
  CHECK_FALSE(fails());
  plan.choice.loss_percent = *plan.choice.loss_percent / 2;
  CHECK(fails());
  state_choice(plan, 1e-9, 1e-6);
  plan.candidates[0].excluded.clear();
  CHECK(fails());
}

}  // namespace stillbase
