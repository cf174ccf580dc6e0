#include <stillbase/benchmark/program.hpp>

#include <cmath>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/formulation/formulation.hpp>

#include "formulation/formulation_parts.hpp"
#include "formulation/measures/scenario_program.hpp"
#include "formulation/projection.hpp"

namespace stillbase {

namespace {

/// 1/2 |case equations|^2 with the other constraints of a formulation.
class CaseProgram final : public nlp::Problem {
 public:
  explicit CaseProgram(const Formulation& formulation) : formulation_(formulation) {
    const auto& rows = formulation.parts().rows.kept;
    for (int i = 0; i < formulation.num_constraints(); ++i) {
      const bool is_of_case = rows[static_cast<std::size_t>(i)]->is_of_case;
      (is_of_case ? equations_ : others_).push_back(i);
    }
  }

  int num_variables() const override { return formulation_.num_variables(); }
  int num_constraints() const override { return static_cast<int>(others_.size()); }
  Eigen::VectorXd lower() const override { return formulation_.lower(); }
  Eigen::VectorXd upper() const override { return formulation_.upper(); }
  Eigen::VectorXd constraint_lower() const override {
    return formulation_.constraint_lower()(others_);
  }
  Eigen::VectorXd constraint_upper() const override {
    return formulation_.constraint_upper()(others_);
  }
  void evaluate(const Eigen::VectorXd& x, nlp::Evaluation& out) const override {
    nlp::Evaluation here;
    formulation_.evaluate(x, here);
    const Eigen::VectorXd r = here.constraints(equations_);
    out.objective = r.squaredNorm() / 2;
    out.gradient = here.jacobian(equations_, Eigen::all).transpose() * r;
    out.constraints = here.constraints(others_);
    out.jacobian = here.jacobian(others_, Eigen::all);
  }
  void evaluate_value(const Eigen::VectorXd& x, nlp::Evaluation& out) const override {
    nlp::Evaluation here;
    formulation_.evaluate_value(x, here);
    out.objective = Eigen::VectorXd(here.constraints(equations_)).squaredNorm() / 2;
    out.constraints = here.constraints(others_);
  }
  bool has_hessian() const override { return true; }
  void lagrangian_hessian(const Eigen::VectorXd& x, double sigma,
                          const Eigen::VectorXd& multipliers, Eigen::MatrixXd& out) const override {
    nlp::Evaluation here;
    formulation_.evaluate(x, here);
    Eigen::VectorXd all = Eigen::VectorXd::Zero(formulation_.num_constraints());
    all(equations_) = sigma * here.constraints(equations_);
    all(others_) = multipliers;
    formulation_.lagrangian_hessian(x, 0, all, out);
    const Eigen::MatrixXd J = here.jacobian(equations_, Eigen::all);
    out += sigma * J.transpose() * J;
  }

 private:
  const Formulation& formulation_;
  std::vector<int> equations_, others_;
};

/// The nominal direction, four on a ring at half the angle and eight on the rim; planar: nine
/// over the wedge.
std::vector<Scenario> fixed_directions(const CaptureProblem& problem,
                                       const Formulation& formulation) {
  const Scenario nominal = formulation.nominal_scenario();
  const double half_angle = problem.uncertainty.cone_half_angle;
  std::vector<Scenario> out;
  const auto add = [&](const Vector3d& axis, double angle) {
    out.push_back(nominal);
    out.back().direction = Eigen::AngleAxisd(angle, axis) * nominal.direction;
  };
  if (problem.uncertainty.cone_plane_normal) {
    for (int i = -4; i <= 4; ++i) add(*problem.uncertainty.cone_plane_normal, half_angle * i / 4);
    return out;
  }
  out.push_back(nominal);
  const Vector3d across = nominal.direction.unitOrthogonal();
  const auto ring = [&](int count, double angle) {
    for (int i = 0; i < count; ++i) {
      add(Eigen::AngleAxisd(2 * kPi * i / count, nominal.direction) * across, angle);
    }
  };
  ring(4, half_angle / 2);
  ring(8, half_angle);
  return out;
}

}  // namespace

struct BenchmarkProgram::Parts {
  BenchmarkGoal goal;
  Formulation formulation;
  std::unique_ptr<Formulation> without_case;  ///< Case: for start points; else null
  std::unique_ptr<nlp::Problem> program;      ///< null: the formulation itself
  Eigen::VectorXd lower, upper;

