// What the plan says of all solutions at once: the enclosed ones solve the problem, and they and
// the candidates are the same. That nothing else exists is the proof's own word, which `reference`
// cannot repeat; but an independent search from many starts looks for what may have been left out.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "verification/checks.hpp"
#include "verification/free_variables.hpp"
#include "verification/recount.hpp"

namespace stillbase::verification {
namespace {

/// Whether the solutions are the postures at which the predicted objective vanishes; otherwise the
/// equations alone leave single postures.
bool are_zeros(const Proof& proof) {
  return proof.statement.find("at which the objective is zero") != std::string::npos;
}

/// How far the middle of a box is from a solution, relative to the size of the momenta and to 1 m.
double residual_in(const Context& context, const Configuration& at) {
  const CaptureProblem& problem = context.problem;
  const PostureResponse response = posture_response(problem, at.phi);
  const auto motion = target_motion(
      problem, at, at.base * Vector3d(response.dynamics.hand_position), at.contact_time);
  const ContactEvent event = contact_event(problem, motion ? &*motion : nullptr, at);
  const Vector6d Fbar = impulse_along(problem, event, response, event.n);
  const reference::Impact impact = response.impact(Fbar);
  const double scale = response.momentum_scale(Fbar);
  double residual = hand_residual(problem, event, at, response.dynamics);
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
  if (are_zeros(context.plan.certificate.proof)) {
    residual = std::max(residual, objective_value(problem, response, Fbar) /
                                      objective_scale(problem.objective, response, Fbar));
  }
  return residual;
}

/// What the proof says of itself, against its own lists and the candidates.
void check_statements(const Plan& plan, ClaimList& claims) {
  const Proof& proof = plan.certificate.proof;
  std::vector<std::string> objections;
  const auto demand = [&](bool holds, const std::string& what) {
    if (!holds) objections.push_back(what);
  };
  const bool complete = proof.status == ProofStatus::Complete;
  const std::string begin = complete ? "proven" : "not decided";
  demand(proof.statement.compare(0, begin.size(), begin) == 0,
         "the statement does not begin with '" + begin + "'");
  const std::string count = fmt::format(": {} solution", proof.solutions.size());
  demand(proof.solutions.empty() || proof.statement.find(count) != std::string::npos,
         "the statement does not count the enclosed solutions");
  demand(complete == proof.undecided.empty(), "undecided boxes do not fit the status");
  demand(proof.boxes >= static_cast<long>(proof.solutions.size() + proof.undecided.size()),
         "fewer boxes were looked at than are listed");
  const bool is_bound = proof.lower_bound && *proof.lower_bound > 0;  // see check_bound()
  demand(!proof.lower_bound || is_bound ||
             (*proof.lower_bound == 0 && are_zeros(proof) && !proof.solutions.empty()),
         "the lower bound of a zero is zero");
  std::optional<double> least;
  for (const int c : proof.candidates) {
    if (c < 0 || c >= static_cast<int>(plan.candidates.size()) || !proof.lower_bound) continue;
    if (is_bound) continue;
    const double gap = plan.candidates[static_cast<std::size_t>(c)].objective - *proof.lower_bound;
    least = least ? std::min(*least, gap) : gap;
  }
  demand(
      is_bound || (least.has_value() == proof.gap.has_value() && (!least || *least == *proof.gap)),
      "the gap is not that of the best candidate");
  claims.none_wrong("proof_statement", objections, "words, counts, lower bound and gap fit");
}

/// Solutions that a search of its own finds are in the boxes.
void check_completeness(const Context& context, const FreeVariables& variables,
                        const Recount& recount, ClaimList& claims) {
  const Proof& proof = context.plan.certificate.proof;
  if (!recount.not_done.empty()) return;
  std::vector<std::string> outside;
  for (const Configuration& at : recount.solutions) {
    const auto holds = [&](const JointBox& box) { return variables.holds(box, at); };
    const bool is_known = std::any_of(proof.solutions.begin(), proof.solutions.end(), holds) ||
                          std::any_of(proof.undecided.begin(), proof.undecided.end(), holds);
    if (is_known) continue;
    std::string posture;
    for (const double x : at.phi) {
      posture += fmt::format("{}{:.6f}", posture.empty() ? "" : ", ", x);
    }
    if (!(proof.solutions.empty() || !proof.solutions.front().contact_time)) {
      posture += fmt::format(" at {:.6f} s", at.contact_time);
    }
    outside.push_back("(" + posture + ")");
  }
  claims.none_wrong(
      "proof_recount", outside,
      fmt::format("postures that solve the problem and are in no box of the proof: a "
                  "search from {} starts found {} (it proves nothing; the proof does)",
                  recount.starts, recount.solutions.size()));
}

}  // namespace

void check_proof(const Context& context, ClaimList& claims) {
  const Plan& plan = context.plan;
  const Proof& proof = plan.certificate.proof;
  if (proof.status == ProofStatus::NotApplicable) return;
  const FreeVariables variables(context.problem);
  const Recount recount = search_solutions(context);
  double worst = 0;
  std::vector<std::string> unlisted, unproven;
  std::vector<int> boxes_of(plan.candidates.size(), 0);
  const bool was_cut =
      plan.certificate.distinct_solutions > static_cast<int>(plan.candidates.size());
  for (std::size_t s = 0; s < proof.solutions.size(); ++s) {
    const Configuration middle = variables.at(variables.middle_of(proof.solutions[s]));
    worst = std::max(worst, residual_in(context, middle));
    const int c = s < proof.candidates.size() ? proof.candidates[s] : -1;
    const bool listed = c >= 0 && c < static_cast<int>(plan.candidates.size()) &&
                        variables.holds(proof.solutions[s],
                                        plan.candidates[static_cast<std::size_t>(c)].configuration);
    if (listed) {
      ++boxes_of[static_cast<std::size_t>(c)];
    } else if (c >= 0 || !was_cut) {
      unlisted.push_back(fmt::format("solution {}", s));
    }
  }
  claims.at_most("proof_residual", worst, context.options.constraint_tolerance, "1",
                 "largest relative residual in the middle of an enclosed solution");
  claims.none_wrong("proof_solutions_listed", unlisted,
                    "enclosed solutions that no candidate stands for");
  // With freedom left over, candidates may be local minima at which the objective is not zero.
  const bool is_whole_list =
      proof.status == ProofStatus::Complete && !recount.asks_for_zero && recount.not_done.empty();
  for (std::size_t c = 0; is_whole_list && c < boxes_of.size(); ++c) {
    if (boxes_of[c] != 1) {
      unproven.push_back(fmt::format("candidate {} in {} of them", c, boxes_of[c]));
    }
  }
  claims.none_wrong("proof_candidates_enclosed", unproven,
                    "candidates that are not in exactly one enclosed solution");
  check_statements(plan, claims);
  check_completeness(context, variables, recount, claims);
}

}  // namespace stillbase::verification
