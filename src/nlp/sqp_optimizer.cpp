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
// repeats, but for steep starts and at kinks (kink_cuts.hpp); the quadratic program is solved by
// its dual (dense_qp.hpp), which takes a pass per active row and allocates nothing.
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "nlp/adapters.hpp"
#include "nlp/dense_qp.hpp"
#include "nlp/kink_cuts.hpp"
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
  double fall = 1e-9;       ///< of the objective, since the last reset: without it no other helps
  double relaxation = 100;  ///< curvature of the relaxed part of the constraints, then ten times
  int relaxations = 5;      ///< it, as often as the part remains whole
  double whole = 1 - 1e-6;  ///< part that counts as whole
  double step = 1e-12;      ///< length of a step that is lost in rounding
  double rounding = 1e-14;  ///< of the merit function: smaller changes say nothing
  int hidden = 5;           ///< steps that change it by less

  int corrections = 2;   ///< of one step, by the rows where it ended
  double counts = 0.05;  ///< part of an excess of the merit function that makes a row count
  double flat = 1e-12;   ///< fall of the merit function, of the objective: little is left
  int flat_steps = 2;    ///< with such a fall at a kink: they bring the last digits
};
constexpr SqpOptions kSqp;

std::vector<Side> sides_of(const Monitor& monitor) {
  const Eigen::VectorXd &lower = monitor.constraint_lower(), &upper = monitor.constraint_upper();
  std::vector<Side> out;
  for (Eigen::Index i = 0; i < lower.size(); ++i) {
    if (lower[i] == upper[i]) out.push_back({i, 1, lower[i], true, false});
  }
  for (Eigen::Index i = 0; i < lower.size(); ++i) {
    if (lower[i] == upper[i]) continue;
    const bool kinks = monitor.problem().may_have_kinks(static_cast<int>(i));
    if (std::isfinite(lower[i])) out.push_back({i, 1, lower[i], false, kinks});
    if (std::isfinite(upper[i])) out.push_back({i, -1, upper[i], false, false});
  }
  return out;
}

enum class Ended { StepLost, NoDescent, Stuck, Stopped, Kink };

