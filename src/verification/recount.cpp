#include "verification/recount.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/core/random.hpp>

#include "verification/free_variables.hpp"
#include "verification/margins.hpp"

namespace stillbase::verification {
namespace {

constexpr double kSolved = 1e-10;     // of the relative residual
constexpr double kSame = 1e-5;        // rad, m
constexpr double kDifference = 1e-6;  // rad, m; step of the differences
constexpr double kLive = 1e-5;    // of the largest singular value: an equation that says something
constexpr double kInside = 1e-6;  // solutions nearer to a bound may count as beyond it
constexpr int kIterations = 25;
constexpr int kHandRows = 6, kRows = 15;

bool has_hand_point(const CaptureProblem& problem) {
  return problem.hand.position || !problem.impulse.direction;
}

/// The equations over the variables, relative to the size of the momenta and to 1 m.
class Equations {
 public:
  Equations(const CaptureProblem& problem, const FreeVariables& variables)
      : problem_(problem), variables_(variables) {
    if (problem.impulse.direction) return;
    Configuration last{problem.start, problem.base, problem.variables.contact_time_upper};
    motion_ = target_motion(problem, last, Vector3d::Zero(), problem.variables.contact_time_lower);
  }

  void ask_for_zero() { zero_ = true; }

  ContactEvent event_at(const Configuration& at) const {
    return contact_event(problem_, motion_ ? &*motion_ : nullptr, at);
  }

  Eigen::VectorXd residual(const Eigen::VectorXd& x) const {
    const Configuration at = variables_.at(x);
    const ContactEvent event = event_at(at);
    Vector6d F;
    F << event.n, event.moment;
    if (problem_.impulse.source == ImpulseSource::Given) {
      F.tail<3>() /= problem_.impulse.magnitude;
    }
    PostureResponse response;
    response.dynamics = reference::compute(problem_.robot, {at.phi, {}, {}});
    response.added_inertia = added_inertia_of(problem_.resistance, problem_.robot.n());
    if (problem_.resistance.model == ResistanceModel::Locked) {
      response.locked = problem_.resistance.locked;
    }
    response.r_gh = response.dynamics.hand_position - response.dynamics.centroid;
    const reference::Impact impact = response.impact(F);
    const double scale = response.momentum_scale(F);
    Eigen::VectorXd rows = Eigen::VectorXd::Zero(kRows);
    rows.head<kHandRows>() = hand_rows(problem_, event, at, response.dynamics);
    const CaseConstraint wanted = problem_.constraints.impact_case;
    const bool is_total =
        wanted == CaseConstraint::C || wanted == CaseConstraint::C1 || wanted == CaseConstraint::C2;
    const bool zero_total =
        zero_ && problem_.objective.front().quantity == ObjectiveQuantity::TotalAngularMomentum;
    if (is_total || zero_total) rows.segment<3>(6) = impact.total / scale;
    if (wanted == CaseConstraint::G2 || (zero_ && !zero_total)) {
      rows.segment<3>(9) = impact.base / scale;
    }
    if (wanted == CaseConstraint::C2 || wanted == CaseConstraint::G3) {
      rows.segment<3>(12) = impact.coupling / scale;
    }
    return rows;
  }

  Eigen::MatrixXd jacobian(const Eigen::VectorXd& x) const {
    const Eigen::Index n = x.size();
    Eigen::MatrixXd J(kRows, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::VectorXd step = kDifference * Eigen::VectorXd::Unit(n, i);
      J.col(i) = (residual(x + step) - residual(x - step)) / (2 * kDifference);
    }
    return J;
  }

  bool is_allowed(const Configuration& at) const {
    const reference::Dynamics dynamics = reference::compute(problem_.robot, {at.phi, {}, {}});
    const ContactEvent event = event_at(at);
    return keeps_inequalities(problem_, event, at, dynamics) &&
           is_within_limits(at, event, dynamics);
  }

