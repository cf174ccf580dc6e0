#include "verification/recount.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/core/random.hpp>

namespace stillbase::verification {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kSolved = 1e-10;     // of the relative residual
constexpr double kSame = 1e-5;        // rad, m
constexpr double kDifference = 1e-6;  // rad, m; step of the differences
constexpr double kLive = 1e-5;  // of the largest singular value: an equation that says something
constexpr int kIterations = 25;

/// The equations over the free joints, relative to the size of the momenta and to 1 m.
class Equations {
 public:
  Equations(const Context& context, const ContactEvent& event)
      : problem_(context.problem), event_(event) {
    for (int k = 0; k < problem_.robot.n(); ++k) {
      if (problem_.variables.joints[static_cast<std::size_t>(k)]) free_.push_back(k);
    }
    F_ << event.n, event.moment;
    if (problem_.impulse.source == ImpulseSource::Given) {
      F_.tail<3>() /= problem_.impulse.magnitude;
    }
  }

  int size() const { return static_cast<int>(free_.size()); }
  const Joint& joint(int i) const {
    return problem_.robot.joints[static_cast<std::size_t>(free_[static_cast<std::size_t>(i)])];
  }
  void ask_for_zero() { zero_ = true; }

  Eigen::VectorXd posture(const Eigen::VectorXd& x) const {
    Eigen::VectorXd phi = problem_.start;
    for (int i = 0; i < size(); ++i) phi[free_[static_cast<std::size_t>(i)]] = x[i];
    return phi;
  }

  Eigen::VectorXd residual(const Eigen::VectorXd& x) const {
    PostureResponse response;
    response.dynamics = reference::compute(problem_.robot, {posture(x), {}, {}});
    response.added_inertia = added_inertia_of(problem_.resistance, problem_.robot.n());
    if (problem_.resistance.model == ResistanceModel::Locked) {
      response.locked = problem_.resistance.locked;
    }
    response.r_gh = response.dynamics.hand_position - response.dynamics.centroid;
    const reference::Impact impact = response.impact(F_);
    const double scale = response.momentum_scale(F_);
    Eigen::VectorXd rows = Eigen::VectorXd::Zero(12);
    if (problem_.hand.constraint == HandConstraint::Position && problem_.hand.position &&
        problem_.variables.base_position == PositionFreedom::Fixed) {
      const Vector3d wanted = problem_.hand.frame == Frame::Base
                                  ? *problem_.hand.position
                                  : problem_.base.inverse() * *problem_.hand.position;
      rows.head<3>() = response.dynamics.hand_position - wanted;
    }
    const CaseConstraint wanted = problem_.constraints.impact_case;
    const bool is_total =
        wanted == CaseConstraint::C || wanted == CaseConstraint::C1 || wanted == CaseConstraint::C2;
    const bool zero_total =
        zero_ && problem_.objective.front().quantity == ObjectiveQuantity::TotalAngularMomentum;
    if (is_total || zero_total) rows.segment<3>(3) = impact.total / scale;
    if (wanted == CaseConstraint::G2 || (zero_ && !zero_total)) {
      rows.segment<3>(6) = impact.base / scale;
    }
    if (wanted == CaseConstraint::C2 || wanted == CaseConstraint::G3) {
      rows.segment<3>(9) = impact.coupling / scale;
    }
    return rows;
  }

  Eigen::MatrixXd jacobian(const Eigen::VectorXd& x) const {
    Eigen::MatrixXd J(12, size());
    for (int i = 0; i < size(); ++i) {
      const Eigen::VectorXd step = kDifference * Eigen::VectorXd::Unit(size(), i);
      J.col(i) = (residual(x + step) - residual(x - step)) / (2 * kDifference);
    }
    return J;
  }