  explicit Parts(const BenchmarkInstance& instance)
      : goal(instance.goal), formulation(instance.problem) {
    lower = formulation.lower();
    upper = formulation.upper();
    for (int i = 0; i < lower.size(); ++i) {
      if (!std::isfinite(lower[i])) lower[i] = -kPi;
      if (!std::isfinite(upper[i])) upper[i] = kPi;
    }
    if (goal == BenchmarkGoal::Case) {
      program = std::make_unique<CaseProgram>(formulation);
      CaptureProblem problem = instance.problem;
      problem.constraints.impact_case = CaseConstraint::None;
      without_case = std::make_unique<Formulation>(problem);
    }
    if (goal == BenchmarkGoal::WorstCase) {
      program = std::make_unique<ScenarioProgram>(
          formulation, fixed_directions(instance.problem, formulation), 1);
      // f >= 0, but a bound there would stop a solver that steps onto it twice; postures ten times
      // worse than usual ones, f = 50, are of no interest.
      lower.conservativeResize(lower.size() + 1);
      upper.conservativeResize(upper.size() + 1);
      lower[lower.size() - 1] = -1;
      upper[upper.size() - 1] = 50;
    }
  }

  const nlp::Problem& inner() const {
    if (program) return *program;
    return formulation;
  }
  const Formulation& for_starts() const { return without_case ? *without_case : formulation; }
  Eigen::VectorXd lifted(const Eigen::VectorXd& configuration) const {
    if (goal != BenchmarkGoal::WorstCase) return configuration;
    return static_cast<const ScenarioProgram&>(inner()).lifted(configuration);
  }
};

BenchmarkProgram::BenchmarkProgram(const BenchmarkInstance& instance)
    : parts_(std::make_unique<Parts>(instance)) {}
BenchmarkProgram::~BenchmarkProgram() = default;

const nlp::Problem& BenchmarkProgram::inner() const { return parts_->inner(); }
Eigen::VectorXd BenchmarkProgram::lower() const { return parts_->lower; }
Eigen::VectorXd BenchmarkProgram::upper() const { return parts_->upper; }
int BenchmarkProgram::free_variables() const { return parts_->formulation.num_variables(); }
int BenchmarkProgram::equations() const { return parts_->formulation.num_equations(); }

Eigen::VectorXd BenchmarkProgram::start(int index, std::uint64_t seed,
                                        const StartOptions& options) const {
  constexpr int kStride = 1000000;  // more starts than any run has
  const Formulation& formulation = parts_->for_starts();
  ProjectionResult best;
  best.violation = nlp::kInfinity;
  for (int draw = 0; draw < options.draws && best.violation > options.on_constraints; ++draw) {
    const Eigen::VectorXd x = formulation.start_point(
        low_discrepancy_point(index + draw * kStride, formulation.num_variables(), seed));
    const ProjectionResult moved = project_onto_constraints(formulation, x, false, options.steps);
    if (best.x.size() == 0 || moved.violation < best.violation) best = moved;
  }
  return parts_->lifted(best.x);
}

Eigen::VectorXd BenchmarkProgram::on_constraints(const Eigen::VectorXd& x,
                                                 const StartOptions& options) const {
  const Eigen::VectorXd configuration = x.head(parts_->formulation.num_variables());
  return parts_->lifted(
      project_onto_constraints(parts_->for_starts(), configuration, false, options.steps).x);
}

long BenchmarkProgram::model_evaluations() const {
  return parts_->formulation.evaluations() +
         (parts_->without_case ? parts_->without_case->evaluations() : 0);
}

Judged BenchmarkProgram::judge(const Eigen::VectorXd& x, const nlp::Evaluation& at_x) const {
  Judged out;
  const Eigen::Index m = parts_->goal == BenchmarkGoal::WorstCase
                             ? parts_->formulation.num_constraints()
                             : num_constraints();
  const Eigen::VectorXd g =
      nlp::signed_violation(at_x.constraints, constraint_lower(), constraint_upper());
  const Eigen::VectorXd box = nlp::signed_violation(x, lower(), upper());
  out.violation = box.cwiseAbs().maxCoeff();
  if (m > 0) out.violation = std::max(out.violation, g.head(m).cwiseAbs().maxCoeff());
  double f = at_x.objective;
  if (parts_->goal == BenchmarkGoal::WorstCase) {
    // The rows below the formulation's are s - f_k: the worst f_k, whatever s says.
    f = x[x.size() - 1] - at_x.constraints.tail(at_x.constraints.size() - m).minCoeff();
  }
  out.value = std::sqrt(2 * std::max(0.0, f));
  return out;
}

double BenchmarkProgram::distance(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const {
  const int n = free_variables();
  return parts_->formulation.distance(a.head(n), b.head(n));
}

}  // namespace stillbase
