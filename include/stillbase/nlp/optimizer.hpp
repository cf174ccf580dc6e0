// One interface for all optimizers, and one judge of their answers.
//
// Assumptions: those of problem.hpp. The solver's own word never decides: status, point and numbers
// of a result come from our own evaluations; the native code and text are kept beside them.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/interrupt.hpp>
#include <stillbase/nlp/certificate.hpp>
#include <stillbase/nlp/problem.hpp>

namespace stillbase::nlp {

struct OptimizeOptions {
  /// Evaluations of the model, at least 1 (the start is always judged). A local solver needs 10 to
  /// 300, population methods some 10000; the bound is for those that never stop by themselves.
  int max_evaluations = 20000;
  /// Asked before every evaluation; one evaluation is done even when it is already reached.
  StopCondition stop = {};
  /// Largest violation of a feasible point: far above the rounding of a few hundred operations on
  /// numbers of order one.
  double feasibility_tolerance = kFeasibilityTolerance;
  /// Largest KKT residual of an optimal point. Half the digits of a double: what superlinear
  /// solvers reach safely, and an error of the objective of about its square.
  double optimality_tolerance = 1e-6;
  std::uint64_t seed = 1;  ///< for the stochastic solvers; any number
  /// When the solver ends or reaches its budget at a violated point that is no local minimum of the
  /// violation, minimise the violation from there: the result is a feasible point, from which the
  /// caller may start once more, or "infeasible" is said with a reason. Takes at most
  /// explain_evaluations and a tenth of max_evaluations, kept back from the solver. The message
  /// says when it was done.
  bool explain_infeasibility = true;
  int explain_evaluations = 200;  ///< enough for a dozen variables several times over
  /// Relative slope of a violation below which it is at a local minimum. Solvers that minimise a
  /// penalty stop at about 1e-4 of it; anywhere else the slope is of order one.
  double flat_violation = 1e-3;
  /// Part of the tolerances at which a solver is stopped. A tenth would not do: where the objective
  /// is flat, the residual says little about the distance.
  double certain = 1e-3;
  /// A step that changes the objective by more than this part is not the last one: its point needs
  /// no certificate, which costs half an evaluation of a small model.
  double last_change = 1e-6;
  /// A line search that halves its step 60 times has reached the rounding of its own point.
  int max_rejected_in_a_row = 60;
  /// Solvers ask for one point a few times (objective, constraints, gradients). One that asks for
  /// it this often is in a loop that the evaluation budget alone would never end.
  int max_repeats_in_a_row = 1000;
  /// Leave the solver's options as its authors set them instead of OptimizerInfo::tuning: what a
  /// user gets who does not read the manual. For comparisons. Ipopt's linear systems are solved as
  /// always.
  bool library_defaults = false;
  /// At least 0, or minimize() throws std::invalid_argument. Inequalities that hold by more need no
  /// evaluation: see Evaluation::far, to which their rows of OptimizeResult::constraints are then
  /// cut. For `sqp`, others evaluate all.
  double far = kInfinity;
  /// Asked at every new point that the model is defined at, with its values (and derivatives, where
  /// the solver uses them); true ends the solve. May be empty.
  std::function<bool(const Eigen::VectorXd& x, const Evaluation& at_x)> ends_at = {};
};

/// Verdict on the point of a result.
enum class Status {
  Optimal,      ///< feasible, KKT residual within the tolerance, however the solver stopped
  Feasible,     ///< feasible, the solver ended by itself, not shown to be optimal
  Infeasible,   ///< violated, and no small step lessens the violation: a local statement
  Limit,        ///< budget or deadline reached; the point may be feasible (see feasible)
  Interrupted,  ///< asked to stop; the point may be feasible (see feasible)
  Failed,       ///< no finite point, a request the solver cannot take, or it gave up
};

/// Why the evaluations ended.
enum class StopReason {
  SolverEnded,      ///< see native_status
  EvaluationLimit,  ///< max_evaluations
  Deadline,
  Interrupted,
  NonFinite,  ///< the model gave NaN or infinity at the start, or too often in a row
  Stalled,    ///< the solver asked for the same point many times, or left a violation as it is
  Certified,  ///< our own residuals are far below the tolerances
  Asked,      ///< OptimizeOptions::ends_at said so
  Refused,    ///< nothing was run: see message
};

std::string_view to_string(Status status);      ///< "optimal", "feasible", ...
std::string_view to_string(StopReason reason);  ///< "solver ended", "evaluation limit", ...

struct OptimizeResult {
  Status status = Status::Failed;
  StopReason stop = StopReason::Refused;
  bool feasible = false;  ///< certificate.max_violation <= feasibility_tolerance
  /// Best point that was evaluated, inside its box: among feasible ones the lowest f, else the
  /// least sum of squared violations. The start (moved into the box) when nothing finite was seen.
  Eigen::VectorXd x;
  double objective = kInfinity;  ///< f(x); infinite when nothing finite was seen
  Eigen::VectorXd constraints;   ///< g(x) (m); empty when nothing finite was seen
  Certificate certificate;       ///< at x
  int evaluations = 0;           ///< of the model; at most one per distinct point in a row
  int gradient_evaluations = 0;  ///< those of them with derivatives
  int hessian_evaluations = 0;   ///< of lagrangian_hessian, apart
  int rejected_evaluations = 0;  ///< those that gave NaN or infinity
  /// `sqp` alone: it ended where the gradients of both sides of a kink of some inequality, which it
  /// has seen, leave no way down. The certificate has those of one side, its KKT residual is large.
  bool at_kink = false;
  std::string optimizer;
  int native_code = 0;        ///< the library's return code
  std::string native_status;  ///< its text; empty when it was not called
  std::string message;        ///< our remarks, in words; may be empty
};

/// What an optimizer is and asks for.
struct OptimizerInfo {
  std::string name;   ///< as in the registry
  std::string about;  ///< one line
  bool uses_gradient = true;
  bool uses_hessian = false;  ///< where the problem has one
  bool global = false;        ///< the start is a hint at most; needs finite bounds
  bool stochastic = false;    ///< uses the seed
  int min_variables = 1;
  std::string library = {};  ///< whose code it is, with version; empty: our own
  std::string tuning = {};   ///< its options that differ from the library's defaults, in words
};

class Monitor;  // src/nlp/monitor.hpp

/// What a solver said when it ended.
struct NativeOutcome {
  int code = 0;
  std::string status;
  std::string remark;    ///< appended to OptimizeResult::message
  bool at_kink = false;  ///< see OptimizeResult
};

/// An optimizer. Has no state between calls: one object may be used by several threads, each with
/// its own problem object.
class Optimizer {
 public:
  explicit Optimizer(OptimizerInfo info) : info_(std::move(info)) {}
  virtual ~Optimizer() = default;
  Optimizer(const Optimizer&) = delete;
  Optimizer& operator=(const Optimizer&) = delete;

