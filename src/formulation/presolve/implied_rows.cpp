// Equations of a case that others imply wherever they hold.
//
// The base part of an arm whose joints give way in two directions only is M z with z of two
// components: three equations, two of which say it all. Away from z = 0 their gradients are
// independent, at z = 0 they are not, and there sequential quadratic programming stops: the
// optimizers get two of them. What a plan reports, and is judged by, are all.
//
// Where there are more equations than variables, every Jacobian is short of rank: which of them are
// implied is asked of the same case without the hand's equations and with every joint and the base
// attitude free. What holds there holds here.
#include <algorithm>
#include <stillbase/core/linear_algebra.hpp>

#include <stillbase/core/error.hpp>
#include <stillbase/core/random.hpp>

#include "formulation/equations.hpp"
#include "formulation/formulation_parts.hpp"
#include "formulation/projection.hpp"

namespace stillbase {

namespace {

constexpr double kRank = 1e-6;  ///< of the largest singular value, at solutions to 1e-10

bool is_case_row(const Row& row) {
  return row.kind == RowKind::CaseTotal || row.kind == RowKind::CaseBase ||
         row.kind == RowKind::CaseCoupling || row.kind == RowKind::CouplingColumn;
}

/// Singular values over the largest of them.
Eigen::VectorXd relative_sizes(const Eigen::MatrixXd& J) {
  const Eigen::VectorXd sizes = singular_values(J);
  return sizes / std::max(sizes.maxCoeff(), 1e-300);
}

/// Jacobians of the equations at a few solutions.
std::vector<Eigen::MatrixXd> jacobians_at_solutions(const Formulation& formulation) {
  constexpr int kTrials = 24;
  constexpr std::size_t kEnough = 8;
  std::vector<Eigen::MatrixXd> out;
  for (int trial = 0; trial < kTrials && out.size() < kEnough; ++trial) {
    const Eigen::VectorXd start =
        formulation.start_point(low_discrepancy_point(trial, formulation.start_dimension(), 1));
    const ProjectionResult there = project_onto_constraints(formulation, start, false, 40);
    if (!(there.violation <= 1e-10)) continue;
    Eigen::VectorXd residual;
    out.emplace_back();
    evaluate_equations(formulation, there.x, false, residual, out.back());
  }
  return out;
}

Eigen::Index rank_of(const Eigen::MatrixXd& J) {
  return (relative_sizes(J).array() > kRank).count();
}

/// Whether the rows that were set aside vanish where the others do. Equations that depend on each
/// other at their solutions may have others where one of them is left out: a product is zero where
/// either factor is.
bool hold_where_the_rest_does(const Formulation& formulation, const std::vector<Row>& aside) {
  constexpr int kTrials = 24;
  constexpr double kHolds = 1e-6;
  int solved = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Eigen::VectorXd start =
        formulation.start_point(low_discrepancy_point(trial, formulation.start_dimension(), 2));
    const ProjectionResult there = project_onto_constraints(formulation, start, false, 40);
    if (!(there.violation <= 1e-10)) continue;
    ++solved;
    for (const ConstraintValue& value : formulation.report(there.x)) {
      const bool is_aside = std::any_of(aside.begin(), aside.end(),
                                        [&](const Row& row) { return row.name == value.name; });
      if (is_aside && value.violation > kHolds) return false;
    }
  }
  return solved > 0;
}

/// How well the rows whose number is not in `left_out` determine the solutions: the middle over the
/// Jacobians of their smallest relative singular value that counts; 0 where the rank is not what
/// that of all rows is.
double independence(const std::vector<Eigen::MatrixXd>& jacobians,
                    const std::vector<Eigen::Index>& left_out) {
  std::vector<double> least;
  for (const Eigen::MatrixXd& J : jacobians) {
    Eigen::MatrixXd kept(J.rows() - static_cast<Eigen::Index>(left_out.size()), J.cols());
    Eigen::Index to = 0;
    for (Eigen::Index i = 0; i < J.rows(); ++i) {
      if (std::find(left_out.begin(), left_out.end(), i) == left_out.end()) {
        kept.row(to++) = J.row(i);
      }
    }
    const Eigen::Index rank = rank_of(J);
    if (rank == 0 || kept.rows() < rank || rank_of(kept) < rank) return 0;
    least.push_back(relative_sizes(kept)[rank - 1]);
  }
  std::nth_element(least.begin(), least.begin() + static_cast<long>(least.size() / 2), least.end());
  return least[least.size() / 2];
}

/// The same case of the same robot and impulse with all the freedom that a problem can have.
CaptureProblem freed(CaptureProblem problem) {
  const ConstraintSpec stated = problem.constraints;
  problem.constraints = {};
  problem.constraints.impact_case = stated.impact_case;
  problem.constraints.closing_speed_min = stated.closing_speed_min;
  problem.hand.constraint = HandConstraint::None;
  problem.objective = {{}};  // none that is simulated
  problem.variables.joints.assign(problem.variables.joints.size(), true);
  problem.variables.base_attitude = AttitudeFreedom::Free;
  problem.variables.base_attitude_max = VariableSpec{}.base_attitude_max;
  problem.variables.base_position = PositionFreedom::Free;
  return problem;
}

[[noreturn]] void refuse_too_few(const CaptureProblem& problem, int equations, int variables) {
  throw InputError({Finding{
      problem.source, 0, "too-few-variables",
      "the constraints impose " + std::to_string(equations) + " independent equations, but only " +
          std::to_string(variables) +
          " variables are free; free more joints, the base attitude or the contact time"}});
}

}  // namespace

