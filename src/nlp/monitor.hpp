// What stands between a problem and every solver: one model evaluation per point, the best point so
// far, budget, deadline, interruption, NaN and exceptions. No adapter does any of this itself.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <exception>
#include <memory>
#include <stillbase/nlp/optimizer.hpp>
#include <vector>

namespace stillbase::nlp {

/// A violation within the tolerance buys a lower objective, so that the lowest f may belong to an
/// iterate from before the last digits were found. Objectives up to this are as good as `objective`
/// to first order: f + 2 |multipliers|_1 feasibility_tolerance, and rounding.
double as_good_as(double objective, const Eigen::VectorXd& multipliers,
                  const OptimizeOptions& options);

class Monitor {
 public:
  /// `with_derivatives`: every evaluation brings derivatives. Even where a line search only asks
  /// for the value this is cheaper than evaluating the accepted point twice. `max_evaluations`:
  /// what the solver may use.
  Monitor(const Problem& problem, const OptimizeOptions& options, bool with_derivatives,
          int max_evaluations);
  Monitor(const Monitor&) = delete;
  Monitor& operator=(const Monitor&) = delete;
  ~Monitor();

  /// From now on the solver is stopped at a point, as good as the best one, whose violation and KKT
  /// residual are OptimizeOptions::certain of the tolerances; that point is then the best one.
  void stop_when_certified() { stops_when_certified_ = true; }

  /// From now on inequalities that hold by more than this may be given as Evaluation::far says.
  void leave_far_rows(double far) { far_ = far; }
  double far() const { return far_; }

  /// Values (and derivatives) at x (N doubles), moved into the box where rounding left it. Null
  /// when the point is rejected (NaN or infinity) or the solver has to stop: ask stopped(). The
  /// pointer holds until the next call. Safe in any callback: never throws.
  const Evaluation* evaluate(const double* x) noexcept;

  /// Hessian of the Lagrangian; false when it has NaN or infinity or the solver has to stop.
  bool lagrangian_hessian(const double* x, double sigma, const double* multipliers,
                          Eigen::MatrixXd& out) noexcept;

  /// The start, with derivatives, whatever budget and deadline say. False: it is not finite.
  bool evaluate_start(const Eigen::VectorXd& x) noexcept;

  /// Adds the derivatives at the best point when they are missing, whatever the budget says.
  void complete_best() noexcept;

  bool stopped() const { return stop_ != StopReason::SolverEnded; }
  StopReason stop_reason() const { return stop_; }
  void stop(StopReason reason) {
    if (!stopped()) stop_ = reason;
  }
  /// Throws what the problem threw.
  void rethrow() const {
    if (exception_) std::rethrow_exception(exception_);
  }

  /// Takes a point that was just evaluated for the best one, where it is as good.
  /// @return whether it is the best one now
  bool prefer(const Eigen::VectorXd& x, const Eigen::VectorXd& multipliers);

  /// A finite objective worse than all seen, for solvers that cannot take a refusal or infinity.
  double rejection_value() const;

  bool has_best() const { return best_.valid; }
  const Eigen::VectorXd& best_x() const { return best_.x; }
  const Evaluation& best() const { return best_.evaluation; }
  /// Of the best point, after a stop for it; else null.
  const Certificate* certificate() const {
    return stop_ == StopReason::Certified ? &certificate_ : nullptr;
  }

  /// Calls visit(x, evaluation) for the feasible points of late that have derivatives and an
  /// objective of at most `limit`, newest first, until it returns true.
  template <class Visit>
  void visit_recent(double limit, Visit visit) const {
    for (std::size_t back = 1; back <= known(); ++back) {
      const Point& point = recent(back);
      const bool fits = point.valid && point.has_derivatives && point.feasible;
      if (fits && point.evaluation.objective <= limit && visit(point.x, point.evaluation)) return;
    }
  }

  const Problem& problem() const { return problem_; }
  const Eigen::VectorXd& lower() const { return lower_; }
  const Eigen::VectorXd& upper() const { return upper_; }
  const Eigen::VectorXd& constraint_lower() const { return constraint_lower_; }
  const Eigen::VectorXd& constraint_upper() const { return constraint_upper_; }

  int evaluations() const { return evaluations_; }
  int gradient_evaluations() const { return gradient_evaluations_; }
  int hessian_evaluations() const { return hessian_evaluations_; }
  int rejected_evaluations() const { return rejected_evaluations_; }

 private:
  struct Point {
    Eigen::VectorXd x;
    Evaluation evaluation;
    bool valid = false;  // finite
    bool has_derivatives = false;
    bool feasible = false;
    double violation_squared = kInfinity;
  };
  /// What is kept of a solve for the next one on this thread, so that it need not allocate.
  struct Memory {
    // Solvers ask for one point in several callbacks, and line searches and restoration phases come
    // back to points of some steps ago (13 seen with ipopt, 26 in a cycle of nlopt-auglag-mma).
    std::array<Point, 32> recent;
    Workspace workspace;  ///< one for all points
  };
  static std::vector<std::unique_ptr<Memory>>& unused_memory();

  /// Points of late that are kept.
  std::size_t known() const { return std::min(taken_, memory_->recent.size()); }
  /// The one that was evaluated last for 1, and so on.
  const Point& recent(std::size_t back) const {
    return memory_->recent[(taken_ - back) % memory_->recent.size()];
  }
  /// The slot of the next one.
  Point& next() { return memory_->recent[taken_++ % memory_->recent.size()]; }

  bool may_go_on();
  void keep_exception();  // in a handler only
  void run_model(Point& point, bool with_derivatives);
  const Point* find_known(const Eigen::VectorXd& x) const;
  void keep_if_best(const Point& point);
  void stop_if_certified(const Point& point);
  void stop_if_asked(const Point& point);

  const Problem& problem_;
  const OptimizeOptions& options_;
  const bool with_derivatives_;
  const int max_evaluations_;
  const Eigen::VectorXd lower_, upper_, constraint_lower_, constraint_upper_;

  Eigen::VectorXd trial_, multipliers_;
  std::unique_ptr<Memory> memory_;
  std::size_t taken_ = 0;  // slots of memory_, used again and again
  Point best_;
  Certificate certificate_;
  double worst_objective_ = -kInfinity;
  bool stops_when_certified_ = false;
  double far_ = kInfinity;
  double last_objective_ = kInfinity;
  int evaluations_ = 0;
  int gradient_evaluations_ = 0;
  int hessian_evaluations_ = 0;
  int rejected_evaluations_ = 0;
  int rejected_in_a_row_ = 0;
  int repeats_in_a_row_ = 0;
  StopReason stop_ = StopReason::SolverEnded;
  std::exception_ptr exception_;
};

}  // namespace stillbase::nlp
