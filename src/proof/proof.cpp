// Which proof belongs to which capture problem, and the zeros of its equations enclosed.
#include <stillbase/proof/proof.hpp>

#include <algorithm>
#include <cmath>

#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/core/random.hpp>

#include <stillbase/proof/minimum.hpp>

#include "proof/plan_boxes.hpp"
#include "proof/row_system.hpp"

namespace stillbase::proof {
namespace {

constexpr int kMaxJointsInProof = kMaxJointsOf<Dual>;

std::string counted(int count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

Proof not_applicable(const std::string& reason) {
  Proof out;
  out.statement = "no proof: " + reason;
  return out;
}

/// Least rank of the equations' slopes at the first solution that Newton steps in plain doubles
/// find where it is full, or at a few where it is not; -1: they find none. It only says whether
/// enclosing is worth a try.
template <int N>
int rank_at_solutions(const RowSystem<N>& system, const Box<N>& domain) {
  const SurveyOptions options;
  int rank = -1;
  for (int start = 0, found = 0; start < options.starts && found < options.enough; ++start) {
    const Eigen::VectorXd u = low_discrepancy_point(start, N, 1);
    Eigen::Matrix<double, N, 1> x, f;
    for (int i = 0; i < N; ++i) x[i] = domain[i].lower() + u[i] * width_of(domain[i]);
    for (int step = 0; step < options.max_steps; ++step) {
      Box<N> here;
      std::array<Dual, N> at, values;
      for (int i = 0; i < N; ++i) {
        here[i] = Interval(x[i]);
        at[i] = Dual(here[i], i, N);
      }
      system.evaluate(at, values);
      Eigen::Matrix<double, N, N> J;
      for (int i = 0; i < N; ++i) {
        f[i] = middle(values[i]);
        for (int j = 0; j < N; ++j) J(i, j) = middle(values[i].d[j]);
      }
      if (!f.allFinite() || !J.allFinite()) break;
      if (f.norm() < options.solved) {
        if (system.excludes(here)) break;
        const Eigen::VectorXd sigma = singular_values(J);
        rank = std::max(rank, numerical_rank(sigma, options.rank));
        if (rank == N) return rank;
        ++found;
        break;
      }
      const Eigen::VectorXd move = least_norm_solution(J, f, options.pivot);
      const double most = move.cwiseAbs().maxCoeff();
      x -= move * (most > options.longest_step ? options.longest_step / most : 1);
    }
  }
  return rank;
}

/// Something other than a joint that the equations do not depend on; empty: nothing.
template <int N>
std::string idle_variable(const VariableEncounter& encounter, const Survey<N>& survey) {
  for (std::size_t i = 0; i < N; ++i) {
    const VariableKind kind = encounter.variables[i].kind;
    if (survey.matters[i] || kind == VariableKind::Joint) continue;
    return kind == VariableKind::Time ? "the contact time" : "the base attitude";
  }
  return "";
}

/// In the mode that everything else is computed in.
WithinLimits judged(const JointBox& box, const ProofOptions& options) {
  const auto is_wide = [&](const std::optional<Ends>& ends) {
    return ends && !(ends->upper - ends->lower <= options.judged_width);
  };
  if (!((box.upper - box.lower).maxCoeff() <= options.judged_width) || is_wide(box.base_angle) ||
      is_wide(box.contact_time)) {
    return WithinLimits::Undecided;
  }
  const RoundToNearest nearest;
  return options.judge(box);
}

/// What was proven, in words that the verification reads.
std::string statement_of(const ZeroProblem& problem, const Proof& proof, bool limit_reached,
                         int beyond_limits) {
  const auto count = [](std::size_t number) { return static_cast<int>(number); };
  const bool only_limits = problem.encounter.is_fixed() && problem.inequalities.empty();
  const std::string solutions = counted(count(proof.solutions.size()), "solution") + " enclosed";
  std::string out;
  if (!proof.undecided.empty()) {
    out = "not decided: " + solutions + ", " + counted(count(proof.undecided.size()), "place") +
          " where more may be" + (limit_reached ? " (stopped at the limit)" : "");
  } else if (!proof.solutions.empty()) {
    out = "proven complete: " + solutions;
  } else if (problem.zero) {
    out = std::string("proven: no ") +
          (problem.encounter.is_fixed() ? "posture" : "configuration") +
          " that meets the constraints makes the objective zero";
  } else {
    out = std::string("proven: there is no solution within the ") +
          (only_limits ? "joint limits" : "bounds");
  }
  const bool is_none = proof.undecided.empty() && proof.solutions.empty();
  if (problem.zero && !is_none) out += " at which the objective is zero";
  if (!problem.uncounted_limits.empty()) {
    out += " (" + counted(beyond_limits, "other") +
           " beyond the limits on rates, singular values or clearances; judged at their middles)";
  }
  return out;
}

template <int N>
Proof enclose(const ZeroProblem& problem, const ProofOptions& options) {
  const VariableEncounter& encounter = problem.encounter;
  const std::string variable = encounter.is_fixed() ? "free joint" : "free variable";
  const Survey<N> survey = survey_of<N>(problem, all_rows(problem));
  const std::vector<Row>& rows = survey.rows;
  if (static_cast<int>(rows.size()) != N) {
    return not_applicable("" + counted(static_cast<int>(rows.size()), "equation") + " for " +
                          counted(N, variable) + ", so the solutions are not isolated points");
  }
  const std::string idle = idle_variable(encounter, survey);
  if (!idle.empty()) {
    return not_applicable("no equation depends on " + idle +
                          ", so the solutions are not isolated points");
  }
  std::array<bool, N> periodic;
  for (std::size_t i = 0; i < N; ++i) periodic[i] = encounter.variables[i].is_periodic;
  const Box<N> domain = domain_of<N>(encounter);
  const RowSystem<N> system(problem, rows, domain);
  const int rank = rank_at_solutions<N>(system, domain);
  if (rank >= 0 && rank < N) {
    return not_applicable("where they hold, " + counted(N, "equation") + " say as much as " +
                          std::to_string(rank) + ", so the solutions are not isolated points");
  }
  const Enclosure<N> found = enclose_zeros<N>(
      system, domain, periodic,
      {.max_boxes = options.max_boxes, .min_width = options.min_width, .stop = options.stop});
  Proof out;
  out.boxes = found.boxes;
  for (const Box<N>& box : found.undecided) out.undecided.push_back(joint_box(encounter, box));
  int beyond_limits = 0;
  for (const Zero<N>& zero : found.zeros) {
    const Kept kept = system.kept_over(zero.tight);
    if (kept == Kept::No) continue;
    const JointBox box = joint_box(encounter, zero.tight);
    WithinLimits within = WithinLimits::Yes;
    if (kept == Kept::Open) {
      within = WithinLimits::Undecided;
    } else if (!problem.uncounted_limits.empty()) {
      within = judged(box, options);
    }
    beyond_limits += within == WithinLimits::No;
    if (within == WithinLimits::Yes) out.solutions.push_back(box);
    if (within == WithinLimits::Undecided) {
      out.undecided.push_back(joint_box(encounter, zero.reach));
    }
  }
  out.status = out.undecided.empty() ? ProofStatus::Complete : ProofStatus::Undecided;
  out.statement = statement_of(problem, out, found.limit_reached, beyond_limits);
  return out;
}

/// Every zero of the equations that keeps the inequalities within the bounds of the variables.
/// @return status Complete: every solution is in exactly one of the boxes `solutions`, each of
/// which holds exactly one; Undecided: every solution is in one of them or in one of `undecided`;
/// NotApplicable: the equations are not as many as the variables
/// @pre the base attitude is fixed or free about one axis: other rotations have two parameter
/// vectors on the surface of the ball
Proof enclose_solutions(const ZeroProblem& problem, const ProofOptions& options) {
  const RobotModel& robot = problem.robot;
  const VariableEncounter& encounter = problem.encounter;
  if (robot.n() > kMaxJointsInProof) {
    return not_applicable("the robot has more than " + std::to_string(kMaxJointsInProof) +
                          " joints");
  }
  if (encounter.spin && !encounter.spin->is_valid()) {
    return not_applicable("the target tumbles too often until the contact");
  }
  const RoundUpward upward;
  switch (encounter.num_variables()) {
    case 1:
      return enclose<1>(problem, options);
    case 2:
      return enclose<2>(problem, options);
    case 3:
      return enclose<3>(problem, options);
    default:
      return not_applicable(std::string("it takes one to three free ") +
                            (encounter.is_fixed() ? "joints" : "variables") + ", here are " +
                            std::to_string(encounter.num_variables()));
  }
}

constexpr const char* kNoBoundForContact =
    "no bound for this contact: only an impulse along the normal is enclosed";

/// Why a problem cannot be proven; empty: it can.
std::string objection(const CaptureProblem& problem) {
  if (problem.impulse.contact != ContactLaw::Frictionless) return kNoBoundForContact;
  if (problem.robot.is_coupled()) return "some joints follow others";
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

}  // namespace
}  // namespace stillbase::proof

namespace stillbase {

Proof prove(const CaptureProblem& problem, const ProofOptions& options) {
  const std::string reason = proof::objection(problem);
  if (!reason.empty()) return proof::not_applicable(reason);
  proof::ZeroProblem zeros = proof::zero_problem(problem);
  if (!zeros.uncounted_limits.empty() && !options.judge) {
    return proof::not_applicable(
        "the limits on rates, singular values or clearances are not judged");
  }
  Proof out = proof::enclose_solutions(zeros, options);
  if (out.status != ProofStatus::NotApplicable) return out;
  // The equations leave freedom: enclose where the nominal objective vanishes.
  zeros.zero = row_of(problem.objective.front().quantity).zero_momentum;
  if (problem.objective.size() != 1 || !zeros.zero) return out;
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
