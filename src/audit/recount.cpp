#include <algorithm>
#include <array>

#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/core/random.hpp>

#include "audit/checks.hpp"
#include "audit/equations.hpp"
#include "audit/tolerances.hpp"

namespace stillbase::audit {

using namespace verification;

namespace {

/// The search for all solutions of a small problem.
struct RecountOptions {
  double same_solution = 1e-5;                ///< rad, m: distance of equal solutions
  double zero_residual = 1e-11;               ///< residual of a zero
  std::array<int, 3> starts{100, 400, 1000};  ///< by the number of variables
};
constexpr RecountOptions kRecount;

Eigen::VectorXd start_point(const FreeVariables& variables, int index) {
  const Eigen::VectorXd u = low_discrepancy_point(index, variables.size(), 0);
  return variables.lower + u.cwiseProduct(variables.upper - variables.lower);
}

/// Largest number of equations that are independent at one of eight points.
int generic_rank(const Equations& equations, const FreeVariables& variables) {
  int rank = 0;
  for (int sample = 0; sample < 8; ++sample) {
    rank = std::max(rank, rank_of(equations.jacobian(start_point(variables, sample + 1))));
  }
  return rank;
}

/// Whether the objective vanishes together with an angular momentum.
bool is_angular(const std::vector<ObjectiveTerm>& objective) {
  return objective.size() == 1 && record_of(objective.front().quantity).momentum != nullptr;
}

}  // namespace

bool is_on_curve_of_zeros(const CaptureProblem& problem, const Configuration& at) {
  if (!is_angular(problem.objective)) return false;
  const FreeVariables variables(problem);
  const int n = variables.size();
  if (n < 2) return false;
  const Eigen::VectorXd x = variables.of(at);
  const Equations constraints(problem, variables, Equations::Demand::HandAndCase);
  if (rank_of(constraints.jacobian(x)) >= n) return false;
  const Equations equations(problem, variables, Equations::Demand::Zero);
  if (!(equations.residual(x).cwiseAbs().maxCoeff() <= kRecount.zero_residual)) return false;
  const Eigen::VectorXd sizes = singular_values(equations.jacobian(x));
  if (sizes.size() < n) return false;  // fewer equations: several directions are free
  return sizes[n - 1] <= kRecord.restricts_not && sizes[n - 2] >= kRecord.restricts;
}

Recount search_solutions(const Context& context) {
  const CaptureProblem& problem = context.problem;
  const AttitudeFreedom attitude = problem.variables.base_attitude;
  const FreeVariables variables(problem);
  const int n = variables.size();
  Recount out;
  if (attitude == AttitudeFreedom::Cone || attitude == AttitudeFreedom::Free) {
    out.not_done = "the base attitude is free about more than one axis";
  } else if (n < 1 || n > 3) {
    out.not_done = "not one to three variables";
  }
  if (!out.not_done.empty()) return out;
  std::optional<Equations> equations;
  equations.emplace(problem, variables, Equations::Demand::HandAndCase);
  int rank = generic_rank(*equations, variables);
  if (rank < n && is_angular(problem.objective)) {
    out.asks_for_zero = true;
    equations.emplace(problem, variables, Equations::Demand::Zero);
    rank = generic_rank(*equations, variables);
  }
  if (rank < n) {
    out.not_done = "the equations leave freedom";
    return out;
  }
  out.starts = kRecount.starts[static_cast<std::size_t>(n - 1)];
  std::vector<Eigen::VectorXd> points;
  for (int s = 0; s < out.starts && !context.options.stop.reached(); ++s) {
    auto x = equations->solve(start_point(variables, s));
    if (!x || rank_of(equations->jacobian(*x)) < n || !variables.bring_inside(*x)) continue;
    const Configuration at = variables.at(*x);
    if (!equations->keeps_inequalities(at) || !equations->keeps_margins(at)) continue;
    const auto is_same = [&](const Eigen::VectorXd& other) {
      return variables.distance(*x, other) <= kRecount.same_solution;
    };
    if (std::any_of(points.begin(), points.end(), is_same)) continue;
    points.push_back(*x);
    out.solutions.push_back(at);
  }
  return out;
}

}  // namespace stillbase::audit
