#include <stillbase/formulation/formulation.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include <stillbase/core/error.hpp>
#include <stillbase/core/random.hpp>

#include "formulation/formulation_parts.hpp"

namespace stillbase {

namespace {

double median(std::vector<double> sizes) {
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return *middle;
}

/// |y| of the response's size where nothing of it cancels: the base takes all of the angular
/// momentum and rotates as fast as the joints.
double size_without_cancellation(const Formulation::Parts& parts, const NominalPoint& here) {
  ScenarioImpact<double> impact = here.impact;
  ImpactResponse<double>& response = impact.response;
  response.base.setConstant(response.total.norm());
  response.d.Delta_Omega.tail<3>().array() += response.d.Delta_phidot.norm();
  return std::sqrt(2 * parts.jump.objective(here.posture, impact, 1));
}

/// Median of |y| over evenly spread points; dividing by it makes the objective of order one. Where
/// the objective vanishes everywhere but for rounding: the size of what cancels.
double typical_objective(const Formulation::Parts& parts) {
  constexpr int kSamples = 15;
  constexpr double kRounding = 1e-12;
  const CaptureModel& model = parts.model;
  std::vector<double> sizes, larger;
  for (int sample = 0; sample < kSamples; ++sample) {
    const Eigen::VectorXd u = low_discrepancy_point(sample, model.layout.size, 0);
    const NominalPoint here(model, model.layout.start_point(model.problem, u));
    sizes.push_back(std::sqrt(2 * parts.objective(here, nullptr)));
    larger.push_back(size_without_cancellation(parts, here));
  }
  const double size = median(sizes), whole = median(larger);
  if (size > kRounding * whole) return size;
  return whole > 0 ? whole : 1;
}

/// Calls use(variable, lower, upper) for each joint that is a variable and has limits.
template <class Use>
void for_each_limited_joint(const CaptureModel& model, const Use& use) {
  const VariableLayout& layout = model.layout;
  for (std::size_t i = 0; i < layout.joints.size(); ++i) {
    const Joint& joint = model.problem.robot.joints[static_cast<std::size_t>(layout.joints[i])];
    if (joint.type == JointType::Continuous) continue;
    const auto j = static_cast<Eigen::Index>(i);
    use(j, layout.lower_limit[j], layout.upper_limit[j]);
  }
}

/// Where a user's function is not defined no limit is kept.
double violation_of(double value, double lower, double upper) {
  if (!std::isfinite(value)) return kInfinity;
  return std::max({lower - value, value - upper, 0.0});
}

}  // namespace

std::string to_string(const std::vector<RedundantRow>& rows) {
  static constexpr const char* kReasons[] = {
      "zero everywhere", "holds where other constraints do", "combination of other equations",
      "implied by other equations"};  // in the order of Redundancy
  std::string out;
  for (const RedundantRow& row : rows)
    out += row.name + ": " + kReasons[static_cast<int>(row.reason)] + "\n";
  return out;
}

Formulation::Parts::Parts(const CaptureProblem& problem, const EncounterModel& known)
    : model(problem, known),
      jump(problem),
      differenced(problem),
      constraints(constraints_of(model)) {
  if (model.residual && !differenced.empty()) {
    throw InputError({Finding{problem.source, 0, "not-supported",
                              "uncertainty.residual_velocity: needs objectives that are linear in "
                              "the impulse, not simulated or given by a function"}});
  }
  SelectedRows selected = select_independent_rows(model, constraints);
  for (const UserConstraint& one : problem.user.constraints) {
    constraints.rows.push_back(user_constraint(one));
    selected.kept.push_back(constraints.rows.back().get());
  }
  // Last, so that a report lists the rows before them.
  for (const auto& part : constraints.parts) selected.kept.push_back(part.get());
  select(std::move(selected));
}

void Formulation::Parts::select(SelectedRows selected) {
  rows = std::move(selected);
  rows_need_inertia = rows_need_encounter = rows_need_impact = false;
  for (const Constraint* row : rows.kept) {
    rows_need_inertia = rows_need_inertia || row->needs_inertia || row->needs_impact;
    rows_need_encounter = rows_need_encounter || row->needs_encounter || row->needs_impact;
    rows_need_impact = rows_need_impact || row->needs_impact;
  }
  spheres.clear();
  for (const Constraint* row : rows.kept) spheres.push_back(row->spheres());
}

PostureImpact<double> Formulation::Parts::posture_of_rows(const Placement<double>& at) const {
  return rows_need_inertia ? model.posture(at) : model.hand(at);
}

ScenarioImpact<double> Formulation::Parts::impact_of_rows(
    const Placement<double>& at, const PostureImpact<double>& posture) const {
  if (rows_need_impact) return model.impact(at, posture, model.nominal);
  if (rows_need_encounter) return model.encounter_of(at, model.nominal);
  return {};
}

Formulation::Formulation(const CaptureProblem& problem)
    : Formulation(problem, stillbase::encounter_model(problem)) {}

Formulation::Formulation(const CaptureProblem& problem, const EncounterModel& known)
    : parts_(std::make_unique<Parts>(problem, known)) {
  parts_->objective_unit = typical_objective(*parts_);
  remove_implied_rows();
}

Formulation::~Formulation() = default;

int Formulation::num_variables() const { return parts_->model.layout.size; }
int Formulation::num_constraints() const { return static_cast<int>(parts_->rows.kept.size()); }
int Formulation::num_equations() const { return parts_->rows.num_equations(); }
Eigen::VectorXd Formulation::lower() const { return parts_->model.layout.lower; }
Eigen::VectorXd Formulation::upper() const { return parts_->model.layout.upper; }

namespace {

/// One of the bounds of the rows.
Eigen::VectorXd bounds_of(const std::vector<const Constraint*>& rows,
                          double ConstraintLabel::*bound) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(rows.size()));
  std::transform(rows.begin(), rows.end(), out.begin(),
                 [bound](const Constraint* row) { return row->*bound; });
  return out;
}

}  // namespace