 private:
  /// Rates, singular values, clearances, with a little to spare.
  bool is_within_limits(Configuration at, const ContactEvent& event,
                        const reference::Dynamics& dynamics) const {
    const ConstraintSpec& wanted = problem_.constraints;
    const bool has_rates = wanted.joint_rate_scale || wanted.joint_rate_max.size() > 0;
    if (!has_rates && !(wanted.coupling_singular_value_min > 0) &&
        !(wanted.jacobian_singular_value_min > 0) && !wanted.clearance) {
      return true;
    }
    const Vector3d hand = at.base.orientation * Vector3d(dynamics.hand_position);
    if (problem_.variables.base_position != PositionFreedom::Fixed && event.feature) {
      at.base.position = event.feature->point - hand;
    }
    const auto motion =
        target_motion(problem_, at, Vector3d(at.base.position + hand), at.contact_time);
    const MarginNumbers found = margin_numbers(problem_, at, motion ? &*motion : nullptr, event,
                                               posture_response(problem_, at.phi));
    const auto is_short = [](const std::optional<double>& value, double least) {
      return value && *value < least + kInside;
    };
    return !(found.rate_excess > -kInside) &&
           !is_short(found.coupling, wanted.coupling_singular_value_min) &&
           !is_short(found.jacobian, wanted.jacobian_singular_value_min) &&
           !(wanted.clearance && (is_short(found.distance, *wanted.clearance) ||
                                  neighbours_distance(problem_, at) < *wanted.clearance + kInside));
  }

  const CaptureProblem& problem_;
  const FreeVariables& variables_;
  std::optional<TargetMotion> motion_;
  bool zero_ = false;
};

Eigen::VectorXd start_point(const FreeVariables& variables, int index) {
  const Eigen::VectorXd u = low_discrepancy_point(index, variables.size(), 0);
  return variables.lower + u.cwiseProduct(variables.upper - variables.lower);
}

/// Number of equations that say something at a point; singular ones count less.
int rank_of(const Eigen::MatrixXd& J) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(J);
  const auto& sigma = svd.singularValues();
  int rank = 0;
  for (Eigen::Index i = 0; i < sigma.size(); ++i) rank += sigma[i] > kLive;
  return rank;
}

/// The most equations that are independent at one of a few points.
int generic_rank(const Equations& equations, const FreeVariables& variables) {
  int rank = 0;
  for (int sample = 0; sample < 8; ++sample) {
    rank = std::max(rank, rank_of(equations.jacobian(start_point(variables, sample + 1))));
  }
  return rank;
}

/// Gauss-Newton with halved steps; empty: it does not get there.
std::optional<Eigen::VectorXd> solve(const Equations& equations, Eigen::VectorXd x) {
  Eigen::VectorXd r = equations.residual(x);
  for (int i = 0; i < kIterations; ++i) {
    if (r.norm() <= kSolved) return x;
    const Eigen::MatrixXd J = equations.jacobian(x);
    Eigen::VectorXd step = -J.completeOrthogonalDecomposition().solve(r);
    if (step.norm() > 1) step *= 1 / step.norm();
    bool better = false;
    for (int halved = 0; halved < 4 && !better; ++halved, step /= 2) {
      const Eigen::VectorXd next = equations.residual(x + step);
      if (!(next.norm() < r.norm())) continue;
      x += step;
      r = next;
      better = true;
      break;
    }
    if (!better) return std::nullopt;
  }
  return std::nullopt;
}

std::string objection(const CaptureProblem& problem) {
  const AttitudeFreedom attitude = problem.variables.base_attitude;
  if (attitude == AttitudeFreedom::Cone || attitude == AttitudeFreedom::Free) {
    return "the base attitude is free about more than one axis";
  }
  const int free = FreeVariables(problem).size();
  return free < 1 || free > 3 ? "not one to three variables" : "";
}

bool is_angular(const std::vector<ObjectiveTerm>& objective) {
  if (objective.size() != 1) return false;
  const ObjectiveQuantity quantity = objective.front().quantity;
  return quantity == ObjectiveQuantity::BaseAngularMomentum ||
         quantity == ObjectiveQuantity::BaseAngularVelocity ||
         quantity == ObjectiveQuantity::TotalAngularMomentum;
}

}  // namespace

bool is_on_curve_of_zeros(const CaptureProblem& problem, const Configuration& at) {
  constexpr double kVanishes = 1e-11;
  constexpr double kOpen = 1e-7, kShut = 1e-4;  // singular values of differences
  if (!is_angular(problem.objective)) return false;
  const FreeVariables variables(problem);
  const int n = variables.size();
  if (n < 2) return false;
  Equations equations(problem, variables);
  const Eigen::VectorXd x = variables.of(at);
  if (rank_of(equations.jacobian(x)) >= n) return false;
  equations.ask_for_zero();
  if (!(equations.residual(x).cwiseAbs().maxCoeff() <= kVanishes)) return false;
  const Eigen::VectorXd sizes =
      Eigen::JacobiSVD<Eigen::MatrixXd>(equations.jacobian(x)).singularValues();
  if (sizes.size() < n) return false;  // fewer equations: more than one direction is open
  return sizes[n - 1] <= kOpen && sizes[n - 2] >= kShut;
}

