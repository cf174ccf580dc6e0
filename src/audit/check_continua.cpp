// Continua of solutions: points, length, ends and starts of each curve; none of them twice.
#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include <stillbase/core/random.hpp>
#include <stillbase/plan/free_roll.hpp>
#include <stillbase/plan/turns.hpp>

#include "audit/checks.hpp"
#include "audit/equations.hpp"
#include "audit/manifold.hpp"
#include "audit/tolerances.hpp"
#include "verification/tolerances.hpp"

namespace stillbase::audit {

using namespace verification;

namespace {

/// How curves are compared; lengths in rad, m and s.
struct ContinuaOptions {
  double spacing = 0.1;      ///< largest distance of neighbouring points
  double turn = 0.25;        ///< rad, by which a curve bends at most between them
  double arc_error = 2e-6;   ///< relative: turn^4 / 2880 of the planner's cubics, and some
  double straight = 1e-6;    ///< half the angle of an arc, rad, that is no longer than its chord
  double closed = 1e-9;      ///< distance of the ends of a closed curve
  double same_curve = 0.01;  ///< distance from the chords between points
  double same_roll = 1e-5;   ///< the same of the range of a free joint, which is straight
  int roll_angles = 12;      ///< parts of that range, at whose ends everything has to hold
};
constexpr ContinuaOptions kContinua;

/// The search for curves that a plan does not list.
struct UnlistedOptions {
  int angles = 16;        ///< parts of the range of a joint that may be free
  int directions = 32;    ///< random ones, in which a smaller measure is looked for
  double step = 1e-3;     ///< rad, m, s: minima are known to much less
  double smaller = 1e-5;  ///< relative, by which a measure is certainly smaller
};
constexpr UnlistedOptions kUnlisted;

/// The variables of a configuration as lengths of curves count them: joints, rotation vector of the
/// base from its stated attitude, time.
class Place {
 public:
  /// @param problem must outlive this object
  Place(const CaptureProblem& problem, const Configuration& at)
      : problem_(&problem),
        phi_(at.phi),
        rotation_(rotation_log(at.base.orientation * problem.base.orientation.conjugate())),
        time_(at.contact_time) {}

  /// Euclidean distance, angles and rotations modulo full rotations.
  double distance(const Place& other) const {
    double sum = (other.rotation_near(rotation_) - rotation_).squaredNorm() +
                 std::pow(other.time_ - time_, 2);
    for (int k = 0; k < phi_.size(); ++k) {
      const double d = other.phi_[k] - phi_[k];
      sum += std::pow(reaches_every_angle(*problem_, k) ? std::remainder(d, 2 * kPi) : d, 2);
    }
    return std::sqrt(sum);
  }

 private:
  /// The one of the two rotation vectors of this attitude that is nearer to the given one.
  Vector3d rotation_near(const Vector3d& reference) const {
    const double angle = rotation_.norm();
    if (!(angle > 0)) return rotation_;
    const Vector3d other = rotation_ * (1 - 2 * kPi / angle);
    return (other - reference).norm() < (rotation_ - reference).norm() ? other : rotation_;
  }

  const CaptureProblem* problem_;
  Eigen::VectorXd phi_;
  Vector3d rotation_;
  double time_;
};

/// Distance of a configuration on a curve from the nearest limit at which the curve may end. A
/// limit that holds in the middle of the curve as well holds all along it (a box of no height, a
/// stated closing speed), and does not count.
/// @param along distances in the middle of the curve
double distance_to_end(const Situation& at, const std::vector<double>& along) {
  const std::vector<double> here = distances_from_limits(at);
  double nearest = kInfinity;
  for (std::size_t i = 0; i < here.size(); ++i) {
    if (std::abs(along[i]) > kRecord.reached) nearest = std::min(nearest, std::abs(here[i]));
  }
  return nearest;
}

/// Curvature of the circle through three points, from the triangle's sides (Menger; Kahan's form of
/// Heron's area).
double curvature_of(double a, double b, double c) {
  if (!(a > 0 && b > 0 && c > 0)) return 0;
  double s[] = {a, b, c};
  std::sort(s, s + 3, std::greater<>());
  const double square = (s[0] + (s[1] + s[2])) * (s[2] - (s[0] - s[1])) * (s[2] + (s[0] - s[1])) *
                        (s[0] + (s[1] - s[2]));
  return std::sqrt(std::max(0.0, square)) / (a * b * c);
}

/// Part by which an arc of this curvature is longer than its chord.
double excess_of_arc(double curvature, double chord) {
  const double sine = std::min(1.0, curvature * chord / 2);  // of half the angle
  return sine > kContinua.straight ? std::asin(sine) / sine - 1 : 0;
}

/// Length of a curve through points, and how far that may be wrong.
struct Length {
  double value = 0, open = 0;

