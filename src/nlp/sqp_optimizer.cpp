// Sequential quadratic programming for small dense problems.
//
// At an iterate x with multipliers u a step d minimises
//
//   1/2 d' B d + grad f' d   subject to the linearised constraints and the bounds on x + d,
//
// B is the damped BFGS approximation of the Hessian of the Lagrangian (Powell, "A fast algorithm
// for nonlinearly constrained optimization calculations", LNM 630, 1978), and a line search lowers
// the l1 merit function f + sum mu_i violation_i. Where the linearised constraints contradict each
// other, they are relaxed by a common part (Kraft, "A software package for sequential quadratic
// programming", DFVLR-FB 88-28, 1988). The method is that of nlopt-slsqp, whose iterates it mostly
// repeats, but for steep starts; the quadratic program is solved by its dual (dense_qp.hpp), which
// takes a pass per active row and allocates nothing.
#include <algorithm>
#include <cmath>

#include "nlp/adapters.hpp"
#include "nlp/dense_qp.hpp"
#include "nlp/monitor.hpp"
#include "nlp/stuck_watch.hpp"

namespace stillbase::nlp {
namespace {

struct SqpOptions {
  double first_step = 1;    ///< longest first step without constraints, of variables of order one
  double descent = 0.1;     ///< part of the first-order fall of the merit function
  double shortest = 0.1;    ///< factor of a rejected step, and of one to an undefined point
  int halvings = 10;        ///< of one step; then it is taken, whatever the merit function says
  double damping = 0.2;     ///< least part of d' B d that the curvature of an update has
  int resets = 5;           ///< of B to its start, where a step does not descend
  double relaxation = 100;  ///< curvature of the relaxed part of the constraints, then ten times
  int relaxations = 5;      ///< it, as often as the part remains whole
  double whole = 1 - 1e-6;  ///< part that counts as whole
  double step = 1e-12;      ///< length of a step that is lost in rounding
};
constexpr SqpOptions kSqp;

/// One side of a constraint: sign (g_index - bound) >= 0, or = 0.
struct Side {
  Eigen::Index index;
  double sign, bound;
  bool is_equation;
};

std::vector<Side> sides_of(const Monitor& monitor) {
  const Eigen::VectorXd &lower = monitor.constraint_lower(), &upper = monitor.constraint_upper();
  std::vector<Side> out;
  for (Eigen::Index i = 0; i < lower.size(); ++i) {
    if (lower[i] == upper[i]) out.push_back({i, 1, lower[i], true});
  }
  for (Eigen::Index i = 0; i < lower.size(); ++i) {
    if (lower[i] == upper[i]) continue;
    if (std::isfinite(lower[i])) out.push_back({i, 1, lower[i], false});
    if (std::isfinite(upper[i])) out.push_back({i, -1, upper[i], false});
  }
  return out;
}

enum class Ended { StepLost, NoDescent, Stuck, Stopped };

/// One descent from a start.
class Descent {
 public:
  explicit Descent(Monitor& monitor)
      : monitor_(monitor),
        sides_(sides_of(monitor)),
        n_(static_cast<int>(monitor.lower().size())),
        qp_(n_ + 1, static_cast<int>(sides_.size()) + 2 * n_ + 2),
        penalties_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(sides_.size()))),
        multipliers_(penalties_) {}

  /// @pre the monitor knows the start with its derivatives, whatever budget is left
  Ended run(const Eigen::VectorXd& start, double first_step) {
    if (!look_at(start)) return Ended::Stopped;
    first_step_ = first_step;
    watch_.reset();
    watch_.look_at(worst_violation());
    reset_curvature();
    penalties_.setZero();
    int resets = 0;
    while (true) {
      const double slope = find_step() ? merit_slope() : 0;
      if (!(slope < 0)) {
        if (++resets > kSqp.resets) return Ended::NoDescent;
        reset_curvature();
        continue;
      }
      const Eigen::VectorXd before = x_;
      const Evaluation at_before = here_;
      const bool arrived = search_line(before, slope);
      if (monitor_.stopped()) return Ended::Stopped;
      if (!arrived) return Ended::NoDescent;
      if (watch_.is_stuck()) return Ended::Stuck;
      const Eigen::VectorXd moved = x_ - before;
      if (moved.lpNorm<Eigen::Infinity>() <= kSqp.step * (1 + x_.lpNorm<Eigen::Infinity>())) {
        if (++resets > kSqp.resets) return Ended::StepLost;
        reset_curvature();
        continue;
      }
      update_curvature(moved, at_before);
    }
  }