Vector6d hand_rows(const CaptureProblem& problem, const ContactEvent& event,
                   const Configuration& at, const reference::Dynamics& dynamics) {
  Vector6d rows = Vector6d::Zero();
  const HandSpec& hand = problem.hand;
  if (hand.constraint == HandConstraint::None) return rows;
  if (has_hand_point(problem) && problem.variables.base_position == PositionFreedom::Fixed) {
    Vector3d wanted;
    if (hand.position && hand.frame == Frame::Base) {
      wanted = *hand.position;
    } else {
      wanted = at.base.inverse() * (hand.position ? *hand.position : event.feature->point);
    }
    rows.head<3>() = dynamics.hand_position - wanted;
  }
  if (hand.constraint == HandConstraint::Axis) {
    rows.tail<3>() = event.n.cross(Vector3d(dynamics.hand_rotation * hand.approach_axis));
  } else if (const auto wanted = wanted_hand_axes(problem, event, at)) {
    const Matrix3d D = (at.base.orientation.conjugate() * *wanted).toRotationMatrix();
    for (int i = 0; i < 3; ++i) {
      rows.tail<3>() += dynamics.hand_rotation.col(i).cross(D.col(i)) / 2;
    }
  }
  return rows;
}

bool keeps_inequalities(const CaptureProblem& problem, const ContactEvent& event,
                        const Configuration& at, const reference::Dynamics& dynamics) {
  const VariableSpec& variables = problem.variables;
  const HandSpec& hand = problem.hand;
  if (hand.constraint == HandConstraint::Axis &&
      event.n.dot(dynamics.hand_rotation * hand.approach_axis) > 0) {
    return false;
  }
  if (const auto wanted = wanted_hand_axes(problem, event, at)) {
    const Matrix3d D = (at.base.orientation.conjugate() * *wanted).toRotationMatrix();
    if ((dynamics.hand_rotation.transpose() * D).trace() < 0) return false;
  }
  const bool time_is_free = variables.contact_time_upper > variables.contact_time_lower;
  if (event.feature && (time_is_free || problem.impulse.source != ImpulseSource::Given) &&
      closing_speed(problem, event, event.n) < problem.constraints.closing_speed_min + kInside) {
    return false;
  }
  if (variables.base_position == PositionFreedom::Box && has_hand_point(problem)) {
    const Vector3d point = hand.position ? *hand.position : event.feature->point;
    const Vector3d station = point - at.base.orientation * Vector3d(dynamics.hand_position);
    if (((station - variables.base_position_lower).array() < kInside).any() ||
        ((variables.base_position_upper - station).array() < kInside).any()) {
      return false;
    }
  }
  return true;
}

double hand_residual(const CaptureProblem& problem, const ContactEvent& event,
                     const Configuration& at, const reference::Dynamics& dynamics) {
  return hand_rows(problem, event, at, dynamics).cwiseAbs().maxCoeff();
}

Recount search_solutions(const Context& context) {
  const CaptureProblem& problem = context.problem;
  Recount out;
  out.not_done = objection(problem);
  if (!out.not_done.empty()) return out;
  const FreeVariables variables(problem);
  const int n = variables.size();
  Equations equations(problem, variables);
  int rank = generic_rank(equations, variables);
  if (rank < n && is_angular(problem.objective)) {
    out.asks_for_zero = true;
    equations.ask_for_zero();
    rank = generic_rank(equations, variables);
  }
  if (rank < n) {
    out.not_done = "the equations leave freedom";
    return out;
  }
  constexpr int kStarts[] = {100, 400, 1000};
  out.starts = kStarts[n - 1];
  std::vector<Eigen::VectorXd> points;
  for (int s = 0; s < out.starts && !context.options.stop.reached(); ++s) {
    auto x = solve(equations, start_point(variables, s));
    if (!x || rank_of(equations.jacobian(*x)) < n || !variables.bring_inside(*x)) continue;
    const Configuration at = variables.at(*x);
    if (!equations.is_allowed(at)) continue;
    const auto is_same = [&](const Eigen::VectorXd& other) {
      return variables.distance(*x, other) <= kSame;
    };
    if (std::any_of(points.begin(), points.end(), is_same)) continue;
    points.push_back(*x);
    out.solutions.push_back(at);
  }
  return out;
}

}  // namespace stillbase::verification
