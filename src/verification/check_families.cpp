// Curves of solutions: points, length, ends, starts; none of them twice.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>

#include "verification/checks.hpp"
#include "verification/margins.hpp"
#include "verification/recount.hpp"

namespace stillbase::verification {
namespace {

constexpr double kVanishes = 1e-8;   // of the terms that the objective is a sum and difference of
constexpr double kApart = 0.1;       // between neighbours
constexpr double kMeet = 1e-9;       // ends of a closed curve
constexpr double kSameCurve = 0.01;  // from the chords between points
constexpr double kAtLimit = 1e-6;    // rad, m, s, ...: an end that is stopped by a limit

/// The variables of a configuration as lengths of curves count them: joints, rotation vector of the
/// base from its stated attitude, time.
class Place {
 public:
  Place(const CaptureProblem& problem, const Configuration& at)
      : problem_(&problem),
        phi(at.phi),
        turn(rotation_log(at.base.orientation * problem.base.orientation.conjugate())),
        time(at.contact_time) {}

  /// From another place near by; angles and turns are the same after a whole turn.
  double distance(const Place& other) const {
    double sum = (other.near(turn) - turn).squaredNorm() + std::pow(other.time - time, 2);
    for (int k = 0; k < phi.size(); ++k) {
      const Joint& joint = problem_->robot.joints[static_cast<std::size_t>(k)];
      const double d = other.phi[k] - phi[k];
      sum += std::pow(joint.type == JointType::Continuous ? std::remainder(d, 2 * kPi) : d, 2);
    }
    return std::sqrt(sum);
  }

 private:
  Vector3d near(const Vector3d& reference) const {
    const double angle = turn.norm();
    if (!(angle > 0)) return turn;
    const Vector3d other = turn * (1 - 2 * kPi / angle);
    return (other - reference).norm() < (turn - reference).norm() ? other : turn;
  }

  const CaptureProblem* problem_;
  Eigen::VectorXd phi;
  Vector3d turn;
  double time;
};

/// A configuration with everything that its claims need.
struct Judged {
  Plan alone;
  CaptureProblem problem;
  PostureResponse response;
  std::optional<TargetMotion> motion;
  ContactEvent event;

