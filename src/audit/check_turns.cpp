// Whole turns of joints: one posture, stated once, with room for the turns that the plan states.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/plan/free_roll.hpp>

#include "audit/checks.hpp"
#include "audit/equations.hpp"
#include "audit/tolerances.hpp"
#include "verification/tolerances.hpp"

namespace stillbase::audit {

using namespace verification;

namespace {

/// A configuration with all joints as many turns down, or up, as is stated.
Configuration turned(const CaptureProblem& problem, const Candidate& candidate, bool up) {
  Configuration out = candidate.configuration;
  for (const JointTurns& turns : candidate.turns) {
    for (int k = 0; k < problem.robot.n(); ++k) {
      if (problem.robot.joints[k].name != turns.joint) continue;
      out.phi[k] += 2 * kPi * (up ? turns.most : turns.least);
    }
  }
  return out;
}

class Turns {
 public:
  explicit Turns(const Context& context) : context_(context) {}

  void judge(const Candidate& candidate, const std::string& name) {
    judge_list(candidate, name);
    if (candidate.turns.empty()) return;
    const auto numbers = [&](const Configuration& at) {
      return objective_numbers(Situation(context_.problem, at), context_.cone_samples());
    };
    const ObjectiveNumbers here = numbers(candidate.configuration);
    for (const bool up : {false, true}) {
      const Configuration at = turned(context_.problem, candidate, up);
      for (const std::string& objection :
           configuration_objections(Situation(context_.problem, at), context_.options)) {
        stated_.add(fmt::format("{}, turned: {}", name, objection));
      }
      const ObjectiveNumbers there = numbers(at);
      changed_ = std::max({changed_, std::abs(there.nominal - here.nominal) / here.scale,
                           std::abs(there.worst_case - here.worst_case) / here.scale,
                           std::abs(there.measure - here.measure) / here.scale});
    }
  }

  void claim(ClaimList& claims) const {
    if (!any_) return;
    claims.at_most("candidates_turns", changed_, kRecord.unchanged, "1",
                   "largest change of objective or measure over the stated whole turns, relative "
                   "to the terms that the objective is made of");
    claims.none_wrong("candidates_turns_stated", stated_,
                      "joints whose whole turns are not those that their limits leave room for");
  }

 private:
  /// Each joint whose limits hold another angle of the posture, with all of these.
  void judge_list(const Candidate& candidate, const std::string& name) {
    const CaptureProblem& problem = context_.problem;
    std::size_t listed = 0;
    for (int k = 0; k < problem.robot.n(); ++k) {
      const Joint& joint = problem.robot.joints[k];
      if (joint.type == JointType::Continuous || !reaches_every_angle(problem, k)) continue;
      if (is_free(candidate, k)) continue;
      any_ = true;
      const double lower = joint.lower + problem.constraints.joint_limit_margin - kShared.rounding;
      const double upper = joint.upper - problem.constraints.joint_limit_margin + kShared.rounding;
      int least = 0, most = 0;
      while (candidate.configuration.phi[k] + 2 * kPi * (least - 1) >= lower) --least;
      while (candidate.configuration.phi[k] + 2 * kPi * (most + 1) <= upper) ++most;
      const bool is_listed =
          std::any_of(candidate.turns.begin(), candidate.turns.end(), [&](const JointTurns& turns) {
            return turns.joint == joint.name && turns.least == least && turns.most == most;
          });
      if (least == 0 && most == 0) continue;
      ++listed;
      stated_.demand(is_listed, fmt::format("{}: {} has room for {} to {} turns", name, joint.name,
                                            least, most));
    }
    any_ = any_ || !candidate.turns.empty();
    stated_.demand(candidate.turns.size() == listed, name + ": turns that there is no room for");
  }

  bool is_free(const Candidate& candidate, int k) const {
    if (candidate.family < 0) return false;
    return free_joint(context_.plan.families[static_cast<std::size_t>(candidate.family)]) == k;
  }

  const Context& context_;
  double changed_ = 0;
  bool any_ = false;
  Objections stated_;
};

}  // namespace

void check_turns(const Context& context, ClaimList& claims) {
  // Functions of the user may tell whole turns apart, and a plan file does not have them.
  if (!context.plan.objective.user_terms.empty()) return;
  Turns turns(context);
  for (std::size_t i = 0; i < context.plan.candidates.size(); ++i) {
    if (context.options.stop.reached()) return;
    turns.judge(context.plan.candidates[i], fmt::format("candidate {}", i));
  }
  turns.claim(claims);
}

}  // namespace stillbase::audit