Eigen::VectorXd Formulation::constraint_lower() const {
  return bounds_of(parts_->rows.kept, &ConstraintLabel::lower);
}
Eigen::VectorXd Formulation::constraint_upper() const {
  return bounds_of(parts_->rows.kept, &ConstraintLabel::upper);
}

bool Formulation::may_have_kinks(int i) const {
  return parts_->rows.kept[static_cast<std::size_t>(i)]->has_kinks;
}

double Formulation::Parts::objective(const Placement<double>& at,
                                     const PostureImpact<double>& posture,
                                     const ScenarioImpact<double>& impact, const Scenario& scenario,
                                     GradientRow* gradient) const {
  double value = jump.objective(posture, impact, objective_unit);
  if (gradient != nullptr) {
    model.compress_into(at, jump.gradient(model, posture, impact, objective_unit), *gradient);
  }
  if (!differenced.empty()) add_differenced(at, scenario, value, gradient);
  return value;
}

void Formulation::Parts::add_differenced(const Placement<double>& at, const Scenario& scenario,
                                         double& value, GradientRow* gradient) const {
  if (differenced.is_simulated() && simulations_stop.reached()) {
    value = std::numeric_limits<double>::quiet_NaN();
    if (gradient != nullptr) gradient->setConstant(value);
    return;
  }
  const Eigen::VectorXd x = at.x;
  const Eigen::VectorXd y = differenced.value(model, x, scenario, objective_unit, simulations_stop);
  value += y.squaredNorm() / 2;
  if (gradient == nullptr) return;
  *gradient +=
      y.transpose() * differenced.jacobian(model, x, scenario, objective_unit, simulations_stop);
}

bool Formulation::Parts::surely_holds(std::size_t row, const ConstraintPoint<double>& at,
                                      const ShapeOrigins& origins, double by) const {
  const Constraint& constraint = *rows.kept[row];
  const std::optional<ShapeSpheres>& about = spheres[row];
  if (about && about->are_apart(origins, std::max(constraint.lower + by, 0.0))) return true;
  // Closer bounds cost more than they spare for a distance that shall be larger.
  return by == 0 && constraint.surely_holds(at);
}