  Judged(const CaptureProblem& stated, const Configuration& at)
      : problem(problem_at(stated, at)), response(posture_response(problem, at.phi)) {
    alone.configuration = at;
    motion = target_motion(problem, at, at.base * Vector3d(response.dynamics.hand_position),
                           at.contact_time);
    event = contact_event(problem, motion ? &*motion : nullptr, at);
  }
  Context context(const VerifyOptions& options) const {
    return {alone, problem, options, motion ? &*motion : nullptr};
  }
};

/// The predicted objective against the size of what it is a sum and difference of.
double relative_objective(const Judged& at) {
  const Vector6d Fbar = impulse_along(at.problem, at.event, at.response, at.event.n);
  const double scale = objective_scale(at.problem.objective, at.response, Fbar);
  return objective_value(at.problem, at.response, Fbar) / std::max(scale, 1e-300);
}

/// How far the limits of variables and inequalities are, each in its unit; the same ones
/// everywhere.
std::vector<double> distances_to_limits(const Judged& at) {
  const CaptureProblem& problem = at.problem;
  const Configuration& configuration = at.alone.configuration;
  const VariableSpec& free = problem.variables;
  std::vector<double> out;
  const auto between = [&out](double x, double lower, double upper) {
    out.push_back(std::min(std::abs(x - lower), std::abs(x - upper)));
  };
  const double margin = problem.constraints.joint_limit_margin;
  for (int k = 0; k < problem.robot.n(); ++k) {
    const Joint& joint = problem.robot.joints[static_cast<std::size_t>(k)];
    if (!free.joints[static_cast<std::size_t>(k)] || joint.type == JointType::Continuous) continue;
    between(configuration.phi[k], joint.lower + margin, joint.upper - margin);
  }
  const Eigen::Quaterniond turn =
      configuration.base.orientation * problem.base.orientation.conjugate();
  if (free.base_attitude == AttitudeFreedom::Cone) {
    const Vector3d& axis = free.base_attitude_axis;
    between(axis.dot(turn * axis), std::cos(free.base_attitude_max), kInfinity);
  } else if (free.base_attitude != AttitudeFreedom::Fixed && free.base_attitude_max < 3.14159) {
    // Half a turn is no limit: the same attitude lies on the other side.
    between(rotation_log(turn).norm(), -kInfinity, free.base_attitude_max);
  }
  if (free.contact_time_upper > free.contact_time_lower) {
    between(configuration.contact_time, free.contact_time_lower, free.contact_time_upper);
  }
  if (free.base_position == PositionFreedom::Box) {
    for (int i = 0; i < 3; ++i) {
      between(configuration.base.position[i], free.base_position_lower[i],
              free.base_position_upper[i]);
    }
  }
  between(closing_speed(problem, at.event, at.event.n), problem.constraints.closing_speed_min,
          kInfinity);
  if (problem.hand.constraint == HandConstraint::Axis) {
    between(at.event.n.dot(at.response.dynamics.hand_rotation * problem.hand.approach_axis),
            -kInfinity, 0);
  }
  const MarginNumbers margins = margin_numbers(
      problem, configuration, at.motion ? &*at.motion : nullptr, at.event, at.response);
  between(margins.rate_excess, -kInfinity, 0);
  const ConstraintSpec& wanted = problem.constraints;
  if (margins.coupling) between(*margins.coupling, wanted.coupling_singular_value_min, kInfinity);
  if (margins.jacobian) between(*margins.jacobian, wanted.jacobian_singular_value_min, kInfinity);
  if (margins.distance) between(*margins.distance, *wanted.clearance, kInfinity);
  return out;
}

/// Distance of a place on a curve from the nearest limit at which the curve may end: what is at a
/// limit in its middle, too, is so all along (a box of no height, a stated closing speed).
/// @param along distances in the middle of the curve
double distance_to_end(const Judged& at, const std::vector<double>& along) {
  const std::vector<double> here = distances_to_limits(at);
  double nearest = kInfinity;
  for (std::size_t i = 0; i < here.size(); ++i) {
    if (along[i] > kAtLimit) nearest = std::min(nearest, here[i]);
  }
  return nearest;
}

/// Sum of the distances between every `stride`-th point and the last one.
double length_of(const std::vector<Place>& places, std::size_t stride) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < places.size(); i += stride) {
    sum += places[i].distance(places[std::min(i + stride, places.size() - 1)]);
  }
  return sum;
}

/// A curve as its points give it.
struct Line {
  std::string feature;
  std::vector<Place> places;

  /// Whether a place is nearer than kSameCurve to one of the chords.
  bool passes(const Place& place, double step) const {
    std::size_t i = 0;
    while (i < places.size()) {
      const double here = place.distance(places[i]);
      if (here <= kSameCurve) return true;
      if (i + 1 < places.size()) {
        const double chord = places[i].distance(places[i + 1]);
        const double there = place.distance(places[i + 1]);
        // Where along the chord the place is, by the sides of the triangle.
        const double along = (here * here - there * there + chord * chord) / (2 * chord);
        if (along > 0 && along < chord && here * here - along * along <= kSameCurve * kSameCurve) {
          return true;
        }
      }
      // Points are at most a step apart: those that cannot be near enough are left out.
      const double spare = step > 0 ? std::floor((here - kSameCurve) / step) - 1 : 0;
      i += spare > 1 ? static_cast<std::size_t>(std::min(spare, 1e6)) : 1;
    }
    return false;
  }
};

class Curves {
 public:
  explicit Curves(const Context& context) : context_(context) {}

