#include "nlp/monitor.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <stillbase/core/linear_algebra.hpp>

namespace stillbase::nlp {
namespace {

bool is_same(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return a.size() == b.size() && (a.array() == b.array()).all();
}

}  // namespace

double as_good_as(double objective, const Eigen::VectorXd& multipliers,
                  const OptimizeOptions& options) {
  return objective + 2.0 * multipliers.lpNorm<1>() * options.feasibility_tolerance +
         1e-14 * std::abs(objective);
}

Monitor::Monitor(const Problem& problem, const OptimizeOptions& options, bool with_derivatives,
                 int max_evaluations)
    : problem_(problem),
      options_(options),
      with_derivatives_(with_derivatives),
      max_evaluations_(max_evaluations),
      lower_(problem.lower()),
      upper_(problem.upper()),
      constraint_lower_(problem.constraint_lower()),
      constraint_upper_(problem.constraint_upper()),
      trial_(problem.num_variables()),
      multipliers_(problem.num_constraints()) {
  std::vector<std::unique_ptr<Memory>>& unused = unused_memory();
  unused.reserve(2);  // of a solve and one within it
  if (unused.empty()) unused.push_back(std::make_unique<Memory>());
  memory_ = std::move(unused.back());
  unused.pop_back();
}

Monitor::~Monitor() {
  std::vector<std::unique_ptr<Memory>>& unused = unused_memory();
  if (unused.size() < unused.capacity()) unused.push_back(std::move(memory_));
}

std::vector<std::unique_ptr<Monitor::Memory>>& Monitor::unused_memory() {
  static thread_local std::vector<std::unique_ptr<Memory>> unused;
  return unused;
}

bool Monitor::may_go_on() {
  if (stopped()) return false;
  if (options_.stop.is_interrupted()) {
    stop_ = StopReason::Interrupted;
  } else if (options_.stop.is_late()) {
    stop_ = StopReason::Deadline;
  } else if (evaluations_ >= max_evaluations_) {
    stop_ = StopReason::EvaluationLimit;
  }
  return !stopped();
}

void Monitor::keep_exception() {
  exception_ = std::current_exception();
  stop_ = StopReason::NonFinite;  // any reason will do: the exception leaves minimize() instead
}

void Monitor::run_model(Point& point, bool with_derivatives) {
  point.valid = false;
  point.has_derivatives = false;
  ++evaluations_;
  Evaluation& e = point.evaluation;
  e.constraints.resize(multipliers_.size());  // it may be that of another solve
  if (with_derivatives) {
    ++gradient_evaluations_;
    e.far = far_;
    e.gradient.resize(trial_.size());
    e.jacobian.resize(multipliers_.size(), trial_.size());
    std::swap(e.workspace, memory_->workspace);
    problem_.evaluate(point.x, e);
    std::swap(e.workspace, memory_->workspace);
  } else {
    problem_.evaluate_value(point.x, e);
  }
  const bool finite = std::isfinite(e.objective) && are_finite(e.constraints) &&
                      (!with_derivatives || (are_finite(e.gradient) && are_finite(e.jacobian)));
  if (!finite) {
    ++rejected_evaluations_;
    if (++rejected_in_a_row_ >= options_.max_rejected_in_a_row) stop(StopReason::NonFinite);
    return;
  }
  rejected_in_a_row_ = 0;
  worst_objective_ = std::max(worst_objective_, e.objective);
  point.valid = true;
  point.has_derivatives = with_derivatives;
  point.feasible = true;
  point.violation_squared = 0.0;
  for (Eigen::Index i = 0; i < e.constraints.size(); ++i) {
    const double g = e.constraints[i];
    const double v = std::max({g - constraint_upper_[i], constraint_lower_[i] - g, 0.0});
    point.feasible = point.feasible && v <= options_.feasibility_tolerance;
    point.violation_squared += v * v;
  }
}

const Monitor::Point* Monitor::find_known(const Eigen::VectorXd& x) const {
  // Newest first: it is asked for once per callback.
  for (std::size_t back = 1; back <= known(); ++back) {
    if (is_same(x, recent(back).x)) return &recent(back);
  }
  return is_same(x, best_.x) ? &best_ : nullptr;
}

void Monitor::keep_if_best(const Point& point) {
  if (!point.valid) return;
  const bool better =
      !best_.valid || (point.feasible != best_.feasible ? point.feasible
                       : point.feasible ? point.evaluation.objective < best_.evaluation.objective
                                        : point.violation_squared < best_.violation_squared);
  if (better) best_ = point;
}

void Monitor::stop_if_certified(const Point& point) {
  const double before = std::exchange(last_objective_, point.evaluation.objective);
  const double objective = point.evaluation.objective;
  const double size = std::max(std::abs(objective), problem_.objective_scale());
  if (!point.valid || !(std::abs(objective - before) <= options_.last_change * size)) return;
  const double violation = options_.certain * options_.feasibility_tolerance;
  if (point.violation_squared > violation * violation) return;
  Certificate found = certify(problem_, point.x, point.evaluation);
  if (found.kkt_residual > options_.certain * options_.optimality_tolerance) return;
  if (objective > as_good_as(best_.evaluation.objective, found.multipliers, options_)) return;
  if (stopped()) return;
  best_ = point;
  certificate_ = std::move(found);
  stop(StopReason::Certified);
}

void Monitor::stop_if_asked(const Point& point) {
  if (!options_.ends_at || !point.valid) return;
  if (options_.ends_at(point.x, point.evaluation)) stop(StopReason::Asked);
}

const Evaluation* Monitor::evaluate(const double* x) noexcept {
  try {
    trial_ = Eigen::Map<const Eigen::VectorXd>(x, trial_.size()).cwiseMax(lower_).cwiseMin(upper_);
    for (Eigen::Index j = 0; j < trial_.size(); ++j) {
      if (!std::isfinite(x[j])) {  // the solver's own overflow; cwiseMax would hide a NaN
        if (++rejected_in_a_row_ >= options_.max_rejected_in_a_row) stop(StopReason::NonFinite);
        return nullptr;
      }
    }
    if (const Point* known = find_known(trial_)) {
      if (++repeats_in_a_row_ >= options_.max_repeats_in_a_row) stop(StopReason::Stalled);
      return known->valid ? &known->evaluation : nullptr;
    }
    if (!may_go_on()) return nullptr;
    repeats_in_a_row_ = 0;
    Point& point = next();
    point.x = trial_;
    run_model(point, with_derivatives_);
    keep_if_best(point);
    if (stops_when_certified_) stop_if_certified(point);
    stop_if_asked(point);
    return point.valid ? &point.evaluation : nullptr;
  } catch (...) {
    keep_exception();
    return nullptr;
  }
}

bool Monitor::lagrangian_hessian(const double* x, double sigma, const double* multipliers,
                                 Eigen::MatrixXd& out) noexcept {
  try {
    if (stopped() || (options_.stop.reached() && !may_go_on())) return false;
    trial_ = Eigen::Map<const Eigen::VectorXd>(x, trial_.size()).cwiseMax(lower_).cwiseMin(upper_);
    multipliers_ = Eigen::Map<const Eigen::VectorXd>(multipliers, multipliers_.size());
    ++hessian_evaluations_;
    problem_.lagrangian_hessian(trial_, sigma, multipliers_, out);
    return out.allFinite();
  } catch (...) {
    keep_exception();
    return false;
  }
}

bool Monitor::evaluate_start(const Eigen::VectorXd& x) noexcept {
  try {
    Point& point = next();
    point.x = x;
    run_model(point, true);
    keep_if_best(point);
    stop_if_asked(point);
    return point.valid;
  } catch (...) {
    keep_exception();
    return false;
  }
}

void Monitor::complete_best() noexcept {
  if (!best_.valid || best_.has_derivatives) return;
  try {
    Point completed;
    completed.x = best_.x;
    run_model(completed, true);
    // Without finite derivatives the values still stand; there is no certificate then.
    if (completed.valid) best_ = completed;
  } catch (...) {
    keep_exception();
  }
}

bool Monitor::prefer(const Eigen::VectorXd& x, const Eigen::VectorXd& multipliers) {
  const Point* point = find_known(x);
  if (point == nullptr || !point->valid || !point->feasible) return false;
  const double limit = as_good_as(best_.evaluation.objective, multipliers, options_);
  if (!(point->evaluation.objective <= limit)) return false;
  best_ = *point;
  return true;
}

double Monitor::rejection_value() const {
  return std::isfinite(worst_objective_)
             ? worst_objective_ + 10.0 * (1.0 + std::abs(worst_objective_))
             : 1e10;
}

}  // namespace stillbase::nlp
