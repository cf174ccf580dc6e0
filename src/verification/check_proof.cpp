// What the plan says of all solutions at once: the enclosed ones solve the problem, and they and
// the candidates are the same. That nothing else exists is the proof's own word; `reference` cannot
// repeat it.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "verification/checks.hpp"

namespace stillbase::verification {
namespace {

// Candidates meet their constraints to 1e-9; another solution is never this near.
constexpr double kNear = 1e-6;

bool is_near(const RobotModel& robot, const JointBox& box, const Eigen::VectorXd& phi) {
  for (int k = 0; k < robot.n(); ++k) {
    double apart = phi[k] - (box.lower[k] + box.upper[k]) / 2;
    if (robot.joints[static_cast<std::size_t>(k)].type == JointType::Continuous) {
      apart = std::remainder(apart, 2 * M_PI);
    }
    if (!(std::abs(apart) <= (box.upper[k] - box.lower[k]) / 2 + kNear)) return false;
  }
  return true;
}

/// How far the middle of a box is from a solution, relative to the size of the momenta.
double residual_in(const Context& context, const ContactEvent& event, const JointBox& box) {
  const CaptureProblem& problem = context.problem;
  const Eigen::VectorXd phi = (box.lower + box.upper) / 2;
  const PostureResponse response = posture_response(problem, phi);
  const Vector6d Fbar = impulse_along(problem, event, response, event.n);
  const reference::Impact impact = response.impact(Fbar);
  const double scale = response.momentum_scale(Fbar);
  double residual = 0;
  const auto demand = [&](const Vector3d& zero) {
    residual = std::max(residual, zero.norm() / scale);
  };
  switch (problem.constraints.impact_case) {
    case CaseConstraint::None:
      break;
    case CaseConstraint::C:
    case CaseConstraint::C1:
      demand(impact.total);
      break;
    case CaseConstraint::C2:
      demand(impact.total);
      demand(impact.coupling);
      break;
    case CaseConstraint::G2:
      demand(impact.base);
      break;
    case CaseConstraint::G3:
      demand(impact.coupling);
      break;
  }
  if (context.plan.certificate.proof.lower_bound) {
    residual = std::max(residual, objective_value(problem.objective, response, Fbar) /
                                      objective_scale(problem.objective, response, Fbar));
  }
  return residual;
}

}  // namespace

void check_proof(const Context& context, const ContactEvent& event, ClaimList& claims) {
  const Plan& plan = context.plan;
  const Proof& proof = plan.certificate.proof;
  if (proof.status == ProofStatus::NotApplicable) return;
  double worst = 0;
  std::vector<std::string> unlisted, unproven;
  std::vector<int> boxes_of(plan.candidates.size(), 0);
  for (std::size_t s = 0; s < proof.solutions.size(); ++s) {
    worst = std::max(worst, residual_in(context, event, proof.solutions[s]));
    const int c = s < proof.candidates.size() ? proof.candidates[s] : -1;
    const bool listed = c >= 0 && c < static_cast<int>(plan.candidates.size()) &&
                        is_near(context.problem.robot, proof.solutions[s],
                                plan.candidates[static_cast<std::size_t>(c)].configuration.phi);
    if (listed) {
      ++boxes_of[static_cast<std::size_t>(c)];
    } else {
      unlisted.push_back(fmt::format("solution {}", s));
    }
  }
  claims.at_most("proof_residual", worst, context.options.constraint_tolerance, "1",
                 "largest relative residual in the middle of an enclosed solution");
  claims.none_wrong(
      "proof_solutions_listed", unlisted,
      "enclosed solutions that no candidate stands for; that there are no others is the "
      "planner's proof, not repeated here");
  // With freedom left over, candidates may be local minima at which the objective is not zero.
  const bool is_whole_list = proof.status == ProofStatus::Complete && !proof.lower_bound &&
                             context.problem.constraints.impact_case != CaseConstraint::None;
  for (std::size_t c = 0; is_whole_list && c < boxes_of.size(); ++c) {
    if (boxes_of[c] != 1) {
      unproven.push_back(fmt::format("candidate {} in {} of them", c, boxes_of[c]));
    }
  }
  claims.none_wrong("proof_candidates_enclosed", unproven,
                    "candidates that are not in exactly one enclosed solution");
}

}  // namespace stillbase::verification