  void judge(std::size_t number) {
    const SolutionFamily& family = context_.plan.families[number];
    if (family.points.size() < 2 && family.length > 0) {
      objections_.push_back(fmt::format("curve {}: no points", number));
      lines_.emplace_back();
      return;
    }
    std::vector<Place> places;
    for (const Configuration& point : family.points) {
      const Judged at(context_.problem, point);
      off_zero_ = std::max(off_zero_, relative_objective(at));
      const Context here = at.context(context_.options);
      for (const std::string& objection :
           configuration_objections(here, point, at.event, at.response)) {
        objections_.push_back(fmt::format("curve {}: {}", number, objection));
      }
      const Place place(context_.problem, point);
      if (!places.empty()) step_ = std::max(step_, place.distance(places.back()));
      places.push_back(place);
    }
    judge_length(family, places);
    judge_ends(family, places, number);
    judge_members(places, static_cast<int>(number));
    lines_.push_back({family.points.empty() ? "" : family.points.front().feature, places});
  }

  void claim(ClaimList& claims) const {
    claims.at_most("families_points_vanish", off_zero_, kVanishes, "1",
                   "largest predicted objective of a point of a curve of zeros");
    claims.none_wrong("families_points_allowed", objections_,
                      "points of curves that the problem does not allow");
    claims.at_most("families_points_apart", step_, kApart, "1",
                   "largest distance of neighbouring points");
    claims.at_most("families_length", length_, 1, "1",
                   "stated length from the sum of the distances, over what the spacing of the "
                   "points leaves open");
    claims.none_wrong("families_ends", ends_,
                      "curves closed but for a gap, open without one, said to end at a limit where "
                      "none is, or not to where both ends are at one");
    claims.at_most("families_members", astray_, kApart, "1",
                   "largest distance of a candidate from the nearest point of its curve");
    claims.none_wrong("families_starts", wrong_starts(),
                      "curves where no start ended, and more ends than starts");
    claims.none_wrong("families_distinct", repeated(), "curves of which most lies on another");
  }

 private:
  /// Each start ends once. Minima of a robust measure are solved from more points than the starts;
  /// the curves are those of the prediction, which the starts alone look for.
  std::vector<std::string> wrong_starts() const {
    const Plan& plan = context_.plan;
    std::vector<std::string> out;
    long long ended = 0;
    for (std::size_t i = 0; i < plan.families.size(); ++i) {
      ended += plan.families[i].starts;
      if (plan.families[i].starts < 1) out.push_back(fmt::format("curve {}: no start", i));
    }
    for (const Candidate& candidate : plan.candidates) {
      if (context_.problem.measure.kind == RiskMeasure::Nominal && candidate.family < 0) {
        ended += candidate.starts_reached;
      }
    }
    if (ended > plan.certificate.starts) {
      out.push_back(fmt::format("{} of {} starts ended", ended, plan.certificate.starts));
    }
    return out;
  }

