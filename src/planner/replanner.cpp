#include <stillbase/planner/replanner.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include <stillbase/core/error.hpp>
#include <stillbase/encounter/direction_cone.hpp>
#include <stillbase/plan/feature.hpp>

#include "core/covariance.hpp"
#include "nlp/dense_qp.hpp"
#include "planner/replanner_program.hpp"
#include "search/solution.hpp"
#include "target/contact_predictor.hpp"

namespace stillbase {

namespace {

using ReplanClock = StopCondition::Clock;

CaptureProblem problem_of(const Plan& plan) {
  if (plan.configuration.phi.size() != plan.problem.robot.n()) {
    throw InputError({Finding{plan.problem.source, 0, "no-configuration",
                              "configuration: the plan has none to begin with"}});
  }
  return at_feature(plan.problem, plan.configuration.feature);
}

/// Why an estimate cannot be used; empty: it can.
const char* refusal_of(const TargetState& state) {
  const Eigen::Quaterniond& q = state.pose.orientation;
  if (!std::isfinite(state.time) || !state.pose.position.allFinite() || !q.coeffs().allFinite() ||
      !state.linear_velocity.allFinite() || !state.angular_velocity.allFinite()) {
    return "a number is not finite";
  }
  if (!(std::abs(q.norm() - 1) <= 1e-6)) return "the orientation is no unit quaternion";
  return "";
}

}  // namespace

std::string to_string(ReplanStatus status) {
  static constexpr const char* kNames[] = {"optimal", "feasible", "infeasible",
                                           "refused"};  // in the order of ReplanStatus
  return kNames[static_cast<int>(status)];
}

double margin_of(const ConstraintValue& constraint) {
  return std::min(constraint.value - constraint.lower, constraint.upper - constraint.value);
}

struct Replanner::Impl {
  Impl(const Plan& plan, const ReplanOptions& asked);

  void update(const StateEstimate& estimate, const StopCondition& stop);

 private:
  // Time.
  bool is_over(const StopCondition& stop);
  /// Whether work that has taken up to so long can be done before the deadline.
  static bool has_time(const StopCondition& stop, ReplanClock::duration longest) {
    return !stop.is_late() && (stop.deadline == ReplanClock::time_point::max() ||
                               ReplanClock::now() + longest < stop.deadline);
  }

  // One quadratic program about a point.
  enum class Model { LeastNorm, Measure };
  bool solve_program(const ReplanPoint& at, Model model);
  void add_rows(const ReplanPoint& at);
  void add_pieces(const ReplanPoint& at);
  double residual_of(const ReplanPoint& at);

  // The stages of an update.
  bool restore(ReplanPoint& point);
  bool begin(const StopCondition& stop);
  void set_scale(const ReplanPoint& at);
  void descend(const StopCondition& stop);
  bool take_step(const StopCondition& stop);
  bool step_along(const StopCondition& stop);
  void update_hessian();
  void predict(const StateEstimate& estimate, const StopCondition& stop);
  double cone_of(const StateEstimate& estimate);
  void finish(bool is_feasible);

  ReplanOptions options_;
  ReplanProgram program_;
  JointVectord planned_;
  ReplanResult result_;
  ReplanResult held_;  ///< of old_, when it was found
  int n_, m_;
  nlp::DenseQp qp_;
  Eigen::MatrixXd hessian_;       // of the Lagrangian, measure in `scale_`
  bool is_hessian_fresh_ = true;  // the identity
  double scale_ = 1;
  Eigen::VectorXd old_;                  // the posture before the update
  std::vector<Eigen::VectorXd> starts_;  // plan and candidates, where the old one leads nowhere
  ReplanPoint here_, trial_, judged_;
  double kkt_residual_ = kInfinity;
  // Multipliers of the program's rows and pieces.
  Eigen::VectorXd row_multipliers_, piece_multipliers_;
  Eigen::VectorXd step_, change_, curved_;
  ReplanClock::duration longest_step_{}, longest_prediction_{};
  std::optional<ContactPredictor> predictor_;
  std::vector<ContactPrediction> window_, contact_;