void Formulation::set_implied_rows_aside() {
  Parts& parts = *parts_;
  if (num_equations() > num_variables()) {
    const CaptureProblem wider = freed(parts.problem);
    const bool is_freed = parts.problem.hand.constraint == HandConstraint::None &&
                          VariableLayout(wider).size == num_variables();
    std::vector<Row> implied;
    try {
      if (!is_freed) implied = Formulation(wider).parts_->implied_rows;
    } catch (const InputError&) {
      // There, too, they are more than the variables: nobody knows which of them others imply.
    }
    for (const Row& other : implied) {
      const auto row = std::find_if(parts.rows.begin(), parts.rows.end(),
                                    [&](const Row& own) { return own.name == other.name; });
      if (row == parts.rows.end()) continue;
      parts.implied_rows.push_back(*row);
      parts.rows.erase(row);
    }
  }
  if (num_equations() > num_variables()) {
    refuse_too_few(parts.problem, num_equations(), num_variables());
  }
  std::vector<std::size_t> equations;  // among the rows
  std::vector<Eigen::Index> candidates;
  for (std::size_t i = 0; i < parts.rows.size(); ++i) {
    if (parts.rows[i].lower != parts.rows[i].upper) continue;
    if (is_case_row(parts.rows[i])) {
      candidates.push_back(static_cast<Eigen::Index>(equations.size()));
    }
    equations.push_back(i);
  }
  if (candidates.size() < 2) return;
  const std::vector<Eigen::MatrixXd> jacobians = jacobians_at_solutions(*this);
  constexpr std::size_t kFewest = 3;
  if (jacobians.size() < kFewest) return;
  // One after the other: the one without which the rest is most independent, of those that hold
  // wherever the rest does.
  const std::vector<Row> rows = parts.rows, implied = parts.implied_rows;
  const auto leave_out = [&](std::vector<Eigen::Index> numbers) {
    parts.rows = rows;
    parts.implied_rows = implied;
    std::sort(numbers.rbegin(), numbers.rend());
    for (const Eigen::Index i : numbers) {
      const auto row =
          parts.rows.begin() + static_cast<long>(equations[static_cast<std::size_t>(i)]);
      parts.implied_rows.push_back(*row);
      parts.rows.erase(row);
    }
  };
  std::vector<Eigen::Index> left_out;
  while (!candidates.empty()) {
    std::vector<std::pair<double, Eigen::Index>> rest;
    for (const Eigen::Index candidate : candidates) {
      std::vector<Eigen::Index> more = left_out;
      more.push_back(candidate);
      rest.emplace_back(independence(jacobians, more), candidate);
    }
    std::stable_sort(rest.begin(), rest.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    const auto implied_one = std::find_if(rest.begin(), rest.end(), [&](const auto& one) {
      if (!(one.first > 0)) return false;
      std::vector<Eigen::Index> more = left_out;
      more.push_back(one.second);
      leave_out(more);
      return hold_where_the_rest_does(*this, parts.implied_rows);
    });
    if (implied_one == rest.end()) break;
    left_out.push_back(implied_one->second);
    candidates.erase(std::find(candidates.begin(), candidates.end(), implied_one->second));
  }
  leave_out(left_out);
  parts.evaluations = 0;
}

}  // namespace stillbase
