// A plan of a latch without any search.
#pragma once

#include <string>

#include <stillbase/encounter/encounter.hpp>
#include <stillbase/planner/post_impact.hpp>

#include "support/shipped_problem.hpp"
#include "verification/checks.hpp"

namespace stillbase::verification_test {

/// A latch in the start posture, the hand at the feature, taken over by detumble.
inline Plan latched_plan(const std::string& controller = "detumble") {
  Plan plan;
  plan.problem = test::shipped("servicer_latch");
  PostImpactSpec& spec = plan.problem.post_impact;
  spec.controllers = {controller};
  spec.horizon = 12;
  spec.wheels.torque = Vector3d(0.8, 1, 1.2);
  spec.wheels.momentum.setConstant(50);
  spec.grip.force = 500;
  spec.grip.moment = 300;
  Configuration& at = plan.configuration;
  at = start_configuration(plan.problem);
  const verification::Situation there(plan.problem, at);
  at.base.position += there.event.feature->point - there.hand_N;
  plan.impact = impact_at(plan.problem, at);
  plan.managed_momentum = account_after_impact(plan.problem, at, plan.impact).momentum;
  plan.status = PlanStatus::Feasible;
  return plan;
}

}  // namespace stillbase::verification_test