  bool is_off(double tolerance) const { return watch_.is_off(tolerance); }

 private:
  /// Makes x the iterate. False: the solver has to stop, or the point is undefined.
  bool look_at(const Eigen::VectorXd& x) {
    const Evaluation* e = monitor_.evaluate(x.data());
    if (e == nullptr) return false;
    x_ = x;
    here_.objective = e->objective;
    here_.gradient = e->gradient;
    here_.constraints = e->constraints;
    here_.jacobian = e->jacobian;
    return true;
  }

  void reset_curvature() {
    const double steepest = here_.gradient.norm();
    B_ = Eigen::MatrixXd::Identity(n_, n_) * std::max(1.0, steepest / first_step_);
  }

  double room(const Side& side, const Evaluation& at) const {
    return side.sign * (at.constraints[side.index] - side.bound);
  }
  static double violation(const Side& side, double room) {
    return side.is_equation ? std::abs(room) : std::max(0.0, -room);
  }
  /// A constraint that the problem did not evaluate, because it holds by far.
  bool is_far(const Side& side, double now) const {
    constexpr double kRounding = 1e-9;  // of bound + far - bound
    return !side.is_equation && now >= monitor_.far() * (1 - kRounding) &&
           here_.jacobian.row(side.index).isZero(0.0);
  }
  double merit(const Evaluation& at) const {
    double out = at.objective;
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      out += penalties_[k] * violation(sides_[i], room(sides_[i], at));
    }
    return out;
  }

  /// The quadratic program, its constraints relaxed by a part that is a further variable.
  /// @param relaxation curvature of that part; 0: none
  bool solve_program(double relaxation) {
    const int size = relaxation > 0 ? n_ + 1 : n_;
    qp_.begin(size);
    qp_.hessian().topLeftCorner(n_, n_) = B_;
    qp_.gradient().head(n_) = here_.gradient;
    if (relaxation > 0) {
      qp_.hessian().col(n_).setZero();
      qp_.hessian().row(n_).setZero();
      qp_.hessian()(n_, n_) = relaxation;
      qp_.gradient()[n_] = 0;
    }
    rows_.clear();
    for (const Side& side : sides_) {
      const double now = room(side, here_);
      if (is_far(side, now)) continue;
      rows_.push_back(&side);
      auto normal = qp_.add_row(-now, side.is_equation);
      normal.head(n_) = side.sign * here_.jacobian.row(side.index);
      if (relaxation > 0) normal[n_] = side.is_equation ? -now : std::max(0.0, -now);
    }
    const auto add_bound = [&](int i, double sign, double least) {
      if (!std::isfinite(least)) return;
      auto normal = qp_.add_row(least);
      normal.setZero();
      normal[i] = sign;
    };
    for (int i = 0; i < n_; ++i) {
      add_bound(i, 1, monitor_.lower()[i] - x_[i]);
      add_bound(i, -1, x_[i] - monitor_.upper()[i]);
    }
    if (relaxation > 0) {
      add_bound(n_, 1, 0);
      add_bound(n_, -1, -1);
    }
    return qp_.solve() == DenseQp::Outcome::Solved;
  }

  /// Step and multipliers at the iterate; relaxed_ is the part of the violations that stays.
  bool find_step() {
    relaxed_ = 0;
    if (!solve_program(0)) {
      double relaxation = kSqp.relaxation;
      for (int i = 0;; ++i, relaxation *= 10) {
        if (!solve_program(relaxation)) return false;
        relaxed_ = qp_.solution()[n_];
        if (relaxed_ < kSqp.whole || i + 1 >= kSqp.relaxations) break;
      }
    }
    step_ = qp_.solution().head(n_);
    multipliers_.setZero();
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      multipliers_[rows_[i] - sides_.data()] = qp_.multipliers()[static_cast<Eigen::Index>(i)];
    }
    if (!step_.allFinite() || !multipliers_.allFinite()) return false;
    penalties_ = multipliers_.cwiseAbs().cwiseMax((multipliers_.cwiseAbs() + penalties_) / 2);
    return true;
  }

  /// Derivative of the merit function along the step, or a bound of it from above.
  double merit_slope() const {
    double violated = 0;
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      violated += penalties_[k] * violation(sides_[i], room(sides_[i], here_));
    }
    return here_.gradient.dot(step_) - violated * (1 - relaxed_);
  }

  /// False: no defined point was found along the step, or the solver has to stop.
  bool search_line(const Eigen::VectorXd& from, double slope) {
    const double before = merit(here_);
    double part = 1;
    for (int i = 0;; ++i) {
      const bool is_last = i >= kSqp.halvings;
      if (!look_at((from + part * step_).cwiseMax(monitor_.lower()).cwiseMin(monitor_.upper()))) {
        if (monitor_.stopped() || is_last) return false;
        part *= kSqp.shortest;
        continue;
      }
      watch_.look_at(worst_violation());
      const double change = merit(here_) - before, expected = part * slope;
      if (is_last || change <= kSqp.descent * expected) return true;
      part *= std::max(expected / (2 * (expected - change)), kSqp.shortest);
    }
  }

  void update_curvature(const Eigen::VectorXd& moved, const Evaluation& before) {
    Eigen::VectorXd y = here_.gradient - before.gradient;
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      const double weight = multipliers_[static_cast<Eigen::Index>(i)] * sides_[i].sign;
      if (weight == 0) continue;
      if (is_far(sides_[i], room(sides_[i], here_))) return;  // its gradient is not known
      const Eigen::Index row = sides_[i].index;
      y -= weight * (here_.jacobian.row(row) - before.jacobian.row(row)).transpose();
    }
    const Eigen::VectorXd Bd = B_ * moved;
    const double dBd = moved.dot(Bd);
    double dy = moved.dot(y);
    if (!(dBd > 0)) return;
    if (dy < kSqp.damping * dBd) {
      const double part = (1 - kSqp.damping) * dBd / (dBd - dy);
      y = part * y + (1 - part) * Bd;
      dy = moved.dot(y);
    }
    B_ += y * y.transpose() / dy - Bd * Bd.transpose() / dBd;
  }

  double worst_violation() const {
    double worst = 0;
    for (const Side& side : sides_) worst = std::max(worst, violation(side, room(side, here_)));
    return worst;
  }

  Monitor& monitor_;
  const std::vector<Side> sides_;
  std::vector<const Side*> rows_;  ///< those of the quadratic program
  const int n_;
  DenseQp qp_;
  Eigen::VectorXd penalties_, multipliers_, x_, step_;
  Evaluation here_;
  Eigen::MatrixXd B_;
  double first_step_ = 1, relaxed_ = 0;
  StuckWatch watch_;
};

class Sqp final : public Optimizer {
 public:
  Sqp()
      : Optimizer({.name = "sqp",
                   .about = "sequential quadratic programming, dual active set (Powell; Goldfarb "
                            "and Idnani)"}) {}

 private:
  NativeOutcome solve(Monitor& monitor, const Eigen::VectorXd& start,
                      const OptimizeOptions& options) const override {
    monitor.leave_far_rows(options.far);
    Descent descent(monitor);
    Ended ended = descent.run(start, kSqp.first_step);
    NativeOutcome out;
    const bool is_off = descent.is_off(options.feasibility_tolerance);
    if (ended == Ended::Stuck || (ended != Ended::Stopped && is_off)) {
      out.remark = kStuckRemark;
      ended = descent.run(monitor.best_x(), kStuck.cautious_step);
      if (ended == Ended::Stuck) monitor.stop(StopReason::Stalled);
    }
    static constexpr const char* kWords[] = {"step lost in rounding", "no step descends", "stuck",
                                             "stopped"};  // in the order of Ended
    out.code = static_cast<int>(ended);
    out.status = kWords[out.code];
    return out;
  }
};

}  // namespace

Optimizers sqp() { return single<Sqp>(); }

}  // namespace stillbase::nlp