 private:
  const CaptureProblem& problem_;
  const ContactEvent& event_;
  std::vector<int> free_;
  Vector6d F_;
  bool zero_ = false;
};

struct Domain {
  Eigen::VectorXd lower, upper;
  std::vector<bool> turns;
};

Domain domain_of(const Equations& equations, double margin) {
  const int n = equations.size();
  Domain domain{Eigen::VectorXd(n), Eigen::VectorXd(n), std::vector<bool>()};
  for (int i = 0; i < n; ++i) {
    const Joint& joint = equations.joint(i);
    const bool turns = joint.type == JointType::Continuous;
    domain.turns.push_back(turns);
    domain.lower[i] = turns ? -kPi : joint.lower + margin;
    domain.upper[i] = turns ? kPi : joint.upper - margin;
  }
  return domain;
}

Eigen::VectorXd start_point(const Domain& domain, int index) {
  const Eigen::VectorXd u = low_discrepancy_point(index, static_cast<int>(domain.lower.size()), 0);
  return domain.lower + u.cwiseProduct(domain.upper - domain.lower);
}

/// Number of equations that say something at a posture; singular ones count less.
int rank_of(const Eigen::MatrixXd& J) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(J);
  const auto& sigma = svd.singularValues();
  int rank = 0;
  for (Eigen::Index i = 0; i < sigma.size(); ++i) rank += sigma[i] > kLive;
  return rank;
}

/// The most equations that are independent at one of a few postures.
int generic_rank(const Equations& equations, const Domain& domain) {
  int rank = 0;
  for (int sample = 0; sample < 8; ++sample) {
    rank = std::max(rank, rank_of(equations.jacobian(start_point(domain, sample + 1))));
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

std::string objection(const CaptureProblem& problem, int free) {
  const VariableSpec& variables = problem.variables;
  const HandConstraint hand = problem.hand.constraint;
  if (free < 1 || free > 3) return "not one to three free joints";
  if (variables.base_attitude != AttitudeFreedom::Fixed ||
      variables.base_position == PositionFreedom::Box ||
      variables.contact_time_upper > variables.contact_time_lower) {
    return "base or contact time are free";
  }
  if (hand == HandConstraint::Axis || hand == HandConstraint::Pose) return "the hand's axes count";
  if (hand == HandConstraint::Position && !problem.hand.position &&
      variables.base_position == PositionFreedom::Fixed) {
    return "the hand meets a moving target";
  }
  return "";
}

bool is_angular(const std::vector<ObjectiveTerm>& objective) {
  if (objective.size() != 1) return false;
  const ObjectiveQuantity quantity = objective.front().quantity;
  return quantity == ObjectiveQuantity::BaseAngularMomentum ||
         quantity == ObjectiveQuantity::BaseAngularVelocity ||
         quantity == ObjectiveQuantity::TotalAngularMomentum;
}

}  // namespace

Recount search_solutions(const Context& context, const ContactEvent& event) {
  const CaptureProblem& problem = context.problem;
  Equations equations(context, event);
  const int n = equations.size();
  Recount out;
  out.not_done = objection(problem, n);
  if (!out.not_done.empty()) return out;
  const Domain domain = domain_of(equations, problem.constraints.joint_limit_margin);
  int rank = generic_rank(equations, domain);
  if (rank < n && is_angular(problem.objective)) {
    equations.ask_for_zero();
    rank = generic_rank(equations, domain);
  }
  if (rank < n) {
    out.not_done = "the equations leave freedom";
    return out;
  }
  constexpr int kStarts[] = {100, 400, 1000};
  out.starts = kStarts[n - 1];
  for (int s = 0; s < out.starts && !context.options.stop.reached(); ++s) {
    auto x = solve(equations, start_point(domain, s));
    if (!x || rank_of(equations.jacobian(*x)) < n) continue;
    bool is_inside = true;
    for (int i = 0; i < n; ++i) {
      if (domain.turns[static_cast<std::size_t>(i)]) (*x)[i] = std::remainder((*x)[i], 2 * kPi);
      is_inside = is_inside && (*x)[i] >= domain.lower[i] && (*x)[i] <= domain.upper[i];
    }
    if (!is_inside) continue;
    const Eigen::VectorXd phi = equations.posture(*x);
    const auto is_same = [&](const Eigen::VectorXd& other) {
      double apart = 0;
      for (int k = 0; k < problem.robot.n(); ++k) {
        const bool turns =
            problem.robot.joints[static_cast<std::size_t>(k)].type == JointType::Continuous;
        const double d = phi[k] - other[k];
        apart = std::max(apart, std::abs(turns ? std::remainder(d, 2 * kPi) : d));
      }
      return apart <= kSame;
    };
    if (std::none_of(out.solutions.begin(), out.solutions.end(), is_same)) {
      out.solutions.push_back(phi);
    }
  }
  return out;
}

}  // namespace stillbase::verification
