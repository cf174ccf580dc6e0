// Which proof belongs to which capture problem, and the zeros of its equations enclosed.
#include <stillbase/proof/proof.hpp>

#include <algorithm>
#include <cmath>

#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/core/random.hpp>

#include <stillbase/proof/minimum.hpp>

#include "proof/case_rows.hpp"
#include "proof/enclose.hpp"

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

/// Two unit vectors normal to f and to each other.
std::pair<Vector3d, Vector3d> normals_of(const Vector3d& f) {
  int smallest = 0;
  f.cwiseAbs().minCoeff(&smallest);
  const Vector3d u = f.cross(Vector3d(Vector3d::Unit(smallest))).normalized();
  return {u, f.cross(u).normalized()};
}

/// All equations, those that may vanish identically included.
std::vector<Row> all_rows(const ZeroProblem& problem) {
  std::vector<Row> rows = problem.hand_equations;
  const VariableEncounter& encounter = problem.encounter;
  const CaseConstraint wanted = problem.impact_case;
  bool total =
      wanted == CaseConstraint::C || wanted == CaseConstraint::C1 || wanted == CaseConstraint::C2;
  const bool coupling = wanted == CaseConstraint::C2 || wanted == CaseConstraint::G3;
  bool base = wanted == CaseConstraint::G2;
  if (problem.zero && wanted != CaseConstraint::C2) {
    (*problem.zero == ResponsePart::TotalAngularMomentum ? total : base) = true;
  }
  if (total) {
    // Without a moment L = r x f is normal to f: two components say it all.
    const bool is_fixed = encounter.is_fixed();
    const Vector3d f = is_fixed ? Vector3d(encounter.stated.F.head<3>()) : encounter.n;
    const auto [u, v] = normals_of(f);
    rows.push_back({RowKind::Total, 0, u});
    rows.push_back({RowKind::Total, 1, v});
    const bool has_moment =
        is_fixed ? !encounter.stated.F.tail<3>().isZero(0) : !encounter.moment.isZero(0);
    if (has_moment) rows.push_back({RowKind::Total, 2, f.normalized()});
  }
  for (int i = 0; i < 3; ++i) {
    if (base) rows.push_back({RowKind::Base, i});
    if (coupling) {
      rows.push_back({total ? RowKind::CouplingAtZeroTotal : RowKind::Coupling, i});
    }
  }
  return rows;
}

template <int N>
class RowSystem final : public System<N> {
 public:
  RowSystem(const ZeroProblem& problem, const std::vector<Row>& rows)
      : problem_(problem), rows_(rows) {}

  void evaluate(const std::array<Dual, N>& x, std::array<Dual, N>& f) const override { fill(x, f); }
  bool evaluate(const std::array<Quadratic<N>, N>& x,
                std::array<Quadratic<N>, N>& f) const override {
    if constexpr (N == 1) {
      // As forms of two variables, the second of which does not occur: one type less to compile.
      std::array<Quadratic<2>, 1> wide{x[0].c()};
      wide[0].coefficient[1] = x[0].a(0);
      const Quadratic<2> row = evaluate_rows<Quadratic<2>>(problem_, rows_, wide).front();
      f[0].coefficient = {row.c(), row.a(0), row.q(0, 0)};
      f[0].r = row.r;
    } else {
      fill(x, f);
    }
    return true;
  }
  bool excludes(const Box<N>& box) const override { return kept_over(box) == Kept::No; }

  /// Whether the inequalities hold over a box.
  Kept kept_over(const Box<N>& box) const {
    std::array<Dual, N> x;
    for (int i = 0; i < N; ++i) x[static_cast<std::size_t>(i)] = Dual(box[i]);
    return keeps_inequalities(problem_, x);
  }

 private:
  template <class S>
  void fill(const std::array<S, N>& x, std::array<S, N>& f) const {
    const std::vector<S> values = evaluate_rows<S>(problem_, rows_, x);
    std::copy(values.begin(), values.end(), f.begin());
  }

  const ZeroProblem& problem_;
  const std::vector<Row>& rows_;
};

