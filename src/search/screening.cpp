#include "search/screening.hpp"

#include <algorithm>
#include <numeric>

#include "formulation/measures/residual.hpp"
#include "formulation/measures/scenario_program.hpp"

namespace stillbase {

Eigen::VectorXd screen(const CaptureProblem& problem, const Formulation& formulation,
                       const std::vector<Eigen::VectorXd>& points,
                       const ScreeningOptions& options) {
  const RiskMeasure kind = problem.measure.kind;
  const bool sampled = kind == RiskMeasure::Expectation || kind == RiskMeasure::Cvar;
  std::vector<Scenario> scenarios =
      sampled ? mean_scenarios(problem) : outer_scenarios(problem, options.rim_directions);
  if (sampled && scenarios.size() > options.samples) scenarios.resize(options.samples);
  if (kind == RiskMeasure::Nominal) scenarios.resize(1);

  // Where simulations were given up: behind all others.
  const auto known = [](const Eigen::MatrixXd& all) -> Eigen::MatrixXd {
    return all.array().isNaN().select(kInfinity, all);
  };
  const Eigen::MatrixXd values = known(formulation.evaluate_points(points, scenarios));
  if (kind == RiskMeasure::Cvar) {
    const auto count = static_cast<Eigen::Index>(scenarios.size());
    const Eigen::VectorXd weights =
        Eigen::VectorXd::Constant(count, 1.0 / static_cast<double>(count));
    Eigen::VectorXd out(values.rows());
    for (Eigen::Index i = 0; i < out.size(); ++i) {
      out[i] = tail_mean(values.row(i), weights, problem.measure.cvar_level).mean;
    }
    return known(out);
  }
  if (kind == RiskMeasure::Expectation) return values.rowwise().mean();
  return values.rowwise().maxCoeff();
}

std::vector<Eigen::VectorXd> best_by_screening(const CaptureProblem& problem,
                                               const Formulation& formulation,
                                               const std::vector<Eigen::VectorXd>& points, int kept,
                                               const ScreeningOptions& options) {
  if (points.empty()) return {};
  const Eigen::VectorXd values = screen(problem, formulation, points, options);
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&values](std::size_t a, std::size_t b) {
    return values[static_cast<Eigen::Index>(a)] < values[static_cast<Eigen::Index>(b)];
  });
  std::vector<Eigen::VectorXd> out;
  for (const std::size_t i : order) {
    if (static_cast<int>(out.size()) == kept) break;
    const bool known = std::any_of(out.begin(), out.end(), [&](const Eigen::VectorXd& better) {
      return formulation.are_within(better, points[i], options.distance);
    });
    if (!known) out.push_back(points[i]);
  }
  return out;
}

}  // namespace stillbase
