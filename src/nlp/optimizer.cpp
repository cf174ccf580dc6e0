#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "nlp/monitor.hpp"

namespace stillbase::nlp {
namespace {

struct Refusal {
  Status status = Status::Failed;
  std::string message;
};

bool has_nan(const Eigen::VectorXd& v) { return v.hasNaN(); }

// Empty message: the request can be run.
Refusal check(const Problem& problem, const Eigen::VectorXd& x0, const OptimizerInfo& info) {
  const int n = problem.num_variables(), m = problem.num_constraints();
  if (n < 1 || m < 0) return {Status::Failed, "the problem has no variables"};
  if (n < info.min_variables) {
    return {Status::Failed,
            info.name + " needs at least " + std::to_string(info.min_variables) + " variables"};
  }
  const Eigen::VectorXd lower = problem.lower(), upper = problem.upper();
  const Eigen::VectorXd g_lower = problem.constraint_lower(), g_upper = problem.constraint_upper();
  if (x0.size() != n || lower.size() != n || upper.size() != n) {
    return {Status::Failed, "start and bounds must have one number per variable"};
  }
  if (g_lower.size() != m || g_upper.size() != m) {
    return {Status::Failed, "constraint bounds must have one number per constraint"};
  }
  if (!x0.allFinite()) return {Status::Failed, "the start is not finite"};
  if (has_nan(lower) || has_nan(upper) || has_nan(g_lower) || has_nan(g_upper)) {
    return {Status::Failed, "a bound is not a number"};
  }
  for (int j = 0; j < n; ++j) {
    const std::string variable = "variable " + std::to_string(j);
    if (lower[j] > upper[j] || lower[j] == kInfinity || upper[j] == -kInfinity) {
      return {Status::Infeasible, variable + " has crossed bounds"};
    }
    if (info.global && (std::isinf(lower[j]) || std::isinf(upper[j]))) {
      return {Status::Failed, info.name + " needs finite bounds; " + variable + " has none"};
    }
  }
  for (int i = 0; i < m; ++i) {
    if (g_lower[i] > g_upper[i] || g_lower[i] == kInfinity || g_upper[i] == -kInfinity) {
      return {Status::Infeasible, "constraint " + std::to_string(i) + " has crossed bounds"};
    }
  }
  return {};
}

void remark(OptimizeResult& result, std::string_view text) {
  if (text.empty()) return;
  if (!result.message.empty()) result.message += "; ";
  result.message += text;
}

void take_point(OptimizeResult& result, const Eigen::VectorXd& x, const Evaluation& at_x,
                Certificate certificate, const OptimizeOptions& options) {
  result.x = x;
  result.objective = at_x.objective;
  result.constraints = at_x.constraints;
  result.certificate = std::move(certificate);
  result.feasible = result.certificate.max_violation <= options.feasibility_tolerance;
}

// Of the points that are as good as the best one, take one that can be certified.
void prefer_certified(OptimizeResult& result, const Monitor& monitor,
                      const OptimizeOptions& options) {
  if (!result.feasible || result.certificate.kkt_residual <= options.optimality_tolerance) return;
  const double limit = as_good_as(result.objective, result.certificate.multipliers, options);
  monitor.visit_recent(limit, [&](const Eigen::VectorXd& x, const Evaluation& at_x) {
    Certificate found = certify(monitor.problem(), x, at_x);
    if (found.kkt_residual > options.optimality_tolerance) return false;
    take_point(result, x, at_x, std::move(found), options);
    return true;
  });
}

// Evaluations kept back from the solver for explain().
int explain_budget(const OptimizeOptions& options) {
  return options.explain_infeasibility
             ? std::min(options.explain_evaluations, options.max_evaluations / 10)
             : 0;
}

// V(x) = 1/2 sum violation^2 in the box. Its gradient J^T violation is continuous, which is all
// that is needed.
class ViolationProblem final : public Problem {
 public:
  explicit ViolationProblem(const Problem& problem)
      : problem_(problem),
        constraint_lower_(problem.constraint_lower()),
        constraint_upper_(problem.constraint_upper()) {}

  int num_variables() const override { return problem_.num_variables(); }
  int num_constraints() const override { return 0; }
  Eigen::VectorXd lower() const override { return problem_.lower(); }
  Eigen::VectorXd upper() const override { return problem_.upper(); }
  Eigen::VectorXd constraint_lower() const override { return {}; }
  Eigen::VectorXd constraint_upper() const override { return {}; }

  void evaluate(const Eigen::VectorXd& x, Evaluation& out) const override {
    auto& inner = out.workspace.as<Evaluation>();
    problem_.evaluate(x, inner);
    const Eigen::VectorXd violation =
        signed_violation(inner.constraints, constraint_lower_, constraint_upper_);
    out.objective = 0.5 * violation.squaredNorm();
    // A NaN compares false with both bounds and would look like no violation.
    if (!inner.constraints.allFinite()) out.objective = kInfinity;
    out.gradient = inner.jacobian.transpose().lazyProduct(violation);
    out.constraints.resize(0);
    out.jacobian.resize(0, x.size());
  }

