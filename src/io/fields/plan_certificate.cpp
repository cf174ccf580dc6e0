// How good a plan is, as its file states it.
#include "io/fields/plan.hpp"

#include <cmath>

namespace stillbase::io {

namespace {

void ends_field(Table& t, const char* key, std::optional<Ends>& ends, bool is_variable,
                const char* text, const char* unit) {
  std::vector<double> both{0, 0};
  if (ends) both = {ends->lower, ends->upper};
  const bool is_there = t.reader() != nullptr ? is_variable : ends.has_value();
  t(key, Numbers(both, 2), text, {.unit = unit, .when = is_there});
  if (is_there) ends = Ends{both[0], both[1]};
}

void box_fields(Table& t, const CaptureProblem& problem, JointBox& box) {
  const VariableSpec& variables = problem.variables;
  t("lower", Numbers(box.lower, problem.robot.n()), "lower ends of the joint positions", kPerJoint);
  t("upper", Numbers(box.upper, problem.robot.n()), "upper ends", kPerJoint);
  ends_field(t, "base_angle", box.base_angle, variables.base_attitude == AttitudeFreedom::Axis,
             "ends, of the base about its axis from the stated attitude, where it is a variable",
             "rad");
  ends_field(t, "contact_time", box.contact_time,
             variables.contact_time_upper > variables.contact_time_lower,
             "ends, where it is a variable", "s");
}

void proof_fields(Table& t, const CaptureProblem& problem, Proof& proof) {
  const auto boxes = [&problem](std::vector<JointBox>& list) {
    return List(list, [&problem](JointBox& box) {
      return Map([&](Table& m) { box_fields(m, problem, box); });
    });
  };
  t("status", Word(proof.status, proof_status_names()),
    "`complete`: every solution is enclosed; `undecided`: solutions may also be in the boxes of "
    "`undecided`; `not_applicable`: `statement` says why",
    kNeeded);
  t("statement", Text(proof.statement),
    "the same in words, with the reason; `verify` compares all of it with the other fields",
    kNeeded);
  t("solutions", boxes(proof.solutions),
    "boxes, rounded outwards, each proven to contain exactly one solution", kNeeded);
  t("candidates", List(proof.candidates, [](int& index) { return Integer(index, -1, kMany); }),
    "per solution the index of its candidate, or -1", kNeeded);
  t("undecided", boxes(proof.undecided), "boxes that may contain solutions", kNeeded);
  t("found_by_search", Integer(proof.found_by_search, 0, kMany),
    "solutions that the search had found by itself", kNeeded);
  t("boxes", Integer(proof.boxes, 0, kMany), "boxes that branch and bound evaluated", kNeeded);
  t("lower_bound", OrNull(Number(proof.lower_bound), !proof.lower_bound),
    "no posture has a smaller measure; zero: of the nominal objective; null: none",
    needed("`objective.unit`"));
  t("gap", OrNull(Number(proof.gap), !proof.gap), "best candidate minus lower bound; null: none",
    needed("`objective.unit`"));
  MapReader* map = t.reader();
  if (map == nullptr || !map->context().findings.empty()) return;
  if (proof.candidates.size() == proof.solutions.size()) return;
  map->context().add(map->line(), "wrong-length",
                     "certificate.proof: solutions and candidates must have the same length");
}

}  // namespace

void certificate_fields(Table& t, const CaptureProblem& problem, Certificate& certificate) {
  t("kkt_residual",
    OrNull(Number(certificate.kkt_residual, kNonNegative), std::isinf(certificate.kkt_residual),
           [&] { certificate.kkt_residual = kInfinity; }),
    "residual of the first-order conditions, multipliers by non-negative least squares; null: a "
    "limit came first",
    kNeeded);
  t("max_violation", Number(certificate.max_violation, kNonNegative),
    "largest violation of a constraint", kOwnUnit);
  t("reduced_hessian_min_eigenvalue",
    OrNull(Number(certificate.reduced_hessian_min_eigenvalue),
           !certificate.reduced_hessian_min_eigenvalue),
    "smallest curvature of the Lagrangian along the directions that the active constraints leave, "
    "objective in typical sizes; positive: strict local minimum; zero: a continuum of equally good "
    "ones; negative: no minimum; null: no direction is left",
    needed("1/rad^2 (1/m^2, 1/s^2)"));
  t("starts", Integer(certificate.starts, 0, kMany), "of the search", kNeeded);
  t("distinct_solutions", Integer(certificate.distinct_solutions, 0, kMany),
    "solutions that differ", kNeeded);
  t("unseen", Number(certificate.unseen, {.lower = 0, .upper = 1}),
    "estimated probability that one more start ends at a solution of the nominal problem that none "
    "has reached; with `had_rounds`: that a better minimum of the measure, as easy to reach, was "
    "missed, which above 0.05 makes a plan `feasible`",
    kNeeded);
  t("had_rounds", Flag(certificate.had_rounds),
    "whether the starts of a worst case, or of a mean over the residual velocity, went on in "
    "rounds (no stated `search.starts`)",
    kNeeded);
  t("proof", Map([&](Table& m) { proof_fields(m, problem, certificate.proof); }),
    "what branch and bound with intervals says of all solutions", kNeeded);
}

}  // namespace stillbase::io