/// One descent from a start.
class Descent {
 public:
  explicit Descent(Monitor& monitor)
      : monitor_(monitor),
        sides_(sides_of(monitor)),
        n_(static_cast<int>(monitor.lower().size())),
        qp_(n_ + 1, static_cast<int>(sides_.size()) + kKinks.most + 2 * n_ + 2),
        penalties_(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(sides_.size()))),
        multipliers_(penalties_),
        sums_(penalties_),
        cuts_(sides_) {}

  /// @pre the monitor knows the start with its derivatives, whatever budget is left
  Ended run(const Eigen::VectorXd& start, double first_step) {
    if (!look_at(start, here_)) return Ended::Stopped;
    first_step_ = first_step;
    watch_.reset();
    watch_.look_at(worst_violation(here_));
    cuts_.clear();
    reset_curvature();
    penalties_.setZero();
    int resets = 0, flat_steps = 0;
    std::optional<Reset> last;
    while (true) {
      const double slope = find_step() ? merit_slope() : 0;
      if (!(slope < 0)) {
        if (++resets > kSqp.resets || !go_on_since(last)) return Ended::NoDescent;
        continue;
      }
      if (-slope <= kSqp.flat * std::abs(here_.at.objective) && !cuts_.limiting().empty() &&
          ++flat_steps > kSqp.flat_steps) {
        if (is_at_kink()) return Ended::Kink;
        if (monitor_.stopped()) return Ended::Stopped;
        continue;
      }
      const bool arrived = search_line(slope);
      if (monitor_.stopped()) return Ended::Stopped;
      if (!arrived) return Ended::NoDescent;
      std::swap(here_, trial_);  // now the one before
      if (watch_.is_stuck()) return Ended::Stuck;
      moved_ = here_.x - trial_.x;
      const double visible = kSqp.step * (1 + here_.x.lpNorm<Eigen::Infinity>());
      if (hidden_ > kSqp.hidden || moved_.lpNorm<Eigen::Infinity>() <= visible) {
        if (is_at_kink()) return Ended::Kink;
        if (++resets > kSqp.resets || !go_on_since(last)) return Ended::StepLost;
        continue;
      }
      cuts_.follow(trial_, here_, multipliers_);
      update_curvature();
    }
  }

  bool result_is_there() const { return result_is_there_; }
  bool is_off(double tolerance) const { return watch_.is_off(tolerance); }

 private:
  /// False: the solver has to stop, or the point is undefined.
  bool look_at(const Eigen::VectorXd& x, SqpPoint& out) {
    const Evaluation* e = monitor_.evaluate(x.data());
    if (e == nullptr) return false;
    out.x = x;
    out.at.objective = e->objective;
    out.at.gradient = e->gradient;
    out.at.constraints = e->constraints;
    out.at.jacobian = e->jacobian;
    return true;
  }

  /// Where a descent got lost and began again with the curvature of its start.
  struct Reset {
    double objective, violation;
  };

  /// Begins again, unless that has not helped the last time.
  bool go_on_since(std::optional<Reset>& last) {
    const double violated = worst_violation(here_), f = here_.at.objective;
    const bool has_fallen = !last || f < last->objective - kSqp.fall * std::abs(last->objective) ||
                            violated < kSqp.shortest * last->violation;
    if (!has_fallen) return false;
    last = {f, violated};
    hidden_ = 0;
    reset_curvature();
    return true;
  }

  /// Whether cuts limited the last program, and all that did are of kinks; forgets those that are
  /// not.
  bool is_at_kink() {
    const std::vector<std::size_t> limiting = cuts_.limiting();
    bool are_kinks = !limiting.empty();
    const auto look = [this](const Eigen::VectorXd& x) {
      return look_at(x, trial_) ? &trial_ : nullptr;
    };
    for (auto cut = limiting.rbegin(); cut != limiting.rend(); ++cut) {
      if (cuts_.is_kink(*cut, here_, look)) continue;
      are_kinks = false;
      cuts_.forget(*cut);
    }
    if (are_kinks) result_is_there_ = monitor_.prefer(here_.x, sums_);
    return are_kinks;
  }

  void reset_curvature() {
    const double steepest = here_.at.gradient.norm();
    B_ = Eigen::MatrixXd::Identity(n_, n_) * std::max(1.0, steepest / first_step_);
  }

  /// A constraint that the problem did not evaluate, because it holds by far.
  bool is_far(const Side& side, const SqpPoint& point) const {
    constexpr double kRounding = 1e-9;  // of bound + far - bound
    return !side.is_equation && room(side, point) >= monitor_.far() * (1 - kRounding) &&
           point.at.jacobian.row(side.index).isZero(0.0);
  }
  double merit(const SqpPoint& point) const {
    double out = point.at.objective;
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      out += penalties_[k] * violation(sides_[i], room(sides_[i], point));
    }
    return out;
  }

  /// The quadratic program, its constraints relaxed by a part that is a further variable.
  /// @param relaxation curvature of that part; 0: none
  bool solve_program(double relaxation) {
    const int size = relaxation > 0 ? n_ + 1 : n_;
    qp_.begin(size);
    qp_.hessian().topLeftCorner(n_, n_) = B_;
    qp_.gradient().head(n_) = here_.at.gradient;
    if (relaxation > 0) {
      qp_.hessian().col(n_).setZero();
      qp_.hessian().row(n_).setZero();
      qp_.hessian()(n_, n_) = relaxation;
      qp_.gradient()[n_] = 0;
    }
    rows_.clear();
    // A row, whose normal is to be filled in.
    const auto add = [&](double now, bool is_equation) {
      auto row = qp_.add_row(-now, is_equation);
      if (relaxation > 0) row[n_] = is_equation ? -now : std::max(0.0, -now);
      return row;
    };
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      const Side& side = sides_[i];
      if (is_far(side, here_)) continue;
      rows_.push_back(static_cast<Eigen::Index>(i));
      add(room(side, here_), side.is_equation).head(n_) =
          side.sign * here_.at.jacobian.row(side.index);
    }
    for (const Cut& cut : cuts_.all()) {
      rows_.push_back(static_cast<Eigen::Index>(cut.side));
      add(cuts_.room_at(here_, cut), false).head(n_) = cut.normal;
    }
    const auto add_bound = [&](int i, double sign, double least) {
      if (std::isfinite(least)) qp_.add_bound(i, sign, least);
    };
    for (int i = 0; i < n_; ++i) {
      add_bound(i, 1, monitor_.lower()[i] - here_.x[i]);
      add_bound(i, -1, here_.x[i] - monitor_.upper()[i]);
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
    bool is_solved = solve_program(0);
    if (!is_solved && !cuts_.all().empty()) {
      cuts_.clear();
      is_solved = solve_program(0);
    }
    if (!is_solved) {
      double relaxation = kSqp.relaxation;
      for (int i = 0;; ++i, relaxation *= 10) {
        if (!solve_program(relaxation)) return false;
        relaxed_ = qp_.solution()[n_];
        if (relaxed_ < kSqp.whole || i + 1 >= kSqp.relaxations) break;
      }
    }
    step_ = qp_.solution().head(n_);
    multipliers_.setZero();
    sums_.setZero();
    const std::size_t first_cut = rows_.size() - cuts_.all().size();
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const double u = qp_.multipliers()[static_cast<Eigen::Index>(i)];
      if (i < first_cut) {
        multipliers_[rows_[i]] = u;
      } else {
        cuts_.count(i - first_cut, u);
      }
      sums_[rows_[i]] += std::abs(u);
    }
    if (!step_.allFinite() || !sums_.allFinite()) return false;
    penalties_ = sums_.cwiseMax((sums_ + penalties_) / 2);
    return true;
  }

  /// Derivative of the merit function along the step, or a bound of it from above.
  double merit_slope() const {
    double violated = 0;
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      violated += penalties_[k] * violation(sides_[i], room(sides_[i], here_));
    }
    return here_.at.gradient.dot(step_) - violated * (1 - relaxed_);
  }

  /// False: no defined point was found along the step, or the solver has to stop.
  bool search_line(double slope) {
    double before = merit(here_);
    double part = 1;
    int corrections = 0;
    for (int i = 0;; ++i) {
      const bool is_last = i >= kSqp.halvings;
      end_ = (here_.x + part * step_).cwiseMax(monitor_.lower()).cwiseMin(monitor_.upper());
      if (!look_at(end_, trial_)) {
        if (monitor_.stopped() || is_last) return false;
        part *= kSqp.shortest;
        continue;
      }
      watch_.look_at(worst_violation(trial_));
      const double change = merit(trial_) - before, expected = part * slope;
      if (is_last || change <= kSqp.descent * expected) return true;
      if (std::max(-expected, change) <= kSqp.rounding * std::abs(before)) {
        ++hidden_;
        return true;
      }
      if (corrections < kSqp.corrections && correct(part, change - expected)) {
        ++corrections;
        part = 1;
      } else {
        part *= std::max(expected / (2 * (expected - change)), kSqp.shortest);
      }
      slope = merit_slope();  // the penalties may have changed
      before = merit(here_);
    }
  }

  /// Another step from the iterate, which knows the inequalities where the last one ended. False:
  /// nothing more is known, or no other step descends.
  /// @param excess of the merit function over what was expected
  bool correct(double part, double excess) {
    bool is_known_better = false;
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      const Side& side = sides_[i];
      const auto k = static_cast<Eigen::Index>(i);
      if (!side.may_have_kinks || penalties_[k] == 0) continue;
      if (is_far(side, here_) || is_far(side, trial_)) continue;
      const double there = room(side, trial_);
      const double expected = room(side, here_) + part * normal(side, here_).dot(step_);
      const double more = violation(side, there) - violation(side, expected);
      if (penalties_[k] * more <= kSqp.counts * excess) continue;
      is_known_better = cuts_.take(i, here_, trial_) || is_known_better;
    }
    if (!is_known_better) return false;
    const Eigen::VectorXd step = step_, multipliers = multipliers_, sums = sums_;
    const Eigen::VectorXd penalties = penalties_;
    const double relaxed = relaxed_;
    if (find_step() && merit_slope() < 0) return true;
    step_ = step;
    multipliers_ = multipliers;
    sums_ = sums;
    penalties_ = penalties;
    relaxed_ = relaxed;
    return false;
  }

  /// By the step from trial_ to here_.
  void update_curvature() {
    const Eigen::VectorXd& moved = moved_;
    Eigen::VectorXd &y = slopes_, &Bd = Bd_;
    y = here_.at.gradient - trial_.at.gradient;
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      const double u = multipliers_[static_cast<Eigen::Index>(i)];
      if (u == 0) continue;
      if (is_far(sides_[i], here_)) return;  // its gradient is not known
      if (cuts_.is_kinked(i)) continue;
      const Eigen::Index row = sides_[i].index;
      const double weight = u * sides_[i].sign;
      y -= weight * (here_.at.jacobian.row(row) - trial_.at.jacobian.row(row)).transpose();
    }
    Bd.noalias() = B_.lazyProduct(moved);
    const double dBd = moved.dot(Bd);
    double dy = moved.dot(y);
    if (!(dBd > 0)) return;
    if (dy < kSqp.damping * dBd) {
      const double part = (1 - kSqp.damping) * dBd / (dBd - dy);
      y = part * y + (1 - part) * Bd;
      dy = moved.dot(y);
    }
    for (int j = 0; j < n_; ++j) B_.col(j) += y * y[j] / dy - Bd * Bd[j] / dBd;
  }

  double worst_violation(const SqpPoint& point) const {
    double worst = 0;
    for (const Side& side : sides_) worst = std::max(worst, violation(side, room(side, point)));
    return worst;
  }

  Monitor& monitor_;
  const std::vector<Side> sides_;
  std::vector<Eigen::Index> rows_;  ///< the sides of the quadratic program's rows
  const int n_;
  DenseQp qp_;
  Eigen::VectorXd penalties_;            ///< of the merit function
  Eigen::VectorXd multipliers_;          ///< of the rows at the iterate
  Eigen::VectorXd sums_;                 ///< of their sizes, those of cuts included
  Eigen::VectorXd step_, end_;           ///< of the quadratic program; where it leads to
  Eigen::VectorXd moved_, slopes_, Bd_;  ///< of an update of B: d, the change of the slope, B d
  SqpPoint here_, trial_;
  KinkCuts cuts_;
  Eigen::MatrixXd B_;
  double first_step_ = 1, relaxed_ = 0;
  int hidden_ = 0;                ///< steps whose change is lost in rounding
  bool result_is_there_ = false;  ///< the monitor's best point is where it ended
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
                                             "stopped",
                                             "minimum at a kink"};  // in the order of Ended
    out.code = static_cast<int>(ended);
    out.status = kWords[out.code];
    out.at_kink = ended == Ended::Kink && descent.result_is_there();
    return out;
  }
};

}  // namespace

Optimizers sqp() { return single<Sqp>(); }

}  // namespace stillbase::nlp