  /// Of arcs in place of the chords, on the circles through neighbouring points; where both ends of
  /// a chord differ in theirs, the length is uncertain by that much.
  explicit Length(const std::vector<Place>& places, bool is_closed) {
    if (places.size() < 2) return;
    const std::size_t chords = places.size() - 1;
    std::vector<double> chord(chords), curvature(places.size(), 0);
    for (std::size_t i = 0; i < chords; ++i) chord[i] = places[i].distance(places[i + 1]);
    for (std::size_t i = 1; i < chords; ++i) {
      curvature[i] = curvature_of(chord[i - 1], chord[i], places[i - 1].distance(places[i + 1]));
    }
    if (chords > 1) {
      curvature.front() = curvature[1];
      curvature.back() = curvature[chords - 1];
    }
    if (is_closed && chords > 2) {
      curvature.front() = curvature.back() =
          curvature_of(chord.front(), chord.back(), places[1].distance(places[chords - 1]));
    }
    for (std::size_t i = 0; i < chords; ++i) {
      const double before = excess_of_arc(curvature[i], chord[i]);
      const double after = excess_of_arc(curvature[i + 1], chord[i]);
      value += chord[i] * (1 + (before + after) / 2);
      // The bend at an end of the curve is that of the point beside it.
      const bool is_end = !is_closed && (i == 0 || i + 1 == chords);
      open +=
          chord[i] * (kContinua.arc_error + std::abs(before - after) + (is_end ? before / 2 : 0));
    }
    // The bend between two points alone is not known.
    if (chords == 1) open += chord.front() * kContinua.turn * kContinua.turn / 24;
  }
};

/// A curve as its points give it.
struct Curve {
  std::string feature;
  bool is_roll;
  std::vector<Place> places;

  Curve(const CaptureProblem& problem, const SolutionFamily& family)
      : feature(family.points.empty() ? "" : family.points.front().feature),
        is_roll(free_joint(family).has_value()) {
    for (const Configuration& point : family.points) places.emplace_back(problem, point);
  }

