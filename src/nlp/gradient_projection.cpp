// Gradient projection with restoration: J. B. Rosen, The gradient projection method for nonlinear
// programming II, SIAM J. 9 (1961), the way of Wee and Walker (IEEE Trans. Robotics and Automation
// 9(6), 1993) to pre-impact configurations, and so the baseline for every other optimizer here.
//
//   d = projection of -grad f on the cone of feasible directions,  x+ = restore(x + t d)
//
// The projection is what the certificate leaves: -(grad f + J' multipliers) with the signed
// multipliers of the active bounds. First order only; it creeps along curved valleys. Two standard
// remedies make it a fair baseline: the first trial step is that of Barzilai and Borwein (IMA J.
// Numer. Anal. 8, 1988), and the line search compares with the worst of the last ten objectives
// (Grippo, Lampariello, Lucidi, SIAM J. Numer. Anal. 23, 1986).
#include <algorithm>
#include <cmath>
#include <deque>

#include "nlp/adapters.hpp"
#include "nlp/restoration.hpp"

namespace stillbase::nlp {
namespace {

constexpr const char* kName = "gradient-projection";
constexpr int kMemory = 10;       // objectives that the line search compares with
constexpr int kMaxHalvings = 40;  // 1e-12 of the first trial step
constexpr int kRestorationSteps = 20;
constexpr double kDescent = 1e-4;    // Armijo's fraction of the first-order fall
constexpr double kFeasible = 1e-12;  // restored to rounding: the judge's tolerance buys nothing

struct Iterate {
  Eigen::VectorXd x;
  Evaluation at_x;
  Eigen::VectorXd direction;
  double kkt_residual = kInfinity;
};

void project_gradient(const Problem& problem, Iterate& at) {
  const Certificate found = certify(problem, at.x, at.at_x);
  at.direction = -(at.at_x.gradient + found.bound_multipliers);
  if (found.multipliers.size() > 0) {
    at.direction -= at.at_x.jacobian.transpose() * found.multipliers;
  }
  at.kkt_residual = found.kkt_residual;
}

// Least violation that a restoration must reach for its point to count as feasible.
double restored_enough(const OptimizeOptions& options) {
  return 0.5 * options.feasibility_tolerance;
}

// The restored point at step t along the direction; false when there is none.
bool step_to(Monitor& monitor, const OptimizeOptions& options, const Iterate& from, double t,
             Iterate& to) {
  to.x = (from.x + t * from.direction).cwiseMax(monitor.lower()).cwiseMin(monitor.upper());
  const Evaluation* e = monitor.evaluate(to.x.data());
  if (e == nullptr) return false;
  to.at_x = *e;
  return restore(monitor, kFeasible, kRestorationSteps, to.x, to.at_x) <= restored_enough(options);
}

// Step that makes the secant equation hold best; twice the last one along a concave stretch.
double first_trial_step(const Iterate& before, const Iterate& now, double last) {
  const Eigen::VectorXd s = now.x - before.x, y = before.direction - now.direction;
  const double curvature = s.dot(y);
  const double t = curvature > 0.0 ? s.squaredNorm() / curvature : 2.0 * last;
  const double longest = std::max(1.0, now.x.lpNorm<Eigen::Infinity>());
  return std::min(t, longest / std::max(now.direction.norm(), 1e-300));
}

class GradientProjection final : public Optimizer {
 public:
  GradientProjection()
      : Optimizer(
            {.name = kName,
             .about = "projected steepest descent with restoration (Rosen; Wee and Walker)"}) {}

 private:
  NativeOutcome solve(Monitor& monitor, const Eigen::VectorXd& start,
                      const OptimizeOptions& options) const override {
    Iterate now;
    now.x = start;
    const Evaluation* e = monitor.evaluate(start.data());
    if (e == nullptr) return {-1, "no finite start", ""};
    now.at_x = *e;
    if (restore(monitor, kFeasible, 10 * kRestorationSteps, now.x, now.at_x) >
        restored_enough(options)) {
      return {-2, "restoration failed", ""};
    }
    project_gradient(monitor.problem(), now);
    double t = 0.1 / std::max(now.direction.norm(), 0.1);
    std::deque<double> recent{now.at_x.objective};
    while (!monitor.stopped()) {
      // A tenth of the judge's tolerance: the certificate is computed once more at the answer.
      if (now.kkt_residual <= 0.1 * options.optimality_tolerance) return {0, "stationary", ""};
      const double reference = *std::max_element(recent.begin(), recent.end());
      const double slope = now.direction.squaredNorm();
      Iterate next;
      bool accepted = false;
      for (int halving = 0; halving < kMaxHalvings && !monitor.stopped(); ++halving, t /= 2.0) {
        const bool there = step_to(monitor, options, now, t, next);
        accepted = there && next.at_x.objective <= reference - kDescent * t * slope &&
                   (next.x - now.x).norm() > 0.0;
        if (accepted) break;
      }
      if (!accepted) return {monitor.stopped() ? -5 : 1, "step lost in rounding", ""};
      project_gradient(monitor.problem(), next);
      t = first_trial_step(now, next, t);
      now = std::move(next);
      recent.push_back(now.at_x.objective);
      if (recent.size() > kMemory) recent.pop_front();
    }
    return {-5, "stopped", ""};
  }
};

}  // namespace

std::vector<std::string> gradient_projection_names() { return {kName}; }

std::unique_ptr<Optimizer> make_gradient_projection(std::string_view name) {
  return name == kName ? std::make_unique<GradientProjection>() : nullptr;
}

}  // namespace stillbase::nlp