 public:
  const ReplanResult& result() const { return result_; }
  const CaptureProblem& problem() const { return program_.problem(); }
};

Replanner::Impl::Impl(const Plan& plan, const ReplanOptions& asked)
    : options_(asked),
      program_(problem_of(plan), asked.most_rotation),
      planned_(plan.configuration.phi),
      n_(program_.num_variables()),
      m_(program_.num_rows()),
      qp_(n_ + 1, 2 * m_ + 2 * n_ + kMostPieces),
      hessian_(Eigen::MatrixXd::Identity(n_, n_)),
      here_(program_.empty_point()),
      trial_(here_),
      judged_(here_),
      row_multipliers_(Eigen::VectorXd::Zero(m_)),
      piece_multipliers_(Eigen::VectorXd::Zero(kMostPieces)),
      step_(n_),
      change_(n_),
      curved_(n_),
      window_(kConeIntervals + 1),
      contact_(1) {
  const Formulation& formulation = program_.formulation();
  const CaptureProblem& problem = program_.problem();
  const std::string& feature = problem.variables.feature;
  old_ = formulation.variables(plan.configuration);
  starts_.push_back(old_);
  for (const Candidate& candidate : plan.candidates) {
    const Configuration& at = candidate.configuration;
    if (!at.feature.empty() && at.feature != feature) continue;
    starts_.push_back(formulation.variables(at));
  }
  predictor_.emplace(*problem.target, chosen_feature(problem), options_.most_rotation,
                     problem.target_deviations.value_or(EstimateDeviations{}));
  result_.constraints = formulation.report(old_);
  result_.configuration = formulation.configuration(old_);
  // The first update grows all buffers and gives the Hessian its first entries.
  if (program_.rotation_of(problem.target_state) > options_.most_rotation) {
    throw InputError({Finding{problem.source, 0, "not-replannable",
                              "target.state: rotates by more than ReplanOptions::most_rotation "
                              "until the contact"}});
  }
  held_ = result_;
  update({problem.target_state, {}}, {});
}

bool Replanner::Impl::is_over(const StopCondition& stop) {
  if (!stop.is_interrupted() && has_time(stop, longest_step_)) return false;
  result_.was_cut = true;
  return true;
}

void Replanner::Impl::add_rows(const ReplanPoint& at) {
  const Eigen::VectorXd& lower = program_.row_lower();
  const Eigen::VectorXd& upper = program_.row_upper();
  const auto add = [this, &at](Eigen::Index i, double sign, double b, bool is_equation) {
    auto normal = qp_.add_row(b, is_equation);
    normal.setZero();
    normal.head(n_) = sign * at.jacobian.row(i).transpose();
  };
  for (Eigen::Index i = 0; i < m_; ++i) {
    if (lower[i] == upper[i]) add(i, 1, lower[i] - at.rows[i], true);
  }
  for (Eigen::Index i = 0; i < m_; ++i) {
    if (lower[i] == upper[i]) continue;
    if (std::isfinite(lower[i])) add(i, 1, lower[i] - at.rows[i], false);
    if (std::isfinite(upper[i])) add(i, -1, at.rows[i] - upper[i], false);
  }
  for (Eigen::Index j = 0; j < n_; ++j) {
    const double down = std::max(program_.lower()[j] - at.x[j], -options_.longest_step);
    const double up = std::min(program_.upper()[j] - at.x[j], options_.longest_step);
    qp_.add_bound(static_cast<int>(j), 1, std::min(down, 0.0));
    qp_.add_bound(static_cast<int>(j), -1, -std::max(up, 0.0));
  }
}

/// t >= f_k + grad f_k . d - f for all pieces; t is the last variable.
void Replanner::Impl::add_pieces(const ReplanPoint& at) {
  for (int k = 0; k < at.pieces; ++k) {
    auto normal = qp_.add_row((at.piece_values[k] - at.measure) / scale_);
    normal.head(n_) = -at.piece_gradients.row(k).transpose() / scale_;
    normal[n_] = 1;
  }
}

bool Replanner::Impl::solve_program(const ReplanPoint& at, Model model) {
  if (model == Model::LeastNorm) {
    qp_.begin(n_);
    qp_.hessian().setIdentity();
    qp_.gradient().setZero();
    add_rows(at);
    return qp_.solve() == nlp::DenseQp::Outcome::Solved;
  }
  ++result_.steps;
  // Of t: small beside 1, and t vanishes at the solution.
  constexpr double kCurvatureOfBound = 1e-2;
  qp_.begin(n_ + 1);
  auto H = qp_.hessian();
  H.setZero();
  H.topLeftCorner(n_, n_) = hessian_;
  H(n_, n_) = kCurvatureOfBound;
  qp_.gradient().setZero();
  qp_.gradient()[n_] = 1;
  add_rows(at);
  add_pieces(at);
  if (qp_.solve() != nlp::DenseQp::Outcome::Solved) return false;

  const auto u = qp_.multipliers();
  row_multipliers_.setZero();
  int row = 0;
  const Eigen::VectorXd& lower = program_.row_lower();
  const Eigen::VectorXd& upper = program_.row_upper();
  for (Eigen::Index i = 0; i < m_; ++i) {
    if (lower[i] == upper[i]) row_multipliers_[i] = u[row++];
  }
  for (Eigen::Index i = 0; i < m_; ++i) {
    if (lower[i] == upper[i]) continue;
    if (std::isfinite(lower[i])) row_multipliers_[i] += u[row++];
    if (std::isfinite(upper[i])) row_multipliers_[i] -= u[row++];
  }
  row += 2 * n_;
  for (int k = 0; k < at.pieces; ++k) piece_multipliers_[k] = u[row++];
  return true;
}

/// Of KKT at the point that the program is about: H d is the Lagrangian's gradient, multiplier
/// times slack what is missing of complementarity.
double Replanner::Impl::residual_of(const ReplanPoint& at) {
  const auto d = qp_.solution().head(n_);
  if (d.lpNorm<Eigen::Infinity>() >= options_.longest_step * (1 - 1e-9)) return kInfinity;
  curved_.noalias() = hessian_ * d;
  double gradient = 0;
  for (int k = 0; k < at.pieces; ++k) {
    gradient = std::max(gradient, at.piece_gradients.row(k).lpNorm<Eigen::Infinity>() / scale_);
  }
  // With several pieces the program's objective is t, whose gradient is 1.
  const double size = program_.is_worst_case() ? 1 : std::max(1.0, gradient);
  double open = curved_.lpNorm<Eigen::Infinity>();
  const auto u = qp_.multipliers();
  for (int row = 0; row < qp_.rows(); ++row) {
    if (u[row] != 0) open = std::max(open, std::abs(u[row] * qp_.normal(row).dot(qp_.solution())));
  }
  return open / size;
}

bool Replanner::Impl::restore(ReplanPoint& point) {
  constexpr double kExact = 1e-12;
  program_.move_into_box(point.x);
  program_.evaluate_rows(point);
  for (int i = 0; i < options_.restoration_steps; ++i) {
    if (!(point.max_violation < kInfinity)) return false;
    if (point.max_violation <= kExact || !solve_program(point, Model::LeastNorm)) break;
    step_ = qp_.solution();
    if (!(step_.lpNorm<Eigen::Infinity>() > kExact)) break;
    point.x += step_;
    program_.move_into_box(point.x);
    program_.evaluate_rows(point);
  }
  return point.max_violation <= kFeasibilityTolerance;
}

/// The old posture on the constraints, or else the first known one that gets there; where none
/// does, the attempt that violates them least.
bool Replanner::Impl::begin(const StopCondition& stop) {
  trial_.max_violation = kInfinity;
  const auto leads_there = [this](const Eigen::VectorXd& from) {
    here_.x = from;
    if (restore(here_)) return true;
    if (here_.max_violation < trial_.max_violation) std::swap(here_, trial_);
    return false;
  };
  if (leads_there(old_)) return true;
  for (const Eigen::VectorXd& start : starts_) {
    if (is_over(stop)) break;
    if (leads_there(start)) return true;
  }
  if (trial_.max_violation < kInfinity) std::swap(here_, trial_);
  return false;
}

/// Along the program's solution, shortened until the measure falls, and back onto the constraints.
/// @return whether trial_ is better than here_
bool Replanner::Impl::step_along(const StopCondition& stop) {
  constexpr double kSufficient = 1e-4;  // of what the linear model says
  const double expected = -qp_.solution()[n_] * scale_;
  if (!(expected > 0)) return false;
  change_ = qp_.solution().head(n_);
  double part = 1;
  for (int halving = 0; halving < options_.halvings; ++halving, part /= 2) {
    if (halving > 0 && stop.reached()) {
      result_.was_cut = true;
      return false;
    }
    trial_.x = here_.x + part * change_;
    if (!restore(trial_)) continue;
    program_.evaluate_measure(trial_);
    const double decrease = here_.measure - trial_.measure;
    if (decrease >= kSufficient * part * expected && decrease > 0) return true;
  }
  return false;
}

/// Damped BFGS (Powell, 1978) on the Lagrangian, whose pieces are followed by their directions.
void Replanner::Impl::update_hessian() {
  constexpr double kDamping = 0.2;
  step_ = trial_.x - here_.x;
  change_.noalias() = -trial_.jacobian.transpose() * row_multipliers_;
  change_.noalias() += here_.jacobian.transpose() * row_multipliers_;
  for (int k = 0; k < here_.pieces; ++k) {
    const double weight = piece_multipliers_[k] / scale_;
    if (weight == 0) continue;
    int same = 0;
    double nearest = -kInfinity;
    for (int j = 0; j < trial_.pieces; ++j) {
      const double cosine = trial_.piece_directions[static_cast<std::size_t>(j)].dot(
          here_.piece_directions[static_cast<std::size_t>(k)]);
      if (cosine <= nearest) continue;
      nearest = cosine;
      same = j;
    }
    change_ +=
        weight * (trial_.piece_gradients.row(same) - here_.piece_gradients.row(k)).transpose();
  }
  curved_.noalias() = hessian_ * step_;
  const double bent = step_.dot(curved_);
  if (!(bent > 1e-20)) return;
  const double along = step_.dot(change_);
  if (is_hessian_fresh_ && along > 0) {
    // The first curvature that is seen scales the identity.
    hessian_ *= change_.squaredNorm() / along;
    is_hessian_fresh_ = false;
    return update_hessian();
  }
  if (along < kDamping * bent) {
    const double theta = (1 - kDamping) * bent / (bent - along);
    change_ = theta * change_ + (1 - theta) * curved_;
  }
  const double yield = step_.dot(change_);
  for (Eigen::Index j = 0; j < n_; ++j) {  // an outer product of Eigen's takes a temporary
    hessian_.col(j) += change_[j] / yield * change_ - curved_[j] / bent * curved_;
  }
  is_hessian_fresh_ = false;
}

/// @return whether another one may lower the measure further
bool Replanner::Impl::take_step(const StopCondition& stop) {
  const auto forget_hessian = [this] {
    if (is_hessian_fresh_) return false;
    hessian_.setIdentity();
    return is_hessian_fresh_ = true;
  };
  kkt_residual_ = kInfinity;
  if (!solve_program(here_, Model::Measure)) return forget_hessian();
  kkt_residual_ = residual_of(here_);
  if (kkt_residual_ <= options_.optimality_tolerance) return false;
  if (!step_along(stop)) {
    return !result_.was_cut && kkt_residual_ > kOptimal && forget_hessian();
  }
  update_hessian();
  std::swap(here_, trial_);
  kkt_residual_ = kInfinity;
  return true;
}

/// In the units of the search's own certificates.
void Replanner::Impl::set_scale(const ReplanPoint& at) {
  const bool is_nominal = program_.problem().measure.kind == RiskMeasure::Nominal;
  scale_ = is_nominal ? 1 : std::max(at.measure, 1e-18);
}

void Replanner::Impl::descend(const StopCondition& stop) {
  set_scale(here_);
  bool goes_on = true;
  while (goes_on && result_.steps < options_.max_steps && !is_over(stop)) {
    const auto begun = ReplanClock::now();
    goes_on = take_step(stop);
    longest_step_ = std::max(longest_step_, ReplanClock::now() - begun);
  }
}

/// The half-angle that follows from the covariance, where the problem has it so; infinite where the
/// covariance cannot be carried to the contact.
double Replanner::Impl::cone_of(const StateEstimate& estimate) {
  const UncertaintySpec& uncertainty = problem().uncertainty;
  if (!uncertainty.cone_confidence || !estimate.covariance) return program_.cone_half_angle();
  const VariableSpec& variables = problem().variables;
  const double lower = variables.contact_time_lower, upper = variables.contact_time_upper;
  for (int i = 0; i <= kConeIntervals; ++i) {
    window_[static_cast<std::size_t>(i)].time = lower + (upper - lower) * i / kConeIntervals;
  }
  if (!predictor_->predict(estimate.state, *estimate.covariance, window_)) return kInfinity;
  double half_angle = 0;
  for (const ContactPrediction& prediction : window_) {
    const double p = *uncertainty.cone_confidence;
    half_angle = std::max(
        half_angle,
        uncertainty.cone_plane_normal
            ? wedge_half_angle(prediction,
                               problem().base.orientation * *uncertainty.cone_plane_normal, p)
            : cone_half_angle(prediction, p));
  }
  return half_angle;
}

void Replanner::Impl::predict(const StateEstimate& estimate, const StopCondition& stop) {
  result_.contact.reset();
  if (!estimate.covariance) return;
  if (stop.is_interrupted() || !has_time(stop, longest_prediction_)) return;
  const auto begun = ReplanClock::now();
  contact_[0].time = result_.configuration.contact_time;
  if (predictor_->predict(estimate.state, *estimate.covariance, contact_)) {
    const ContactPrediction& there = contact_[0];
    result_.contact.emplace(
        ContactDeviations{there.point_deviation().norm(),
                          std::min(stillbase::cone_half_angle(there, kDefaultConeConfidence), kPi),
                          there.closing_speed_deviation()});
  }
  longest_prediction_ = std::max(longest_prediction_, ReplanClock::now() - begun);
}

void Replanner::Impl::finish(bool is_feasible) {
  const Formulation& formulation = program_.formulation();
  formulation.parts().model.write_configuration(here_.x, result_.configuration);
  formulation.update_report(here_.x, result_.constraints);
  result_.value = program_.reported(here_.measure);
  result_.nominal = program_.reported(here_.nominal);
  result_.worst_case = program_.reported(here_.worst_case);
  result_.worst_direction = here_.worst_direction;
  result_.max_violation = here_.max_violation;
  for (const ConstraintValue& value : result_.constraints) {
    result_.max_violation = std::max(result_.max_violation, value.violation);
  }
  result_.kkt_residual = kkt_residual_;
  result_.cone_half_angle = program_.cone_half_angle();
  const bool is_number = std::isfinite(here_.measure);
  result_.status = !is_feasible || !is_number || !(result_.max_violation <= kFeasibilityTolerance)
                       ? ReplanStatus::Infeasible
                   : kkt_residual_ <= kOptimal ? ReplanStatus::Optimal
                                               : ReplanStatus::Feasible;
  if (result_.status == ReplanStatus::Infeasible) return;
  old_ = here_.x;
  held_ = result_;
}

void Replanner::Impl::update(const StateEstimate& estimate, const StopCondition& stop) {
  const auto begun = ReplanClock::now();
  const auto seconds = [begun] {
    return std::chrono::duration<double>(ReplanClock::now() - begun).count();
  };
  const auto refuse = [&](const char* reason) {
    result_ = held_;
    result_.status = ReplanStatus::Refused;
    result_.reason = reason;
    result_.steps = 0;
    result_.seconds = seconds();
  };
  // A step that the system once interrupted does not count for ever.
  longest_step_ /= 2;
  longest_prediction_ /= 2;
  const double earliest = estimate.state.time + options_.least_lead;
  if (const char* reason = refusal_of(estimate.state); *reason != '\0') return refuse(reason);
  if (!(earliest <= problem().variables.contact_time_upper)) {
    return refuse("it leaves no time before the end of the window of contact times");
  }
  if (!(program_.rotation_of(estimate.state) <= options_.most_rotation)) {
    return refuse("the target rotates by more than most_rotation until the contact");
  }
  if (estimate.covariance && !is_covariance(*estimate.covariance)) {
    return refuse("its covariance is not symmetric and positive semidefinite");
  }
  const double half_angle = cone_of(estimate);
  if (half_angle == kInfinity) return refuse("its covariance cannot be carried to the contact");
  if (!(half_angle <= kPi / 2)) {
    return refuse("its covariance says next to nothing of the direction: no cone below 90 deg");
  }
  result_.reason = "";
  result_.was_cut = false;
  result_.steps = 0;
  kkt_residual_ = kInfinity;
  program_.set_estimate(estimate.state, earliest);
  if (half_angle != program_.cone_half_angle()) program_.set_cone_half_angle(half_angle);

  program_.stay_within(kInfinity, planned_);
  judged_.x = old_;
  program_.evaluate_rows(judged_);
  program_.evaluate_measure(judged_);
  result_.old = {program_.reported(judged_.measure), judged_.max_violation};

  program_.stay_within(options_.stay_within, planned_);
  bool is_feasible = begin(stop);
  if (!is_feasible && options_.stay_within < kInfinity && !is_over(stop)) {
    program_.stay_within(kInfinity, planned_);
    is_feasible = begin(stop);
  }
  program_.evaluate_measure(here_);
  result_.corrected = {program_.reported(here_.measure), here_.max_violation};
  if (is_feasible) descend(stop);
  if (result_.old.is_feasible() && !(is_feasible && here_.measure <= judged_.measure)) {
    std::swap(here_, judged_);
    is_feasible = true;
    kkt_residual_ = kInfinity;
    // Often nothing but rounding makes it better: it is a minimum as well then.
    if (!stop.is_interrupted() && has_time(stop, longest_step_)) {
      set_scale(here_);
      if (solve_program(here_, Model::Measure)) kkt_residual_ = residual_of(here_);
    }
  }
  finish(is_feasible);
  predict(estimate, stop);
  result_.seconds = seconds();
}

Replanner::Replanner(const Plan& plan, const ReplanOptions& options)
    : impl_(std::make_unique<Impl>(plan, options)) {}
Replanner::~Replanner() = default;
Replanner::Replanner(Replanner&&) noexcept = default;
Replanner& Replanner::operator=(Replanner&&) noexcept = default;

const ReplanResult& Replanner::replan(const StateEstimate& estimate, const StopCondition& stop) {
  impl_->update(estimate, stop);
  return impl_->result();
}

const ReplanResult& Replanner::last() const { return impl_->result(); }
const CaptureProblem& Replanner::problem() const { return impl_->problem(); }

}  // namespace stillbase
