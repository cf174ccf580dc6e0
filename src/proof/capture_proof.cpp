// Which proof belongs to which capture problem.
#include <algorithm>

#include <stillbase/proof/minimum.hpp>

#include "proof/zero_problem.hpp"

namespace stillbase {
namespace {

/// Why a problem cannot be proven; empty: it can.
std::string objection(const CaptureProblem& problem) {
  const VariableSpec& variables = problem.variables;
  const AttitudeFreedom attitude = variables.base_attitude;
  if (attitude != AttitudeFreedom::Cone && attitude != AttitudeFreedom::Free) return "";
  const auto joints = std::count(variables.joints.begin(), variables.joints.end(), true);
  const bool time = variables.contact_time_upper > variables.contact_time_lower;
  if (joints > 0 || time) {
    return "it takes one to three free variables, here are " +
           std::to_string(joints + 3 + (time ? 1 : 0));
  }
  return "the base attitude is free about more than one axis";
}

/// Whether the objective is one angular quantity, whose zeros are equations without division.
bool is_angular(const std::vector<ObjectiveTerm>& objective) {
  if (objective.size() != 1) return false;
  switch (objective.front().quantity) {
    case ObjectiveQuantity::BaseAngularMomentum:
    case ObjectiveQuantity::BaseAngularVelocity:
    case ObjectiveQuantity::TotalAngularMomentum:
      return true;
    default:
      return false;
  }
}

}  // namespace

Proof prove(const CaptureProblem& problem, const ProofOptions& options) {
  const std::string reason = objection(problem);
  if (!reason.empty()) {
    Proof out;
    out.statement = "no proof: " + reason;
    return out;
  }
  proof::ZeroProblem zeros = proof::zero_problem(problem);
  if (zeros.has_limits && !options.judge) {
    Proof out;
    out.statement = "no proof: nobody judges the limits on rates, singular values or clearances";
    return out;
  }
  Proof out = proof::enclose_solutions(zeros, options);
  if (out.status != ProofStatus::NotApplicable) return out;
  // The equations leave freedom: enclose where the nominal objective vanishes.
  if (!is_angular(problem.objective)) return out;
  zeros.zero = problem.objective.front().quantity;
  Proof vanishing = proof::enclose_solutions(zeros, options);
  if (vanishing.status == ProofStatus::NotApplicable) return out;
  if (!vanishing.solutions.empty()) vanishing.lower_bound = 0;
  return vanishing;
}

void enable_proofs() {
  static constexpr Prover prover{prove, minimum_objection, prove_minimum};
  use_prover(prover);
}

}  // namespace stillbase