  /// Whether a place is nearer than `same` to one of the chords.
  /// @param step largest distance of neighbouring points; 0: not known
  bool passes(const Place& place, double step, double same = kContinua.same_curve) const {
    std::size_t i = 0;
    while (i < places.size()) {
      const double here = place.distance(places[i]);
      if (here <= same) return true;
      if (i + 1 < places.size()) {
        const double chord = places[i].distance(places[i + 1]);
        const double there = place.distance(places[i + 1]);
        // Foot of the place on the chord, by the sides of the triangle.
        const double along = (here * here - there * there + chord * chord) / (2 * chord);
        if (along > 0 && along < chord && here * here - along * along <= same * same) {
          return true;
        }
      }
      // Points at most a step apart: those that cannot be near enough are skipped.
      const double spare = step > 0 ? std::floor((here - same) / step) - 1 : 0;
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
    const std::string name = fmt::format("curve {}: ", number);
    const Curve& curve = curves_.emplace_back(context_.problem, family);
    objections_.demand(family.points.size() >= 2 || !(family.length > 0), name + "no points");
    if (family.points.size() < 2 && family.length > 0) return;
    if (const std::optional<int> joint = free_joint(family)) {
      judge_roll(family, *joint, static_cast<int>(number), name);
      return;
    }
    for (std::size_t i = 0; i < family.points.size(); ++i) {
      const Situation at(context_.problem, family.points[i]);
      const Vector3d& n = at.event.n;
      const double zero = objective_along(at, n) / std::max(scale_along(at, n), 1e-300);
      off_zero_ = std::max(off_zero_, zero);
      for (const std::string& objection : configuration_objections(at, context_.options)) {
        objections_.add(name + objection);
      }
      if (i > 0) step_ = std::max(step_, curve.places[i].distance(curve.places[i - 1]));
    }
    judge_length(family, curve.places);
    judge_ends(family, curve.places, name);
    judge_members(curve.places, static_cast<int>(number));
  }

  void claim(ClaimList& claims) const {
    claims.at_most("families_points_vanish", off_zero_, kRecord.zero, "1",
                   "largest nominal objective of a point of a continuum of zeros");
    claims.none_wrong("families_points_allowed", objections_,
                      "points of curves that the problem does not allow");
    claims.at_most("families_points_apart", step_, kContinua.spacing, "1",
                   "largest distance of neighbouring points");
    claims.at_most("families_length", length_, 1, "1",
                   "stated length from that of arcs through the points, over the error that their "
                   "bends leave open");
    claims.none_wrong("families_ends", ends_,
                      "closed curves with a gap, open ones without, complete ones that do not end "
                      "at limits, and others that do");
    claims.at_most("families_members", astray_, kContinua.spacing, "1",
                   "largest distance of a candidate from the nearest point of its curve");
    claims.none_wrong("families_starts", wrong_starts(),
                      "curves that no start reached, and more ends than starts");
    if (has_roll_) {
      claims.at_most("families_rolls", turned_, kRecord.unchanged, "1",
                     "largest change of objective or measure over the angles of a free joint, "
                     "relative to the terms that the objective is made of");
      claims.none_wrong("families_rolls_stated", rolls_,
                        "free joints whose range is not that between their limits, and candidates "
                        "beside it");
    }
    claims.none_wrong("families_distinct", repeated(), "curves of which most lies on another");
  }

 private:
  /// Each start ends once. Minima of a robust measure are solved from more points than the starts;
  /// the curves are those of the nominal objective, which only the starts search.
  Objections wrong_starts() const {
    const Plan& plan = context_.plan;
    Objections out;
    long long ended = 0;
    for (std::size_t i = 0; i < plan.families.size(); ++i) {
      const bool is_nominal = context_.problem.measure.kind == RiskMeasure::Nominal;
      if (is_nominal || !free_joint(plan.families[i])) ended += plan.families[i].starts;
      out.demand(plan.families[i].starts >= 1, fmt::format("curve {}: no start", i));
    }
    for (const Candidate& candidate : plan.candidates) {
      if (context_.problem.measure.kind == RiskMeasure::Nominal && candidate.family < 0) {
        ended += candidate.starts_reached;
      }
    }
    out.demand(ended <= plan.certificate.starts,
               fmt::format("{} of {} starts ended", ended, plan.certificate.starts));
    return out;
  }

  /// Curves may cross or touch, but not coincide.
  Objections repeated() const {
    Objections out;
    for (std::size_t i = 0; i < curves_.size(); ++i) {
      for (std::size_t j = 0; j < curves_.size(); ++j) {
        if (i == j || curves_[i].feature != curves_[j].feature) continue;
        const std::vector<Place>& places = curves_[i].places;
        const auto common = std::count_if(places.begin(), places.end(), [&](const Place& place) {
          return curves_[j].is_roll ? curves_[j].passes(place, 0, kContinua.same_roll)
                                    : curves_[j].passes(place, step_);
        });
        out.demand(2 * static_cast<std::size_t>(common) <= places.size(),
                   fmt::format("curve {} lies on curve {}", i, j));
      }
    }
    return out;
  }

  /// The whole range of a joint on whose angle nothing depends.
  void judge_roll(const SolutionFamily& family, int k, int number, const std::string& name) {
    has_roll_ = true;
    const CaptureProblem& problem = context_.problem;
    const Joint& joint = problem.robot.joints[k];
    const double lower = family.points.front().phi[k], upper = family.points.back().phi[k];
    const bool is_turn = joint.type == JointType::Continuous;
    const double margin = problem.constraints.joint_limit_margin;
    const double least = is_turn ? upper - 2 * kPi : joint.lower + margin;
    const double most = is_turn ? lower + 2 * kPi : joint.upper - margin;
    rolls_.demand(problem.variables.joints[k], name + "its joint is not free");
    rolls_.demand(
        std::abs(lower - least) <= kShared.rounding && std::abs(upper - most) <= kShared.rounding,
        name + "does not end at the joint's limits");
    rolls_.demand(std::abs(family.length - (upper - lower)) <= kShared.rounding,
                  name + "its length");
    rolls_.demand(family.is_closed == is_turn && family.is_complete, name + "its ends");
    Configuration at = family.points.front();
    const auto numbers = [&] {
      return objective_numbers(Situation(problem, at), context_.cone_samples());
    };
    const ObjectiveNumbers first = numbers();
    for (int i = 0; i <= kContinua.roll_angles; ++i) {
      at.phi[k] = lower + (upper - lower) * i / kContinua.roll_angles;
      for (const std::string& objection :
           configuration_objections(Situation(problem, at), context_.options)) {
        objections_.add(name + objection);
      }
      const ObjectiveNumbers here = numbers();
      turned_ = std::max({turned_, std::abs(here.nominal - first.nominal) / first.scale,
                          std::abs(here.worst_case - first.worst_case) / first.scale,
                          std::abs(here.measure - first.measure) / first.scale});
    }
    for (const Candidate& candidate : context_.plan.candidates) {
      if (candidate.family != number) continue;
      const double angle = candidate.configuration.phi[k];
      rolls_.demand(
          is_turn || (angle >= lower - kShared.rounding && angle <= upper + kShared.rounding),
          name + "its candidate is beyond the ends");
      at.phi[k] = angle;
      rolls_.demand(
          Place(problem, at).distance({problem, candidate.configuration}) <= kShared.rounding,
          name + "its candidate differs in other joints");
    }
  }

  void judge_length(const SolutionFamily& family, const std::vector<Place>& places) {
    const Length own(places, family.is_closed);
    length_ =
        std::max(length_, std::abs(family.length - own.value) / (own.open + kContinua.closed));
  }

  void judge_ends(const SolutionFamily& family, const std::vector<Place>& places,
                  const std::string& name) {
    const bool is_closed =
        places.size() > 2 && places.front().distance(places.back()) <= kContinua.closed;
    ends_.demand(family.is_closed == is_closed,
                 name + (is_closed ? "its ends coincide" : "its ends are apart"));
    ends_.demand(!family.is_closed || family.is_complete, name + "closed, but not complete");
    if (family.is_closed || family.points.empty()) return;
    const Configuration& middle = family.points[family.points.size() / 2];
    std::vector<double> along = distances_from_limits({context_.problem, middle});
    // Of a short curve the ends alone are stated: no middle says which limits hold all along.
    if (family.points.size() < 3) std::fill(along.begin(), along.end(), kInfinity);
    bool all_at_limits = true;
    for (const Configuration* end : {&family.points.front(), &family.points.back()}) {
      const double gap = distance_to_end({context_.problem, *end}, along);
      if (gap <= kRecord.reached) continue;
      all_at_limits = false;
      ends_.demand(!family.is_complete,
                   fmt::format("{}an end is {:.3g} from the nearest limit", name, gap));
    }
    ends_.demand(family.is_complete || !all_at_limits,
                 name + "not complete, but both ends are at limits");
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
  double off_zero_ = 0, step_ = 0, length_ = 0, astray_ = 0, turned_ = 0;
  bool has_roll_ = false;
  Objections objections_, ends_, rolls_;
  std::vector<Curve> curves_;
};

/// Whether the joint that carries the hand may have any angle there: nothing that the problem asks
/// for depends on it, to a hundredth of what a plan may leave open. The constraints hold to half of
/// what the search asks for: a hand whose axis is tilted by the rounding of a robot file leaves
/// more open than that, and less than a verified plan may.
bool has_free_roll(const Context& context, const Configuration& at) {
  constexpr double same = kRecord.unchanged / 100;
  const CaptureProblem& problem = context.problem;
  const RobotModel& robot = problem.robot;
  if (robot.hand_body == kBase) return false;
  const int k = robot.coordinate(robot.hand_body);
  const Joint& joint = robot.joints[k];
  if (joint.is_prismatic() || takes_part_in_coupling(robot, k)) return false;
  if (!problem.variables.joints[k]) return false;
  const bool is_turn = joint.type == JointType::Continuous;
  const double margin = problem.constraints.joint_limit_margin;
  const double lower = is_turn ? -kPi : joint.lower + margin;
  const double upper = is_turn ? kPi : joint.upper - margin;
  if (!(upper > lower)) return false;
  const auto turned = [&](int part) {
    Configuration there = at;
    there.phi[k] = lower + (upper - lower) * part / kUnlisted.angles;
    return there;
  };
  VerifyOptions strict = context.options;
  strict.hand_position_tolerance = strict.hand_angle_tolerance = strict.constraint_tolerance =
      kFeasibilityTolerance / 2;
  const Situation here(problem, at);
  const double nominal = objective_along(here, here.event.n);
  const double scale = std::max(scale_along(here, here.event.n), 1e-300);
  for (int i = 0; i <= kUnlisted.angles; ++i) {
    const Situation there(problem, turned(i));
    const double value = objective_along(there, there.event.n);
    if (!(std::abs(value - nominal) <= same * scale)) return false;
    if (!configuration_objections(there, strict).empty()) return false;
  }
  if (problem.measure.kind == RiskMeasure::Nominal) return true;
  const double measure = objective_numbers(here, context.cone_samples()).measure;
  for (int i = 0; i <= kUnlisted.angles; i += kUnlisted.angles / 4) {
    const Situation there(problem, turned(i));
    const double value = objective_numbers(there, context.cone_samples()).measure;
    if (!(std::abs(value - measure) <= same * scale)) return false;
  }
  return true;
}

/// Whether the measure is certainly smaller beside a configuration: then it is no minimum of the
/// measure, and only a search for zeros can have found it.
bool has_better_beside(const Context& context, const Configuration& at) {
  const Situation here(context.problem, at);
  const FeasibleManifold manifold(here.problem, at);
  if (!manifold.objection().empty() || manifold.dimension() == 0) return false;
  const int samples = std::min(kRecord.cone_samples, context.cone_samples());
  const double value = measure_value(here, samples);
  Random random(11);
  for (int i = 0; i < kUnlisted.directions && !context.options.stop.reached(); ++i) {
    Eigen::VectorXd u(manifold.dimension());
    for (double& entry : u) entry = random.normal();
    const std::optional<Configuration> beside = manifold.at(kUnlisted.step * u.normalized());
    if (!beside) continue;
    const Situation there(context.problem, *beside);
    if (measure_value(there, samples) < (1 - kUnlisted.smaller) * value &&
        configuration_objections(there, context.options).empty()) {
      return true;
    }
  }
  return false;
}

}  // namespace

std::vector<std::string> unlisted_curves(const Context& context) {
  const Plan& plan = context.plan;
  std::vector<std::string> out;
  // Without a limit every zero with one free direction is followed; simulated objectives never are.
  if (plan.status == PlanStatus::Limit || simulates_turn(context.problem)) return out;
  for (std::size_t i = 0; i < plan.candidates.size(); ++i) {
    const Candidate& candidate = plan.candidates[i];
    if (context.options.stop.reached() || !plan.objective.user_terms.empty()) break;
    if (candidate.family >= 0 || candidate.starts_reached < 1) continue;
    if (has_free_roll(context, candidate.configuration)) {
      out.push_back(fmt::format("candidate {} has a free roll that is not listed", i));
    }
  }
  const auto is_unlisted = [&](const Configuration& at) {
    if (!is_on_curve_of_zeros(Situation(context.problem, at).problem, at)) return false;
    const Place place(context.problem, at);
    return std::none_of(plan.families.begin(), plan.families.end(),
                        [&](const SolutionFamily& family) {
                          const Curve curve(context.problem, family);
                          return curve.feature == at.feature && curve.passes(place, 0);
                        });
  };
  const char* const words = " is on a curve of zeros that is not listed";
  const bool is_nominal = context.problem.measure.kind == RiskMeasure::Nominal;
  if (!is_nominal && plan.nominal_optimum && is_unlisted(plan.nominal_optimum->configuration)) {
    out.push_back(std::string("the nominal optimum") + words);
  }
  for (std::size_t i = 0; i < plan.candidates.size(); ++i) {
    const Candidate& candidate = plan.candidates[i];
    if (context.options.stop.reached() || !plan.objective.user_terms.empty()) break;
    if (candidate.family >= 0 || candidate.starts_reached < 1) continue;
    if (!is_unlisted(candidate.configuration)) continue;
    if (is_nominal || has_better_beside(context, candidate.configuration)) {
      out.push_back(fmt::format("candidate {}{}", i, words));
    }
  }
  return out;
}

void check_continua(const Context& context, ClaimList& claims) {
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

}  // namespace stillbase::audit