  /// Curves may cross or touch, but not run along each other.
  std::vector<std::string> repeated() const {
    std::vector<std::string> out;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      for (std::size_t j = 0; j < lines_.size(); ++j) {
        if (i == j || lines_[i].feature != lines_[j].feature) continue;
        const std::vector<Place>& places = lines_[i].places;
        const auto common = std::count_if(places.begin(), places.end(), [&](const Place& place) {
          return lines_[j].passes(place, step_);
        });
        if (2 * static_cast<std::size_t>(common) > places.size()) {
          out.push_back(fmt::format("curve {} lies on curve {}", i, j));
        }
      }
    }
    return out;
  }

  void judge_length(const SolutionFamily& family, const std::vector<Place>& places) {
    const double fine = length_of(places, 1), coarse = length_of(places, 2);
    // Chords are shorter than arcs by a part that grows with the square of the spacing: half as
    // many leave open three times what all leave.
    const double open = std::max(1e-3 * fine, std::abs(fine - coarse)) + kMeet;
    length_ = std::max(length_, std::abs(family.length - fine) / open);
  }

  void judge_ends(const SolutionFamily& family, const std::vector<Place>& places,
                  std::size_t number) {
    const bool meet = places.size() > 2 && places.front().distance(places.back()) <= kMeet;
    if (family.is_closed != meet) {
      ends_.push_back(fmt::format("curve {}: its ends {}", number, meet ? "meet" : "are apart"));
    }
    if (family.is_closed && !family.is_complete) {
      ends_.push_back(fmt::format("curve {}: closed, but not complete", number));
    }
    if (family.is_closed || family.points.empty()) return;
    const Configuration& middle = family.points[family.points.size() / 2];
    const std::vector<double> along = distances_to_limits(Judged(context_.problem, middle));
    bool all_at_limits = true;
    for (const Configuration* end : {&family.points.front(), &family.points.back()}) {
      const double gap = distance_to_end(Judged(context_.problem, *end), along);
      if (gap <= kAtLimit) continue;
      all_at_limits = false;
      if (!family.is_complete) continue;
      ends_.push_back(
          fmt::format("curve {}: an end is {:.3g} from the nearest limit", number, gap));
    }
    if (all_at_limits && !family.is_complete) {
      ends_.push_back(fmt::format("curve {}: not complete, but both ends are at limits", number));
    }
  }

  void judge_members(const std::vector<Place>& places, int number) {
    for (const Candidate& candidate : context_.plan.candidates) {
      if (candidate.family != number) continue;
      const Place member(context_.problem, candidate.configuration);
      double nearest = kInfinity;
      for (const Place& place : places) nearest = std::min(nearest, member.distance(place));
      astray_ = std::max(astray_, nearest);
    }
  }

  const Context& context_;
  double off_zero_ = 0, step_ = 0, length_ = 0, astray_ = 0;
  std::vector<std::string> objections_, ends_;
  std::vector<Line> lines_;
};

}  // namespace

std::vector<std::string> unlisted_curves(const Context& context) {
  const Plan& plan = context.plan;
  std::vector<std::string> out;
  // Without a limit every zero with one direction open was followed; simulated ones never are.
  if (plan.status == PlanStatus::Limit || simulates_turn(context.problem)) return out;
  const auto is_listed = [&](const CaptureProblem& problem, const Configuration& at) {
    const Place place(problem, at);
    return std::any_of(plan.families.begin(), plan.families.end(), [&](const auto& family) {
      Line line;
      for (const Configuration& point : family.points) line.places.emplace_back(problem, point);
      return !family.points.empty() && family.points.front().feature == at.feature &&
             line.passes(place, 0);
    });
  };
  const auto look_at = [&](const std::string& name, const Configuration& at) {
    const CaptureProblem problem = problem_at(context.problem, at);
    if (!is_on_curve_of_zeros(problem, at) || is_listed(problem, at)) return;
    out.push_back(name + " is on a curve of zeros that is not listed");
  };
  if (context.problem.measure.kind != RiskMeasure::Nominal) {
    if (plan.nominal_optimum) look_at("the nominal optimum", plan.nominal_optimum->configuration);
    return out;
  }
  for (std::size_t i = 0; i < plan.candidates.size(); ++i) {
    const Candidate& candidate = plan.candidates[i];
    if (context.options.stop.reached()) break;
    if (candidate.family >= 0 || candidate.starts_reached < 1) continue;
    look_at(fmt::format("candidate {}", i), candidate.configuration);
  }
  return out;
}

void check_families(const Context& context, ClaimList& claims) {
  if (context.plan.families.empty()) return;
  Curves curves(context);
  for (std::size_t i = 0; i < context.plan.families.size(); ++i) {
    if (context.options.stop.reached()) {
      claims.not_evaluated("families_points_allowed", 0, "1", "stopped before the last curve");
      return;
    }
    curves.judge(i);
  }
  curves.claim(claims);
}

}  // namespace stillbase::verification
