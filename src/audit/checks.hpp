// The sets of checks of the search record. audit_plan() calls them in order.
#pragma once

#include "verification/checks.hpp"

namespace stillbase::audit {

/// All candidates, and that the configuration is one of them.
void check_candidates(const verification::Context& context, verification::ClaimList& claims);

/// Whole turns of joints that candidates state; no check where no joint has room for one.
void check_turns(const verification::Context& context, verification::ClaimList& claims);

/// The configuration that the nominal objective alone would choose. Without a limit that was
/// reached, every plan states one.
void check_nominal_optimum(const verification::Context& context, verification::ClaimList& claims);

/// The list of constraints: all that the problem demands, each once.
void check_constraint_list(const verification::Context& context, verification::ClaimList& claims);

/// The candidates that rank before the chosen one, what the choice costs, and that only the best
/// one is optimal. Left open for a plan that does not state its choice.
void check_choice(const verification::Context& context, verification::ClaimList& claims);

/// First-order conditions and curvature of the chosen configuration, by differences on the feasible
/// manifold. No check for a plan of a search that a limit ended.
void check_stationarity(const verification::Context& context, verification::ClaimList& claims);

/// Points, lengths and ends of the continua of solutions; no check without any.
void check_continua(const verification::Context& context, verification::ClaimList& claims);

/// Configurations of the plan on a curve of solutions, or a free roll, that it does not list. Of a
/// robust measure the nominal optimum and candidates that are no minima of the measure: such minima
/// may be on curves that no start reached.
std::vector<std::string> unlisted_curves(const verification::Context& context);

/// What the statement of a proof says, read from its words.
struct ProofStatement {
  bool is_proven = false;        ///< begins with "proven"
  bool is_undecided = false;     ///< begins with "not decided"
  std::optional<int> solutions;  ///< number of the enclosed ones
  /// The solutions are the configurations at which the nominal objective vanishes; otherwise the
  /// equations alone leave single configurations.
  bool are_zeros = false;
  std::optional<RiskMeasure> bounded;  ///< measure of the lower bound
  bool leaves_out_case = false;        ///< the bound does not count the wanted case
  bool had_missed_best = false;        ///< the search had missed the best candidate
};
ProofStatement read_statement(const Proof& proof);

/// What the statement of the proof says that the other fields of the plan do not; empty: nothing.
std::string statement_objection(const verification::Context& context);

/// The least measure of the candidates that satisfy the constraints; infinite without one.
double least_value(const verification::Context& context);

/// Whether a value of the measure is zero but for rounding. Never with terms of the user, which
/// nothing recomputes.
bool is_zero(const verification::Context& context, double value);

/// The enclosed solutions and the candidates are the same; no check without a proof.
void check_proof(const verification::Context& context, verification::ClaimList& claims);

/// The lower bound of the measure, when it is above zero: no candidate and no configuration that a
/// search of its own finds is better.
void check_bound(const verification::Context& context, verification::ClaimList& claims);

/// The proof and the bound again, by the prover of the options; no check where nothing was proven.
void check_repeated_proof(const verification::Context& context, verification::ClaimList& claims);

/// List of the candidates, counts and status of the search, certificate.
void check_search_record(const verification::Context& context, verification::ClaimList& claims);

/// A search for the solutions of a small problem, apart from the planner's and from its proof:
/// Gauss-Newton by `reference` from evenly spread starts.
struct Recount {
  std::string not_done;  ///< why the problem is not small enough; empty: it is
  /// The equations leave freedom, so the objective's zeros were searched.
  bool asks_for_zero = false;
  std::vector<Configuration> solutions;  ///< distinct; base position as stated
  int starts = 0;
};

/// Isolated configurations within the bounds that satisfy the hand's equations, the wanted case and
/// the inequalities, among them limits on rates, singular values and clearances. Where the
/// equations leave freedom, the objective is zero as well. For problems with one to three variables
/// among joints, base angle about an axis and time.
Recount search_solutions(const verification::Context& context);

/// Whether a configuration is on a self-motion curve of zeros of the nominal objective: the
/// equations leave freedom, and together with the zero one direction. True only where this is
/// certain, and only for objectives of one angular quantity.
bool is_on_curve_of_zeros(const CaptureProblem& problem, const Configuration& at);

}  // namespace stillbase::audit
