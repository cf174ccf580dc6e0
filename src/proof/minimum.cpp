#include "proof/minimum_problem.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "proof/case_rows.hpp"
#include "proof/mean_squares.hpp"
#include "proof/objective_kernel.hpp"
#include "proof/plan_boxes.hpp"

namespace stillbase::proof {

namespace {

/// All values of the variables, by as much wider as the planner's may be off; those that are not
/// needed stay at zero.
template <int N>
std::vector<Box<N>> domain_of(const MinimumProblem& problem) {
  const VariableEncounter& model = problem.where.encounter;
  const Interval slack(-problem.tolerances.feasible, problem.tolerances.feasible);
  std::vector<Box<N>> out;
  const auto widen = [&](Box<N>& box, std::size_t i) {
    const bool is_time = model.variables[i].kind == VariableKind::Time;
    box.side[i] += is_time ? slack / Interval(model.time_unit) : slack;
  };
  for (const JointBox& place : problem.places) {
    Box<N>& box = out.emplace_back();
    for (std::size_t i = 0; i < model.variables.size(); ++i) {
      box.side[i] = side_of(model.variables[i], place, model.time_unit);
      widen(box, i);
    }
  }
  if (!out.empty()) return out;
  Box<N>& box = out.emplace_back(domain_of<N>(model));
  for (std::size_t i = 0; i < model.variables.size(); ++i) {
    if (!model.variables[i].is_periodic) widen(box, i);
  }
  return out;
}

/// Weights of the worst impulses, their squares ordered by `squares`: of sum one, each at most its
/// share.
std::vector<double> tail_weights(const std::vector<ImpulseCase>& impulses,
                                 const std::vector<double>& squares, double level) {
  std::vector<std::size_t> order(impulses.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return squares[a] > squares[b] || (squares[a] == squares[b] && a < b);
  });
  std::vector<double> out(impulses.size(), 0.0);
  double left = 1;
  for (const std::size_t k : order) {
    out[k] = std::min(left, impulses[k].weight / (1 - level));
    left -= out[k];
    if (!(left > 0)) break;
  }
  return out;
}

std::vector<double> weights_of(const std::vector<ImpulseCase>& impulses) {
  std::vector<double> out;
  for (const ImpulseCase& impulse : impulses) out.push_back(impulse.weight);
  return out;
}

template <int N>
class ImpactProgram final : public Program<N> {
 public:
  /// @param level value of the measure where the bound has to be sharp
  ImpactProgram(const MinimumProblem& problem, double level)
      : problem_(problem), basis_(problem.impulses), level_(level) {}

  /// One more impulse of a worst case.
  void add(const ImpulseCase& impulse) {
    problem_.impulses.push_back(impulse);
    basis_ = WrenchBasis(problem_.impulses);
  }

  void evaluate(const std::array<Form<N>, N>& x, std::vector<Form<N>>& equations,
                std::vector<Fraction<N>>& values) const override {
    using S = Form<N>;
    const ZeroProblem& where = problem_.where;
    if (is_excluded(x)) {
      equations.push_back(S(1.0));  // vanishes nowhere
      return;
    }
    const EncounterRange<S> at = encounter_over<S>(where.encounter, x);
    const ImpactForms<N> forms(problem_, basis_, at);
    add_equations(at, forms, equations);
    measure(forms, values);
  }

 private:
  bool is_excluded(const std::array<Form<N>, N>& x) const {
    std::array<Dual, N> box;
    for (std::size_t i = 0; i < N; ++i) box[i] = Dual(x[i].range());
    return keeps_inequalities(problem_.where, box) == Kept::No;
  }

  void add_equations(const EncounterRange<Form<N>>& at, const ImpactForms<N>& forms,
                     std::vector<Form<N>>& equations) const {
    const VariableEncounter& encounter = problem_.where.encounter;
    const auto is_of_axes = [](const Row& row) { return row.kind != RowKind::HandPosition; };
    const std::vector<Row>& rows = problem_.where.hand_equations;
    Matrix3<Form<N>> R_hand;
    if (std::any_of(rows.begin(), rows.end(), is_of_axes)) R_hand = forms.hand_axes();
    for (const Row& row : rows) {
      Form<N> off = kinematic_value(row, encounter, at, forms.hand(), R_hand);
      off.r += problem_.tolerances.feasible;
      if (encounter.has(VariableKind::Time)) off.r += problem_.tolerances.integrated;
      equations.push_back(off);
    }
    // A value that has to be between bounds which cut the box, as an equation with a remainder.
    for (const Row& row : problem_.where.inequalities) {
      if (row.kind == RowKind::HandAxis || row.kind == RowKind::HandAxisAlong) continue;
      const Form<N> value = kinematic_value(row, encounter, at, forms.hand(), R_hand);
      const Interval range = value.range();
      const double lower = std::fmax(row.lower, range.lower());
      const double upper = std::fmin(row.upper, range.upper());
      const bool cuts = lower > range.lower() || upper < range.upper();
      if (!value.is_bounded() || !cuts) continue;
      // The range is rounded outwards: an end that is just outside of it cuts nothing off.
      equations.push_back(value - Form<N>::any(Interval(std::fmin(lower, upper), upper)));
    }
  }