void Formulation::Parts::evaluate_rows(const ConstraintPoint<double>& at, Eigen::VectorXd& values,
                                       Eigen::MatrixXd* jacobian, double far) const {
  const ShapeOrigins origins(constraints.shapes, at);
  for (std::size_t i = 0; i < rows.kept.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    if (far < kInfinity && surely_holds(i, at, origins, far)) {
      assert(std::isfinite(rows.kept[i]->lower) && !std::isfinite(rows.kept[i]->upper));
      values[row] = rows.kept[i]->lower + far;
      jacobian->row(row).setZero();
      continue;
    }
    values[row] = jacobian == nullptr ? rows.kept[i]->value(at)
                                      : rows.kept[i]->value_and_gradient(at, jacobian->row(row));
  }
}

double Formulation::Parts::objective(const NominalPoint& here, GradientRow* gradient) const {
  return objective(here.at, here.posture, here.impact, model.nominal, gradient);
}

void Formulation::evaluate_value(const Eigen::VectorXd& x, nlp::Evaluation& out) const {
  parts_->count(1);
  const NominalPoint here(parts_->model, x);
  out.objective = parts_->objective(here, nullptr);
  out.constraints.resize(num_constraints());
  parts_->evaluate_rows({parts_->model, here.at, here.posture, here.impact}, out.constraints,
                        nullptr);
}

void Formulation::evaluate(const Eigen::VectorXd& x, nlp::Evaluation& out) const {
  parts_->count(1);
  const NominalPoint here(parts_->model, x);
  out.gradient.resize(x.size());
  GradientRow gradient = out.gradient.transpose();
  out.objective = parts_->objective(here, &gradient);
  out.constraints.resize(num_constraints());
  out.jacobian.resize(num_constraints(), x.size());
  parts_->evaluate_rows({parts_->model, here.at, here.posture, here.impact}, out.constraints,
                        &out.jacobian, out.far);
}

void Formulation::evaluate_violated(const Eigen::VectorXd& x, bool equations_alone, bool with_y,
                                    Eigen::VectorXd& violation, Eigen::MatrixXd& jacobian) const {
  parts_->count(1);
  const CaptureModel& model = parts_->model;
  const auto placement = model.place<double>(x);
  const auto posture = with_y ? model.posture(placement) : parts_->posture_of_rows(placement);
  const auto nominal = with_y ? model.impact(placement, posture, model.nominal)
                              : parts_->impact_of_rows(placement, posture);
  const ConstraintPoint<double> at{model, placement, posture, nominal};
  const ShapeOrigins origins(parts_->constraints.shapes, at);
  std::vector<const Constraint*> counting;
  counting.reserve(parts_->rows.kept.size());
  for (std::size_t i = 0; i < parts_->rows.kept.size(); ++i) {
    const Constraint* row = parts_->rows.kept[i];
    if (!row->is_equation()) {
      if (equations_alone || parts_->surely_holds(i, at, origins, 0)) continue;
      const double value = row->value(at);
      if (!(value > row->upper || value < row->lower)) continue;
    }
    counting.push_back(row);
  }
  const auto count = static_cast<Eigen::Index>(counting.size());
  if (with_y) {
    parts_->add_vector(placement, posture, nominal, count, violation, jacobian);
  } else {
    violation.resize(count);
    jacobian.resize(count, x.size());
  }
  for (Eigen::Index i = 0; i < count; ++i) {
    const Constraint& row = *counting[static_cast<std::size_t>(i)];
    const double value = row.value_and_gradient(at, jacobian.row(i));
    violation[i] = value > row.upper   ? value - row.upper
                   : value < row.lower ? value - row.lower
                                       : 0.0;
  }
}

Scenario Formulation::nominal_scenario() const { return parts_->model.nominal; }

void Formulation::objective_vector(const Eigen::VectorXd& x, Eigen::VectorXd& y,
                                   Eigen::MatrixXd& jacobian) const {
  parts_->count(1);
  const NominalPoint here(parts_->model, x);
  parts_->add_vector(here.at, here.posture, here.impact, 0, y, jacobian);
}

void Formulation::evaluate_vector(const Eigen::VectorXd& x, nlp::Evaluation& out,
                                  Eigen::VectorXd& y, Eigen::MatrixXd& jacobian) const {
  parts_->count(1);
  const NominalPoint here(parts_->model, x);
  parts_->add_vector(here.at, here.posture, here.impact, 0, y, jacobian);
  out.objective = y.squaredNorm() / 2;
  out.gradient.noalias() = jacobian.transpose() * y;
  out.constraints.resize(num_constraints());
  out.jacobian.resize(num_constraints(), x.size());
  parts_->evaluate_rows({parts_->model, here.at, here.posture, here.impact}, out.constraints,
                        &out.jacobian, out.far);
}