 private:
  const Problem& problem_;
  const Eigen::VectorXd constraint_lower_, constraint_upper_;
};

// A violated point that the solver left for no visible reason: say why, or take the nearest
// attempt.
void explain(OptimizeResult& result, const Problem& problem, const OptimizeOptions& options) {
  const int budget = explain_budget(options) - 1;
  if (budget < 1) return;
  OptimizeOptions inner = options;
  inner.max_evaluations = budget;
  inner.explain_infeasibility = false;
  inner.ends_at = nullptr;  // of another problem
  const OptimizeResult nearest =
      make_optimizer("sqp")->minimize(ViolationProblem(problem), result.x, inner);
  Evaluation at_x;
  problem.evaluate(nearest.x, at_x);
  result.evaluations += nearest.evaluations + 1;
  result.gradient_evaluations += nearest.evaluations + 1;
  const Certificate found = certify(problem, nearest.x, at_x);
  const bool feasible = found.max_violation <= options.feasibility_tolerance;
  if (!feasible && found.violation_slope > options.flat_violation) return;
  take_point(result, nearest.x, at_x, found, options);
  remark(result,
         "the solver left a violated point; this one was found by minimising the violation");
  if (!feasible) {
    result.status = Status::Infeasible;
  } else if (result.status == Status::Failed) {
    result.status = Status::Feasible;
  }
}

void judge(OptimizeResult& result, const Problem& problem, const OptimizeOptions& options) {
  const Certificate& certificate = result.certificate;
  const bool limited =
      result.stop == StopReason::EvaluationLimit || result.stop == StopReason::Deadline;
  if (result.stop == StopReason::Interrupted) {
    result.status = Status::Interrupted;
  } else if (result.feasible && certificate.kkt_residual <= options.optimality_tolerance) {
    result.status = Status::Optimal;
  } else if (!result.feasible && certificate.violation_slope <= options.flat_violation) {
    result.status = Status::Infeasible;
  } else if (limited) {
    result.status = Status::Limit;
  } else {
    result.status = result.feasible ? Status::Feasible : Status::Failed;
  }
  const bool unexplained = !result.feasible && (result.status == Status::Failed ||
                                                result.stop == StopReason::EvaluationLimit);
  if (unexplained && result.status != Status::Infeasible) explain(result, problem, options);
}

}  // namespace

// Words in the order of the enumerations.
std::string_view to_string(Status status) {
  static constexpr const char* kWords[] = {"optimal", "feasible",    "infeasible",
                                           "limit",   "interrupted", "failed"};
  return kWords[static_cast<int>(status)];
}

std::string_view to_string(StopReason reason) {
  static constexpr const char* kWords[] = {
      "solver ended", "evaluation limit", "deadline", "interrupted", "not finite",
      "stalled",      "certified",        "asked",    "refused"};
  return kWords[static_cast<int>(reason)];
}

OptimizeResult Optimizer::minimize(const Problem& problem, const Eigen::VectorXd& x0,
                                   const OptimizeOptions& options) const {
  if (!(options.far >= 0)) throw std::invalid_argument("OptimizeOptions::far: must be at least 0");
  OptimizeResult result;
  result.optimizer = info_.name;
  result.x = x0;
  if (Refusal refusal = check(problem, x0, info_); !refusal.message.empty()) {
    result.status = refusal.status;
    result.message = std::move(refusal.message);
    return result;
  }

  // A solver without derivatives leaves one evaluation for the certificate.
  const int constraints = problem.num_constraints();
  const int reserved =
      (info_.uses_gradient ? 0 : 1) + (constraints > 0 ? explain_budget(options) : 0);
  Monitor monitor(problem, options, info_.uses_gradient,
                  std::max(1, options.max_evaluations - reserved));
  if (info_.uses_gradient && !info_.global && !options.library_defaults) {
    monitor.stop_when_certified();
  }
  const Eigen::VectorXd start = x0.cwiseMax(monitor.lower()).cwiseMin(monitor.upper());
  if (start != x0) remark(result, "the start was moved into the bounds");
  result.x = start;

  const bool start_is_finite = monitor.evaluate_start(start);
  monitor.rethrow();
  if (!start_is_finite && !info_.global) {
    monitor.stop(StopReason::NonFinite);
    remark(result, "the model is not finite at the start");
  } else if (!monitor.stopped()) {
    const NativeOutcome native = solve(monitor, start, options);
    result.native_code = native.code;
    result.native_status = native.status;
    result.at_kink = native.at_kink;
    remark(result, native.remark);
  }
  monitor.complete_best();
  monitor.rethrow();

  result.stop = monitor.stop_reason();
  result.evaluations = monitor.evaluations();
  result.gradient_evaluations = monitor.gradient_evaluations();
  result.hessian_evaluations = monitor.hessian_evaluations();
  result.rejected_evaluations = monitor.rejected_evaluations();
  if (!monitor.has_best()) {
    if (result.stop == StopReason::SolverEnded) result.stop = StopReason::NonFinite;
    return result;
  }
  take_point(result, monitor.best_x(), monitor.best(),
             monitor.certificate() != nullptr ? *monitor.certificate()
                                              : certify(problem, monitor.best_x(), monitor.best()),
             options);
  prefer_certified(result, monitor, options);
  result.at_kink = result.at_kink && result.x == monitor.best_x();
  judge(result, problem, options);
  return result;
}

}  // namespace stillbase::nlp