  /// Lower bounds of the measure's square.
  void measure(const ImpactForms<N>& forms, std::vector<Fraction<N>>& values) const {
    const std::vector<ImpulseCase>& impulses = problem_.impulses;
    const bool is_tail = problem_.measure == RiskMeasure::Cvar;
    if (problem_.measure != RiskMeasure::Expectation && !is_tail) {
      for (std::size_t k = 0; k < impulses.size(); ++k) {
        add_square(forms.gram(), impulses[k], basis_.weights[k], level_, values);
      }
      return;
    }
    const MeanSquares<N> squares(forms.gram(), impulses, basis_.weights, level_,
                                 problem_.tolerances);
    const std::vector<std::vector<double>> shares =
        is_tail ? tails(squares.squares()) : std::vector<std::vector<double>>{weights_of(impulses)};
    for (const std::vector<double>& each : shares) squares.add_mean(each, values);
    if (!squares.is_contact()) return;
    const std::vector<double> least = squares.least_squares(shares.front());
    const std::vector<double> weights =
        is_tail ? tail_weights(impulses, least, problem_.cvar_level) : shares.front();
    Interval mean(0.0);
    for (std::size_t k = 0; k < least.size(); ++k) mean += Interval(least[k]) * weights[k];
    values.push_back({Form<N>(mean.lower()), 1.0, 1, true});
  }

  /// Shares of the tails that are the worst ones in the middle of the box and near its sides.
  std::vector<std::vector<double>> tails(const std::vector<Quadratic<N>>& squares) const {
    std::vector<std::vector<double>> out;
    for (int i = -1; i < 2 * N; ++i) {
      std::vector<double> at;
      for (const Quadratic<N>& square : squares) {
        const double sign = i % 2 == 0 ? 1 : -1;
        at.push_back(i < 0 ? square.c() : square.c() + sign * square.a(i / 2));
      }
      const std::vector<double> weights = tail_weights(problem_.impulses, at, problem_.cvar_level);
      if (std::find(out.begin(), out.end(), weights) == out.end()) out.push_back(weights);
    }
    return out;
  }

  MinimumProblem problem_;
  WrenchBasis basis_;
  double level_;
};

template <int N>
Bound bound(const MinimumProblem& problem, double best, const MinimumOptions& options,
            const MinimumCallbacks& at) {
  const MinimumTolerances& tolerances = problem.tolerances;
  const double cut = best * (1 + tolerances.best_value), goal = best * (1 - options.relative_gap);
  ImpactProgram<N> program(problem, best);
  const bool is_mean =
      problem.measure == RiskMeasure::Expectation || problem.measure == RiskMeasure::Cvar;
  const double samples = is_mean ? static_cast<double>(problem.impulses.size()) : 0;
  const double work = 1 + samples / tolerances.impulses_per_posture;
  const long boxes = options.max_boxes * 3 / std::max(3, problem.where.robot.n());
  BoundOptions search{.cut = cut * cut,
                      .goal = goal * goal * (1 + 4 * tolerances.unit_vector),
                      .max_boxes = static_cast<long>(static_cast<double>(boxes) / work),
                      .stop = options.stop,
                      .on_progress = options.on_progress,
                      .jobs = options.jobs};
  const int used = problem.where.encounter.num_variables();
  if (at.value) {
    search.value_at = [&](const Eigen::VectorXd& x) {
      const double value = at.value(x.head(used));
      return value * value;
    };
  }
  if (at.worst_impulses) {
    search.add_values = [&](const Eigen::VectorXd& x, double least) {
      double largest = 0;
      const std::vector<WorstImpulse> worst = at.worst_impulses(x.head(used));
      const RoundUpward upward;
      for (const WorstImpulse& each : worst) {
        const double square = each.value * each.value;
        largest = std::max(largest, square);
        if (square > least) program.add(each.impulse);
      }
      return largest;
    };
  }
  Bound out = bound_below<N>(program, domain_of<N>(problem), search);
  for (Eigen::VectorXd& x : out.suspects) x.conservativeResize(used);
  if (out.lower > 0) {  // the root is rounded up
    out.lower = std::nextafter(
        std::nextafter(std::sqrt(out.lower), 0.0) * (1 - tolerances.unit_vector), 0.0);
  } else {
    out.lower = 0;
  }
  return out;
}

}  // namespace

int max_minimum_joints() { return kMaxJointsOf<Form<2>>; }

Bound bound_minimum(const MinimumProblem& problem, double best, const MinimumOptions& options,
                    const MinimumCallbacks& at) {
  const VariableEncounter& encounter = problem.where.encounter;
  assert(problem.where.robot.n() <= max_minimum_joints());
  assert(!problem.impulses.empty() && best > 0);
  assert(!encounter.spin || encounter.spin->is_valid());
  const RoundUpward upward;
  switch (encounter.num_variables()) {
    case 1:
    case 2:
      return bound<2>(problem, best, options, at);
    case 3:
      return bound<3>(problem, best, options, at);
    default:
      assert(!"one to three variables");
      return {};
  }
}

}  // namespace stillbase::proof
