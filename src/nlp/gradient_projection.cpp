// Gradient projection with restoration: J. B. Rosen, The gradient projection method for nonlinear
// programming II, SIAM J. 9 (1961), as Wee and Walker (IEEE Trans. Robotics and Automation
// 9(6), 1993) to pre-impact configurations, and so the baseline for every other optimizer here.
//
//   d = projection of -grad f on the cone of feasible directions,  x+ = restore(x + t d)
//
// The projection is what the certificate leaves: -(grad f + J' multipliers) with the signed
// multipliers of the active bounds. A bound nearer than epsilon that has a multiplier counts as
// active and is stepped onto: else every step would bend at a bound that its direction did not know
// (zigzagging; Polak, Computational Methods in Optimization, 1971, section 4.3). First order only;
// it makes small steps along curved valleys. Two standard remedies make it a fair baseline: the
// first trial step is that of Barzilai and Borwein (IMA J. Numer. Anal. 8, 1988), and the line
// search compares with the worst of the last ten objectives (Grippo, Lampariello, Lucidi, SIAM J.
// Numer. Anal. 23, 1986).
#include <algorithm>
#include <cmath>
#include <deque>

#include "nlp/adapters.hpp"
#include "nlp/restoration.hpp"

namespace stillbase::nlp {
namespace {

struct GradientProjectionOptions {
  std::size_t memory = 10;       ///< objectives that the line search compares with
  int halvings = 40;             ///< 1e-12 of the first trial step
  int restoration_steps = 20;    ///< of a trial; ten times as many from the start
  double descent = 1e-4;         ///< fraction of the first-order fall |x+ - x|^2 / t
  double widest_active = 1e-2;   ///< first epsilon, of variables and constraints of order one
  double least_active = 1e-6;    ///< last one, that of the certificate
  double restored = 1e-12;       ///< to rounding: the judge's tolerance buys nothing
  double stationary_part = 0.1;  ///< of the judge's tolerance: it certifies the answer once more
};
constexpr GradientProjectionOptions kProjection;

struct Iterate {
  Eigen::VectorXd x;
  Evaluation at_x;
  Eigen::VectorXd direction;
  Certificate near;  // with bounds nearer than epsilon
};

void project_gradient(const Problem& problem, double epsilon, Iterate& at) {
  at.near = certify(problem, at.x, at.at_x, {.activity_tolerance = epsilon});
  at.direction = -(at.at_x.gradient + at.near.bound_multipliers);
  if (at.near.multipliers.size() > 0) {
    at.direction -= at.at_x.jacobian.transpose() * at.near.multipliers;
  }
}

// The bound that each signed multiplier belongs to, in place of the range.
void narrow_to_active(const Eigen::VectorXd& multipliers, Eigen::VectorXd& lower,
                      Eigen::VectorXd& upper) {
  for (Eigen::Index i = 0; i < multipliers.size(); ++i) {
    if (multipliers[i] > 0.0) lower[i] = upper[i];
    if (multipliers[i] < 0.0) upper[i] = lower[i];
  }
}

// Least violation that a restoration must reach for its point to count as feasible.
double restored_enough(const OptimizeOptions& options) {
  return 0.5 * options.feasibility_tolerance;
}

// The restored point at step t along the direction; false when there is none.
bool step_to(Monitor& monitor, const OptimizeOptions& options, const Iterate& from, double t,
             Iterate& to) {
  Eigen::VectorXd lower = monitor.lower(), upper = monitor.upper();
  Eigen::VectorXd g_lower = monitor.constraint_lower(), g_upper = monitor.constraint_upper();
  narrow_to_active(from.near.bound_multipliers, lower, upper);
  narrow_to_active(from.near.multipliers, g_lower, g_upper);
  to.x = (from.x + t * from.direction).cwiseMax(lower).cwiseMin(upper);
  const Evaluation* e = monitor.evaluate(to.x.data());
  if (e == nullptr) return false;
  to.at_x = *e;
  return restore(monitor, g_lower, g_upper, kProjection.restored, kProjection.restoration_steps,
                 to.x, to.at_x) <= restored_enough(options);
}

// Step that makes the secant equation of the Lagrangian hold best (with one set of multipliers: a
// constraint that became active must not look like curvature); twice the last one along a concave
// stretch.
double first_trial_step(const Iterate& before, const Iterate& now, double last) {
  const Eigen::VectorXd s = now.x - before.x;
  Eigen::VectorXd y = now.at_x.gradient - before.at_x.gradient;
  if (now.near.multipliers.size() > 0) {
    y += (now.at_x.jacobian - before.at_x.jacobian).transpose() * now.near.multipliers;
  }
  const double curvature = s.dot(y);
  const double t = curvature > 0.0 ? s.squaredNorm() / curvature : 2.0 * last;
  const double longest = std::max(1.0, now.x.lpNorm<Eigen::Infinity>());
  return std::min(t, longest / std::max(now.direction.norm(), 1e-300));
}

class GradientProjection final : public Optimizer {
 public:
  GradientProjection()
      : Optimizer(
            {.name = "gradient-projection",
             .about = "projected steepest descent with restoration (Rosen; Wee and Walker)"}) {}

 private:
  NativeOutcome solve(Monitor& monitor, const Eigen::VectorXd& start,
                      const OptimizeOptions& options) const override {
    Iterate now;
    now.x = start;
    const Evaluation* e = monitor.evaluate(start.data());
    if (e == nullptr) return {-1, "no finite start", ""};
    now.at_x = *e;
    if (restore(monitor, monitor.constraint_lower(), monitor.constraint_upper(),
                kProjection.restored, 10 * kProjection.restoration_steps, now.x,
                now.at_x) > restored_enough(options)) {
      return {-2, "restoration failed", ""};
    }
    double epsilon = kProjection.widest_active;
    project_gradient(monitor.problem(), epsilon, now);
    double t = 0.1 / std::max(now.direction.norm(), 0.1);
    std::deque<double> recent{now.at_x.objective};
    while (!monitor.stopped()) {
      if (certify(monitor.problem(), now.x, now.at_x).kkt_residual <=
          kProjection.stationary_part * options.optimality_tolerance) {
        return {0, "stationary", ""};
      }
      const double reference = *std::max_element(recent.begin(), recent.end());
      Iterate next;
      bool accepted = false;
      for (int halving = 0; halving < kProjection.halvings && !monitor.stopped();
           ++halving, t /= 2.0) {
        const bool there = step_to(monitor, options, now, t, next);
        const double moved = (next.x - now.x).squaredNorm();
        accepted = there && moved > 0.0 &&
                   next.at_x.objective <= reference - kProjection.descent * moved / t;
        if (accepted) break;
      }
      if (!accepted) {
        if (monitor.stopped() || epsilon <= kProjection.least_active) break;
        epsilon /= 10.0;
        project_gradient(monitor.problem(), epsilon, now);
        t = 0.1 / std::max(now.direction.norm(), 0.1);
        continue;
      }
      project_gradient(monitor.problem(), epsilon, next);
      t = first_trial_step(now, next, t);
      now = std::move(next);
      recent.push_back(now.at_x.objective);
      if (recent.size() > kProjection.memory) recent.pop_front();
    }
    if (monitor.stopped()) return {-5, "stopped", ""};
    return {1, "step lost in rounding", ""};
  }
};

}  // namespace

Optimizers gradient_projection() { return single<GradientProjection>(); }

}  // namespace stillbase::nlp
