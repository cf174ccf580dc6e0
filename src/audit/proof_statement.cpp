// The statement of a proof: all its words and numbers follow from other fields of the plan. Only
// the prover and the search know how many solutions are beyond the limits, which limit of boxes or
// time stopped a proof, and what the search had missed.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string_view>

#include <fmt/format.h>

#include "audit/checks.hpp"
#include "audit/equations.hpp"
#include "plan/contact_limits.hpp"
#include "plan/proof_words.hpp"
#include "verification/known_constraints.hpp"

namespace stillbase::audit {

using namespace verification;

namespace {

/// How words are compared with numbers.
struct StatementOptions {
  double rounding = 1e-9;  ///< relative, of a value before it is written with few digits
};
constexpr StatementOptions kStatement;
constexpr const char* kStopped = ", stopped at the limit";
constexpr const char* kNoLess = "; the best one is zero, no less is possible";
constexpr const char* kNotIsolated = ", so the solutions are not isolated points";

std::string count_of(int count, const std::string& what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

/// A text that is read from its beginning.
class StatedWords {
 public:
  explicit StatedWords(std::string_view text) : rest_(text) {}

  bool begin_with(std::string_view words) const { return rest_.substr(0, words.size()) == words; }
  bool take(const std::string& words) {
    if (!begin_with(words)) return false;
    rest_.remove_prefix(words.size());
    return true;
  }
  std::optional<int> take_number() {
    int number = 0, end = 0;
    const std::string digits(rest_.substr(0, 9));
    if (std::sscanf(digits.c_str(), "%d%n", &number, &end) != 1) return std::nullopt;
    if (!take(std::to_string(number))) return std::nullopt;
    return number;
  }
  /// "1 solution", "2 solutions".
  std::optional<int> take_count(const std::string& what) {
    StatedWords ahead = *this;
    const std::optional<int> number = ahead.take_number();
    if (!number || !take(count_of(*number, what))) return std::nullopt;
    return number;
  }
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
};

bool has_free_time(const CaptureProblem& problem) {
  return problem.variables.contact_time_upper > problem.variables.contact_time_lower;
}

/// Whether only joints are free.
bool is_encounter_fixed(const CaptureProblem& problem) {
  return problem.variables.base_attitude == AttitudeFreedom::Fixed && !has_free_time(problem);
}

/// Whether the plan has terms or constraints that no file holds.
bool has_functions_of_user(const Context& context) {
  const KnownConstraints known(context.situation);
  const auto& list = context.plan.constraints;
  return !context.plan.objective.user_terms.empty() ||
         std::any_of(list.begin(), list.end(),
                     [&](const ConstraintValue& c) { return !known.find(c.name); });
}

/// Why a problem is not of the kind that can be proven.
bool take_objection(const Context& context, StatedWords& words) {
  const CaptureProblem& problem = context.problem;
  const AttitudeFreedom attitude = problem.variables.base_attitude;
  const int count = FreeVariables(problem).size();
  const std::string variable = is_encounter_fixed(problem) ? "free joint" : "free variable";
  if (words.take("nothing was proven, the program has no prover (stillbase::proof)")) return true;
  if (words.take("there are several contact features")) {
    return !problem.variables.features.empty();
  }
  if (words.take("functions of the user are not enclosed")) return has_functions_of_user(context);
  if (words.take("no bound for this contact: only an impulse along the normal is enclosed")) {
    return problem.impulse.contact != ContactLaw::Frictionless;
  }
  if (words.take("some joints follow others")) return problem.robot.is_coupled();
  if (words.take("the base attitude is free about more than one axis")) {
    return attitude == AttitudeFreedom::Cone || attitude == AttitudeFreedom::Free;
  }
  if (words.take("the target tumbles too often until the contact")) return has_free_time(problem);
  if (words.take(fmt::format("it takes one to three {}s, here are {}", variable, count))) {
    return count < 1 || count > 3;
  }
  if (words.take("the robot has more than ")) {
    const std::optional<int> most = words.take_count("joint");
    return most && problem.robot.n() > *most;
  }
  if (words.take("no equation depends on ")) {
    const bool is_known = (has_free_time(problem) && words.take("the contact time")) ||
                          (attitude != AttitudeFreedom::Fixed && words.take("the base attitude"));
    return is_known && words.take(kNotIsolated);
  }
  if (words.take(fmt::format("where they hold, {} say as much as ", count_of(count, "equation")))) {
    const std::optional<int> rank = words.take_number();
    return rank && *rank < count && words.take(kNotIsolated);
  }
  const std::optional<int> equations = words.take_count("equation");
  return equations && *equations != count &&
         words.take(fmt::format(" for {}{}", count_of(count, variable), kNotIsolated));
}

/// How many solutions are enclosed, or that there are none.
bool take_enclosed(const Context& context, StatedWords& words) {
  const CaptureProblem& problem = context.problem;
  const Proof& proof = context.plan.certificate.proof;
  const bool is_fixed = is_encounter_fixed(problem);
  const int solutions = static_cast<int>(proof.solutions.size());
  const std::string enclosed = count_of(solutions, "solution") + " enclosed";
  if (!proof.undecided.empty()) {
    const std::string places = count_of(static_cast<int>(proof.undecided.size()), "place");
    if (!words.take(fmt::format("not decided: {}, {} where more may be", enclosed, places))) {
      return false;
    }
    words.take(" (stopped at the limit)");
  } else if (solutions > 0) {
    if (!words.take("proven complete: " + enclosed)) return false;
  } else if (!words.take(
                 fmt::format("proven: no {} that meets the constraints makes the objective zero",
                             is_fixed ? "posture" : "configuration"))) {
    if (!words.take("proven: there is no solution within the ")) return false;
    if (!words.take("bounds") && !(is_fixed && words.take("joint limits"))) return false;
  }
  if (solutions > 0 || !proof.undecided.empty()) words.take(" at which the objective is zero");
  if (uncounted_limits(problem).empty()) return true;
  return words.take(" (") && words.take_count("other") &&
         words.take(
             " beyond the limits on rates, singular values or clearances; judged at their "
             "middles)");
}

/// What the search had not found of the enclosed solutions.
bool take_missed(const Proof& proof, StatedWords& words) {
  if (proof.solutions.empty()) return true;
  const auto total = static_cast<int>(proof.solutions.size());
  const auto listed =
      static_cast<int>(std::count_if(proof.candidates.begin(), proof.candidates.end(),
                                     [](int candidate) { return candidate >= 0; }));
  if (listed < total) {
    return words.take(fmt::format(", {} of them not among the candidates kept", total - listed));
  }
  if (proof.found_by_search < total) {
    return words.take(
        fmt::format(", {} of them missed by the search and added", total - proof.found_by_search));
  }
  const bool is_complete = proof.status == ProofStatus::Complete;
  return words.take(is_complete ? ", none missed" : ", none of these missed");
}

/// Four digits, rounded down.
std::string four_digits_down(double x) {
  const double unit = std::pow(10, std::floor(std::log10(x)) - 3);
  return fmt::format("{:.4g}", std::floor(x / unit) * unit);
}

/// Constraints that the bound does not ask for, all of them.
bool take_left_out(const Context& context, StatedWords& words) {
  const CaptureProblem& problem = context.problem;
  const Proof& proof = context.plan.certificate.proof;
  std::vector<std::string> needed = uncounted_limits(problem);
  const bool has_point = problem.hand.position || !problem.impulse.direction;
  const bool is_attitude_idle = problem.variables.base_attitude != AttitudeFreedom::Fixed &&
                                problem.impulse.direction &&
                                problem.impulse.direction_frame == Frame::Base;
  if (problem.variables.base_position == PositionFreedom::Box && (!has_point || is_attitude_idle)) {
    needed.insert(needed.begin(), "the base's position");
  }
  const auto take_list = [&](const std::vector<std::string>& list) {
    return list.empty() || words.take(fmt::format(", not counting {}", fmt::join(list, ", ")));
  };
  if (problem.constraints.impact_case == CaseConstraint::None) return take_list(needed);
  // Where the case leaves single configurations, these alone are bounded.
  const bool may_count_case = proof.status == ProofStatus::Complete && !proof.solutions.empty() &&
                              !read_statement(proof).are_zeros;
  std::vector<std::string> all = needed;
  all.insert(all.begin(), "the case");
  return take_list(all) || (may_count_case && take_list(needed));
}

/// Bound, best candidate, gap, and the constraints that it leaves out.
bool take_bound(const Context& context, StatedWords& words) {
  const CaptureProblem& problem = context.problem;
  const double bound = *context.plan.certificate.proof.lower_bound;
  const double best = least_value(context);
  const std::string what = measure_name(problem), unit = objective_unit_name(problem);
  const bool is_posture = words.take(fmt::format("no posture has {} below ", what));
  const bool is_configuration = !is_posture && !is_encounter_fixed(problem) &&
                                words.take(fmt::format("no configuration has {} below ", what));
  if (!is_posture && !is_configuration) return false;
  // A value that is halfway between two roundings may be written as either.
  const auto take_value = [&](double value, const auto& write) {
    for (const double factor : {1.0, 1 - kStatement.rounding, 1 + kStatement.rounding}) {
      if (words.take(write(value * factor))) return true;
    }
    return false;
  };
  const double gap = 100 * std::max(0.0, best - bound) / best;
  if (!take_value(bound, [&](double x) { return four_digits_down(x) + " " + unit; }) ||
      !take_value(best, [](double x) { return fmt::format(" (best candidate {:.4g},", x); }) ||
      !take_value(gap, [](double x) { return fmt::format(" gap {:.2g} %", x); })) {
    return false;
  }
  words.take(kStopped);
  return words.take(")") && take_left_out(context, words);
}

}  // namespace

ProofStatement read_statement(const Proof& proof) {
  const std::string& text = proof.statement;
  const auto says = [&](const std::string& words) { return text.find(words) != std::string::npos; };
  ProofStatement out;
  out.is_proven = text.rfind("proven", 0) == 0;
  out.is_undecided = text.rfind("not decided", 0) == 0;
  int count = 0, end = -1;
  const std::size_t colon = std::min(text.find(": "), text.size());
  if (std::sscanf(text.c_str() + colon, ": %d solution%n", &count, &end) == 1 && end > 0) {
    out.solutions = count;
  }
  out.are_zeros = says("at which the objective is zero");
  for (const auto& [kind, words] : {std::pair{RiskMeasure::Nominal, "a predicted "},
                                    {RiskMeasure::WorstCase, "a worst case"},
                                    {RiskMeasure::Expectation, "an expected "},
                                    {RiskMeasure::Cvar, "a CVaR of "}}) {
    for (const char* place : {"no posture has ", "no configuration has "}) {
      if (says(std::string(place) + words)) out.bounded = kind;
    }
  }
  out.leaves_out_case = says("the case");
  out.had_missed_best = says("which the search had missed");
  return out;
}

std::string statement_objection(const Context& context) {
  const Proof& proof = context.plan.certificate.proof;
  const bool is_enclosed = proof.status != ProofStatus::NotApplicable;
  const bool is_bounded = proof.lower_bound && *proof.lower_bound > 0;
  StatedWords words(proof.statement);
  bool fits = true;
  if (is_enclosed) {
    fits = take_enclosed(context, words) && take_missed(proof, words);
  } else if (!is_bounded) {
    fits = words.take("no proof: ") && take_objection(context, words);
  }
  if (fits && is_bounded) {
    fits = words.take(is_enclosed ? "; " : "proven: ") && take_bound(context, words);
  } else if (fits && words.take("; no bound for ")) {
    fits = words.take(measure_name(context.problem));
    words.take(kStopped);
  }
  if (fits && !is_enclosed && words.begin_with(kNoLess) && is_zero(context, least_value(context))) {
    words.take(kNoLess);
  }
  if (fits) {
    words.take("; the best one, which the search had missed, was found in bounding it");
    fits = words.rest().empty();
  }
  if (fits) return "";
  return fmt::format("the other fields of the plan do not say '{}'", words.rest());
}

}  // namespace stillbase::audit
