#include "audit/differences.hpp"

#include <cmath>

#include <stillbase/core/constants.hpp>

namespace stillbase::audit {
namespace {

/// How far steps are halved.
struct DifferenceOptions {
  int halvings = 6;  ///< at most: shorter steps leave rounding
  /// Of two estimates of a slope, relative to the largest one or to 1: their errors are a
  /// fifteenth.
  double same_slope = 1e-7;
};
constexpr DifferenceOptions kDifferences;

/// @param combine of what is near and what is far, at one and two steps, and the step
template <class Pair, class Combine, class IsDone>
Eigen::VectorXd halved(const Pair& pair, const Combine& combine, double step,
                       const IsDone& is_done) {
  Eigen::VectorXd near = pair(step);
  Eigen::VectorXd last = combine(near, pair(2 * step), step), best = last;
  Eigen::VectorXd change = Eigen::VectorXd::Constant(last.size(), kInfinity);
  for (int halving = 0; halving < kDifferences.halvings && !is_done(best, change); ++halving) {
    step /= 2;
    const Eigen::VectorXd far = near;
    near = pair(step);
    const Eigen::VectorXd next = combine(near, far, step);
    for (Eigen::Index i = 0; i < next.size(); ++i) {
      const double moved = std::abs(next[i] - last[i]);
      if (!(moved < change[i]) && std::isfinite(best[i])) continue;
      best[i] = next[i];
      if (std::isfinite(moved)) change[i] = moved;
    }
    last = next;
  }
  return best;
}

}  // namespace

Eigen::VectorXd slopes_at_zero(const AlongLine& values, double step) {
  return halved([&](double h) -> Eigen::VectorXd { return values(h) - values(-h); },
                [](const Eigen::VectorXd& near, const Eigen::VectorXd& far,
                   double h) -> Eigen::VectorXd { return (8 * near - far) / (12 * h); },
                step,
                [](const Eigen::VectorXd& best, const Eigen::VectorXd& change) {
                  const double size = std::max(1.0, best.cwiseAbs().maxCoeff());
                  return (change.array() <= kDifferences.same_slope * size).all();
                });
}

Eigen::VectorXd bends_at_zero(const AlongLine& values, double step, double tolerance) {
  const Eigen::VectorXd here = values(0);
  return halved([&](double h) -> Eigen::VectorXd { return values(h) + values(-h) - 2 * here; },
                [](const Eigen::VectorXd& near, const Eigen::VectorXd& far,
                   double h) -> Eigen::VectorXd { return (16 * near - far) / (12 * h * h); },
                step,
                [tolerance](const Eigen::VectorXd&, const Eigen::VectorXd& change) {
                  return (change.array() <= tolerance).all();
                });
}

}  // namespace stillbase::audit