void Formulation::Parts::add_vector(const Placement<double>& at,
                                    const PostureImpact<double>& posture,
                                    const ScenarioImpact<double>& impact, Eigen::Index first,
                                    Eigen::VectorXd& y, Eigen::MatrixXd& jacobian) const {
  const double scale = impact.p / objective_unit;
  Eigen::Index size = first;
  for (const JumpObjective::Term& term : jump.terms()) {
    size += JumpObjective::value(term, posture, impact.response).size();
  }
  Eigen::VectorXd others;
  if (!differenced.empty()) {
    others = differenced.value(model, at.x, model.nominal, objective_unit, simulations_stop);
  }
  y.resize(size + others.size());
  jacobian.resize(y.size(), at.x.size());
  Eigen::Index row = first;
  for (const JumpObjective::Term& term : jump.terms()) {
    const JointVectord of_term = JumpObjective::value(term, posture, impact.response);
    for (Eigen::Index i = 0; i < of_term.size(); ++i, ++row) {
      ResponseWeights<double> weights;
      const JointVectord u = scale * JointVectord::Unit(of_term.size(), i);
      JumpObjective::add_weights(term, u, posture, impact.response, weights);
      y[row] = scale * of_term[i];
      model.compress_into(at, model.scaled_gradient(posture, impact, weights, y[row]),
                          jacobian.row(row));
    }
  }
  if (others.size() == 0) return;
  y.tail(others.size()) = others;
  jacobian.bottomRows(others.size()) =
      differenced.jacobian(model, at.x, model.nominal, objective_unit, simulations_stop);
}

bool Formulation::has_hessian() const {
  const std::vector<const Constraint*>& rows = parts_->rows.kept;
  return parts_->differenced.empty() &&
         std::all_of(rows.begin(), rows.end(),
                     [](const Constraint* row) { return row->has_hessian(); });
}

const std::vector<RedundantRow>& Formulation::redundant_rows() const {
  return parts_->rows.redundant;
}

const EncounterModel& Formulation::encounter_model() const { return parts_->model.encounter; }

Encounter<double> Formulation::encounter(const Configuration& configuration) const {
  const CaptureModel& model = parts_->model;
  const auto at = model.place<double>(variables(configuration));
  return encounter_along<double>(model.encounter, at.contact, model.nominal);
}

double Formulation::objective_unit() const { return parts_->objective_unit; }
Power Formulation::objective_power() const {
  return stillbase::objective_power(parts_->model.problem);
}

Configuration Formulation::configuration(const Eigen::VectorXd& x) const {
  return parts_->model.configuration(x);
}

Eigen::VectorXd Formulation::variables(const Configuration& configuration) const {
  return parts_->model.layout.variables(parts_->model.problem, configuration);
}

Eigen::VectorXd Formulation::start_point(const Eigen::VectorXd& u) const {
  return parts_->model.layout.start_point(parts_->model.problem, u);
}

bool Formulation::are_within(const Eigen::VectorXd& a, const Eigen::VectorXd& b,
                             double most) const {
  return parts_->model.layout.are_within(parts_->model.problem, a, b, most);
}