/// How it is decided whether to enclose at all, in plain doubles: no proof depends on it.
struct SurveyOptions {
  int samples = 16;     ///< points at which the sizes of the rows are taken
  double zero = 1e-10;  ///< rows below this part of the largest one of their kind say nothing
  int starts = 48;      ///< of Newton's steps
  int max_steps = 30;
  double longest_step = 0.5;  ///< rad
  double pivot = 1e-15;       ///< pivots below this part of the largest count as zero
  double solved = 1e-11;      ///< residual of the scaled rows
  double rank = 1e-7;         ///< singular values below this part of the largest count as zero
  int enough = 4;             ///< solutions of deficient rank that decide
};

/// The rows that say something, with their sizes, and the variables that they depend on.
template <int N>
struct Survey {
  std::vector<Row> rows;
  std::array<bool, N> matters{};
};

/// Sizes of the rows over evenly spread points; rows that vanish everywhere are dropped.
template <int N>
Survey<N> survey_of(const ZeroProblem& problem, std::vector<Row> rows) {
  const SurveyOptions options;
  const Box<N> domain = domain_of<N>(problem.encounter);
  const std::size_t num_rows = rows.size();
  for (int i = 0; i < 3; ++i) rows.push_back({RowKind::Total, i, Vector3d::Unit(i)});
  std::vector<double> size(rows.size(), 0);
  std::vector<std::array<double, N>> slopes(rows.size(), std::array<double, N>{});
  for (int sample = 0; sample < options.samples; ++sample) {
    const Eigen::VectorXd u = low_discrepancy_point(sample, N, 0);
    std::array<Dual, N> x;
    for (int i = 0; i < N; ++i) {
      const double at = domain[i].lower() + u[i] * (domain[i].upper() - domain[i].lower());
      x[static_cast<std::size_t>(i)] = Dual(Interval(at), i, N);
    }
    const auto values = evaluate_rows<Dual>(problem, rows, x);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      size[r] = std::max(size[r], boost::numeric::norm(values[r].v));
      for (std::size_t i = 0; i < N; ++i) {
        const double slope = boost::numeric::norm(values[r].d[i]);
        size[r] = std::max(size[r], slope);
        slopes[r][i] = std::max(slopes[r][i], slope);
      }
    }
  }
  Survey<N> out;
  for (std::size_t r = 0; r < num_rows; ++r) {
    // The base part is what remains of the total.
    const bool is_part = rows[r].kind == RowKind::Base;
    double largest = 0;
    for (std::size_t q = 0; q < rows.size(); ++q) {
      const bool is_larger = is_part && rows[q].kind == RowKind::Total;
      if (rows[q].kind == rows[r].kind || is_larger) largest = std::max(largest, size[q]);
    }
    if (!(size[r] > options.zero * largest)) continue;
    rows[r].scale = std::exp2(std::round(std::log2(size[r])));  // divides without rounding
    out.rows.push_back(rows[r]);
    for (std::size_t i = 0; i < N; ++i) {
      out.matters[i] = out.matters[i] || slopes[r][i] > options.zero * size[r];
    }
  }
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

template <int N>
JointBox joint_box(const VariableEncounter& encounter, const Box<N>& box) {
  JointBox out{encounter.start, encounter.start, {}, {}};
  for (std::size_t i = 0; i < N; ++i) {
    const Variable& variable = encounter.variables[i];
    const double lower = box.side[i].lower(), upper = box.side[i].upper();
    if (variable.kind == VariableKind::Joint) {
      out.lower[variable.joint] = lower;
      out.upper[variable.joint] = upper;
    } else if (variable.kind == VariableKind::BaseAngle) {
      out.base_angle = Ends{lower, upper};
    } else if (variable.kind == VariableKind::Time) {
      out.contact_time = Ends{lower * encounter.time_unit, upper * encounter.time_unit};
    }
  }
  return out;
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
  if (problem.has_limits) {
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
  const RowSystem<N> system(problem, rows);
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
    } else if (problem.has_limits) {
      within = judged(box, options);
    }
    beyond_limits += within == WithinLimits::No;
    if (within == WithinLimits::Yes) out.solutions.push_back(box);
    if (within == WithinLimits::Undecided) out.undecided.push_back(box);
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

}  // namespace
}  // namespace stillbase::proof

namespace stillbase {

Proof prove(const CaptureProblem& problem, const ProofOptions& options) {
  const std::string reason = proof::objection(problem);
  if (!reason.empty()) return proof::not_applicable(reason);
  proof::ZeroProblem zeros = proof::zero_problem(problem);
  if (zeros.has_limits && !options.judge) {
    return proof::not_applicable(
        "nobody judges the limits on rates, singular values or clearances");
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
