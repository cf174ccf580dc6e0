// Equations of a case that others imply wherever they hold.
//
// The base part of an arm whose joints move in two directions only is M z with z of two components:
// three equations, two of which are enough. Away from z = 0 their gradients are independent, at
// z = 0 they are not, and there sequential quadratic programming stops. So optimizers get two of
// them; a plan reports all of them and is judged by all.
//
// With more equations than variables every Jacobian is short of rank. Which equations are implied
// is then decided for the same case without the hand's equations and with every joint and the base
// attitude free. What holds there holds here.
#include <algorithm>
#include <stillbase/core/linear_algebra.hpp>

#include <stillbase/core/error.hpp>
#include <stillbase/core/random.hpp>

#include "formulation/formulation_parts.hpp"
#include "formulation/projection.hpp"

namespace stillbase {

namespace {

using RowNumbers = std::vector<Eigen::Index>;

/// Singular values over the largest of them.
Eigen::VectorXd relative_sizes(const Eigen::MatrixXd& J) {
  const Eigen::VectorXd sizes = singular_values(J);
  return sizes / std::max(sizes.maxCoeff(), 1e-300);
}

/// Solutions of the equations: projections of evenly spread points. @param seed of the points
std::vector<Eigen::VectorXd> find_solutions(const Formulation& formulation, std::uint64_t seed,
                                            std::size_t wanted, const PresolveOptions& options) {
  std::vector<Eigen::VectorXd> out;
  for (int trial = 0; trial < options.solution_trials && out.size() < wanted; ++trial) {
    const Eigen::VectorXd start =
        formulation.start_point(low_discrepancy_point(trial, formulation.num_variables(), seed));
    const ProjectionResult there =
        project_onto_constraints(formulation, start, false, options.projection_steps);
    if (there.violation <= options.solved) out.push_back(there.x);
  }
  return out;
}

Eigen::Index rank_of(const Eigen::MatrixXd& J, const PresolveOptions& options) {
  return (relative_sizes(J).array() > options.rank).count();
}

/// Whether the reported rows hold at solutions of the kept ones. Equations that depend on each
/// other at their solutions may have other solutions where one of them is left out: a product is
/// zero where either factor is.
bool reported_rows_hold(const Formulation& formulation, const SelectedRows& rows,
                        const PresolveOptions& options) {
  const auto all = static_cast<std::size_t>(options.solution_trials);
  const std::vector<Eigen::VectorXd> solutions = find_solutions(formulation, 2, all, options);
  for (const Eigen::VectorXd& x : solutions) {
    // The report lists the kept rows but for parts of others, then the reported ones.
    const std::vector<ConstraintValue> report = formulation.report(x);
    const auto first =
        report.begin() + std::count_if(rows.kept.begin(), rows.kept.end(),
                                       [](const Constraint* row) { return !row->is_part; });
    const auto last = first + static_cast<std::ptrdiff_t>(rows.reported.size());
    if (std::any_of(first, last, [&](const ConstraintValue& value) {
          return value.violation > options.holds;
        })) {
      return false;
    }
  }
  return !solutions.empty();
}

/// How well the equations whose number is not in `left_out` determine the solutions: the median
/// over the Jacobians of their smallest relative singular value that counts; 0 where the rank is
/// not that of all equations.
double independence(const std::vector<Eigen::MatrixXd>& jacobians, const RowNumbers& left_out,
                    const PresolveOptions& options) {
  std::vector<double> least;
  for (const Eigen::MatrixXd& J : jacobians) {
    Eigen::MatrixXd kept(J.rows() - static_cast<Eigen::Index>(left_out.size()), J.cols());
    Eigen::Index to = 0;
    for (Eigen::Index i = 0; i < J.rows(); ++i) {
      if (std::find(left_out.begin(), left_out.end(), i) == left_out.end()) {
        kept.row(to++) = J.row(i);
      }
    }
    const Eigen::Index rank = rank_of(J, options);
    if (rank == 0 || kept.rows() < rank || rank_of(kept, options) < rank) return 0;
    least.push_back(relative_sizes(kept)[rank - 1]);
  }
  std::nth_element(least.begin(), least.begin() + static_cast<long>(least.size() / 2), least.end());
  return least[least.size() / 2];
}

/// Moves a kept row to the reported ones.
void report_row(SelectedRows& rows, std::size_t index) {
  const Constraint* const row = rows.kept[index];
  rows.reported.push_back(row);
  rows.redundant.push_back({row->name, Redundancy::ImpliedByOthers});
  rows.kept.erase(rows.kept.begin() + static_cast<std::ptrdiff_t>(index));
}

/// The same case of the same robot and impulse with all the freedom that a problem can have.
CaptureProblem freed(CaptureProblem problem) {
  const ConstraintSpec stated = problem.constraints;
  problem.constraints = {};
  problem.constraints.impact_case = stated.impact_case;
  problem.constraints.closing_speed_min = stated.closing_speed_min;
  problem.hand.constraint = HandConstraint::None;
  problem.objective = {{}};  // none that is simulated
  problem.user = {};
  problem.variables.joints.assign(problem.variables.joints.size(), true);
  problem.variables.base_attitude = AttitudeFreedom::Free;
  problem.variables.base_attitude_max = VariableSpec{}.base_attitude_max;
  problem.variables.base_position = PositionFreedom::Free;
  return problem;
}

[[noreturn]] void refuse_too_few(const CaptureProblem& problem, int equations, int variables) {
  throw InputError({Finding{
      problem.source, 0, "too-few-variables",
      "variables: the constraints impose " + std::to_string(equations) +
          " independent equations, but only " + std::to_string(variables) +
          " variables are free; free more joints, the base attitude or the contact time"}});
}

}  // namespace

void Formulation::remove_implied_rows() {
  const PresolveOptions options;
  Parts& parts = *parts_;
  if (num_equations() > num_variables()) {
    const CaptureProblem wider = freed(parts.model.problem);
    const bool is_freed = parts.model.problem.hand.constraint == HandConstraint::None &&
                          VariableLayout(wider).size == num_variables();
    std::vector<std::string> implied;
    try {
      if (!is_freed) {
        const Formulation of_wider(wider);
        for (const Constraint* row : of_wider.parts_->rows.reported) implied.push_back(row->name);
      }
    } catch (const InputError&) {
      // There, too, they are more than the variables: which ones others imply is not known.
    }
    SelectedRows rows = parts.rows;
    for (const std::string& name : implied) {
      const auto row = std::find_if(rows.kept.begin(), rows.kept.end(),
                                    [&](const Constraint* own) { return own->name == name; });
      if (row != rows.kept.end())
        report_row(rows, static_cast<std::size_t>(row - rows.kept.begin()));
    }
    parts.select(std::move(rows));
  }
  if (num_equations() > num_variables()) {
    refuse_too_few(parts.model.problem, num_equations(), num_variables());
  }
  std::vector<std::size_t> equations;  // among the rows
  RowNumbers candidates;               // among the equations
  for (std::size_t i = 0; i < parts.rows.kept.size(); ++i) {
    if (!parts.rows.kept[i]->is_equation()) continue;
    if (parts.rows.kept[i]->is_of_case) {
      candidates.push_back(static_cast<Eigen::Index>(equations.size()));
    }
    equations.push_back(i);
  }
  if (candidates.size() < 2) return;
  std::vector<Eigen::MatrixXd> jacobians;
  const auto wanted = static_cast<std::size_t>(options.solutions_wanted);
  for (const Eigen::VectorXd& x : find_solutions(*this, 1, wanted, options)) {
    Eigen::VectorXd residual;
    evaluate_equations(*this, x, false, residual, jacobians.emplace_back());
  }
  if (jacobians.size() < static_cast<std::size_t>(options.fewest_solutions)) return;
  // One after the other: the equation without which the remaining ones are most independent, of
  // those that hold wherever the remaining ones do.
  const SelectedRows all = parts.rows;
  const auto leave_out = [&](RowNumbers numbers) {
    SelectedRows rows = all;
    std::sort(numbers.rbegin(), numbers.rend());
    for (const Eigen::Index i : numbers) report_row(rows, equations[static_cast<std::size_t>(i)]);
    parts.select(std::move(rows));
  };
  RowNumbers left_out;
  while (!candidates.empty()) {
    const auto with = [&left_out](Eigen::Index candidate) {
      RowNumbers more = left_out;
      more.push_back(candidate);
      return more;
    };
    std::vector<std::pair<double, Eigen::Index>> ranked;
    for (const Eigen::Index candidate : candidates) {
      ranked.emplace_back(independence(jacobians, with(candidate), options), candidate);
    }
    std::stable_sort(ranked.begin(), ranked.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    const auto implied = std::find_if(ranked.begin(), ranked.end(), [&](const auto& one) {
      if (!(one.first > 0)) return false;
      leave_out(with(one.second));
      return reported_rows_hold(*this, parts.rows, options);
    });
    if (implied == ranked.end()) break;
    left_out.push_back(implied->second);
    candidates.erase(std::find(candidates.begin(), candidates.end(), implied->second));
  }
  leave_out(left_out);
  parts.evaluations = 0;
}

}  // namespace stillbase