double Formulation::distance(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const {
  return parts_->model.layout.distance(parts_->model.problem, a, b);
}

Eigen::VectorXd Formulation::difference(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const {
  return parts_->model.layout.difference(a, b);
}

Eigen::VectorXd Formulation::normalised(const Eigen::VectorXd& x) const {
  return parts_->model.layout.normalised(parts_->model.problem, x);
}

Eigen::VectorXd Formulation::within_limits(const Eigen::VectorXd& x) const {
  return parts_->model.layout.within_limits(parts_->model.problem, x);
}

std::vector<ConstraintValue> Formulation::report(const Eigen::VectorXd& x) const {
  std::vector<ConstraintValue> out;
  const auto add = [&out](const ConstraintLabel& row) {
    out.push_back({.name = row.name, .unit = row.unit});
  };
  for (const Constraint* row : parts_->rows.kept) {
    if (!row->is_part) add(*row);
  }
  for (const Constraint* row : parts_->rows.reported) add(*row);
  for (const auto& row : parts_->constraints.reported) add(*row);
  for (const int k : parts_->model.layout.joints) {
    const Joint& joint = parts_->model.problem.robot.joints[static_cast<std::size_t>(k)];
    if (joint.type == JointType::Continuous) continue;
    out.push_back(
        {.name = "joint_limit_" + joint.name, .unit = joint.is_prismatic() ? "m" : "rad"});
  }
  update_report(x, out);
  return out;
}

void Formulation::update_report(const Eigen::VectorXd& x, std::vector<ConstraintValue>& out) const {
  const CaptureModel& model = parts_->model;
  const NominalPoint here(model, x);
  const ConstraintPoint<double> point{model, here.at, here.posture, here.impact};
  std::size_t next = 0;
  const auto set = [&](double value, double lower, double upper) {
    ConstraintValue& entry = out[next++];
    entry.value = value;
    entry.lower = lower;
    entry.upper = upper;
    entry.violation = violation_of(value, lower, upper);
  };
  const auto set_row = [&](const Constraint& row) { set(row.value(point), row.lower, row.upper); };
  for (const Constraint* row : parts_->rows.kept) {
    if (!row->is_part) set_row(*row);
  }
  for (const Constraint* row : parts_->rows.reported) set_row(*row);
  for (const auto& row : parts_->constraints.reported) set_row(*row);
  for_each_limited_joint(
      model, [&](Eigen::Index j, double lower, double upper) { set(x[j], lower, upper); });
}

double Formulation::largest_violation(const Eigen::VectorXd& x) const {
  const CaptureModel& model = parts_->model;
  const auto placement = model.place<double>(x);
  // Of the rows that no optimizer takes it is not known what they need.
  const bool is_whole = !parts_->rows.reported.empty() || !parts_->constraints.reported.empty();
  const auto posture = is_whole ? model.posture(placement) : parts_->posture_of_rows(placement);
  const auto impact = is_whole ? model.impact(placement, posture, model.nominal)
                               : parts_->impact_of_rows(placement, posture);
  const ConstraintPoint<double> at{model, placement, posture, impact};
  const ShapeOrigins origins(parts_->constraints.shapes, at);
  double worst = 0;
  const auto look_at = [&](const Constraint& row) {
    worst = std::max(worst, violation_of(row.value(at), row.lower, row.upper));
  };
  for (std::size_t i = 0; i < parts_->rows.kept.size(); ++i) {
    const Constraint& row = *parts_->rows.kept[i];
    if (row.is_part) continue;
    if (row.is_equation() || !parts_->surely_holds(i, at, origins, 0)) look_at(row);
  }
  for (const Constraint* row : parts_->rows.reported) look_at(*row);
  for (const auto& row : parts_->constraints.reported) look_at(*row);
  for_each_limited_joint(model, [&](Eigen::Index j, double lower, double upper) {
    worst = std::max(worst, violation_of(x[j], lower, upper));
  });
  return worst;
}

std::vector<ConstraintValue> Formulation::report_limits(const Eigen::VectorXd& x) const {
  const NominalPoint here(parts_->model, x);
  std::vector<ConstraintValue> out;
  for (const Constraint* row : parts_->rows.kept) {
    if (!row->is_limit || row->is_part) continue;
    const double value = row->value({parts_->model, here.at, here.posture, here.impact});
    out.push_back(
        {row->name, value, row->lower, row->upper, violation_of(value, row->lower, row->upper)});
  }
  return out;
}

void Formulation::reserve_motion(double rotation) { parts_->model.reserve_motion(rotation); }

void Formulation::set_cone_half_angle(double half_angle) {
  parts_->model.problem.uncertainty.cone_half_angle = half_angle;
}

void Formulation::set_target_state(const TargetState& estimate) {
  parts_->model.set_target_state(estimate);
}

long Formulation::evaluations() const { return parts_->evaluations; }

void Formulation::give_up_simulations_at(const StopCondition& stop) {
  parts_->simulations_stop = stop;
}

const StopCondition& Formulation::simulations_stop() const { return parts_->simulations_stop; }

}  // namespace stillbase