  const OptimizerInfo& info() const { return info_; }

  /// Runs the solver from x0 (N, finite; moved into the box first, which the message says) and
  /// judges what it found. Same arguments, same bytes (deadline apart). Never throws for an
  /// algorithm that does not succeed; an exception of the problem is rethrown after the solver has
  /// ended. A local solver with gradients is stopped at a point whose violation and KKT residual
  /// are a thousandth of the tolerances: what solvers do after that is lost in rounding (not with
  /// library_defaults). A malformed request (sizes, NaN, crossed bounds, missing bounds of a global
  /// solver) is refused: Failed, nothing evaluated (crossed bounds: Infeasible).
  [[nodiscard]] OptimizeResult minimize(const Problem& problem, const Eigen::VectorXd& x0,
                                        const OptimizeOptions& options = {}) const;

 private:
  /// The adapter's part: runs the solver with every evaluation through the monitor, which keeps the
  /// best point. `start` is inside the box and its evaluation cached.
  virtual NativeOutcome solve(Monitor& monitor, const Eigen::VectorXd& start,
                              const OptimizeOptions& options) const = 0;

  OptimizerInfo info_;
};

/// Names of all optimizers of this build, in the order of the documentation.
[[nodiscard]] std::vector<std::string> optimizer_names();

/// The optimizer of that name; null when there is none.
[[nodiscard]] std::unique_ptr<Optimizer> make_optimizer(std::string_view name);

}  // namespace stillbase::nlp
