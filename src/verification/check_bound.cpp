// The lower bound of the measure. That no posture at all is below it is the proof's own word; but
// none of the candidates may be, and neither may what a search by `reference` finds.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/core/random.hpp>

#include "verification/checks.hpp"
#include "verification/worst_direction.hpp"

namespace stillbase::verification {
namespace {

constexpr double kRounding = 1e-9;  // relative
constexpr int kStarts = 100;
constexpr int kDescents = 4;
constexpr int kSteps = 60;
constexpr int kConeSamples = 60;

/// Postures that the problem allows, and what they are worth.
class Postures {
 public:
  Postures(const Context& context, const ContactEvent& event)
      : context_(context), problem_(context.problem), event_(event) {
    const double margin = problem_.constraints.joint_limit_margin;
    for (int k = 0; k < problem_.robot.n(); ++k) {
      if (!problem_.variables.joints[static_cast<std::size_t>(k)]) continue;
      const Joint& joint = problem_.robot.joints[static_cast<std::size_t>(k)];
      const bool turns = joint.type == JointType::Continuous;
      free_.push_back(k);
      lower_.push_back(turns ? -M_PI : joint.lower + margin);
      upper_.push_back(turns ? M_PI : joint.upper - margin);
      turns_.push_back(turns);
    }
    if (problem_.hand.constraint == HandConstraint::None ||
        problem_.variables.base_position != PositionFreedom::Fixed || !problem_.hand.position) {
      return;
    }
    hand_ = problem_.hand.frame == Frame::Base
                ? *problem_.hand.position
                : Vector3d(problem_.base.inverse() * *problem_.hand.position);
  }

  int size() const { return static_cast<int>(free_.size()); }

  Eigen::VectorXd start(int index) const {
    const Eigen::VectorXd u = low_discrepancy_point(index, size(), 1);
    Eigen::VectorXd phi = problem_.start;
    for (int i = 0; i < size(); ++i) phi[free_[i]] = lower_[i] + u[i] * (upper_[i] - lower_[i]);
    return phi;
  }

  /// Moved by a step of this size in a random direction.
  Eigen::VectorXd beside(Eigen::VectorXd phi, double step, Random& random) const {
    for (const int k : free_) phi[k] += step * random.uniform(-1, 1);
    return phi;
  }

  /// Brought to the hand's point (Gauss-Newton); empty: it does not get there within the limits.
  std::optional<Eigen::VectorXd> allowed(Eigen::VectorXd phi) const {
    for (int iteration = 0; hand_ && iteration < 30; ++iteration) {
      const reference::Dynamics at = reference::compute(problem_.robot, {phi, {}, {}});
      const Vector3d off = Vector3d(at.hand_position) - *hand_;
      if (off.norm() <= 1e-11) break;
      if (iteration == 29) return std::nullopt;
      Eigen::MatrixXd J(3, size());
      for (int i = 0; i < size(); ++i) J.col(i) = at.J.col(6 + free_[i]).head<3>();
      Eigen::VectorXd step = -J.completeOrthogonalDecomposition().solve(off);
      if (step.norm() > 0.5) step *= 0.5 / step.norm();
      for (int i = 0; i < size(); ++i) phi[free_[i]] += step[i];
    }
    for (int i = 0; i < size(); ++i) {
      const double x = phi[free_[i]];
      if (!turns_[i] && !(x >= lower_[i] && x <= upper_[i])) return std::nullopt;
    }
    return phi;
  }

  /// The problem's measure: as predicted, or the largest value over the cone.
  double measure(const Eigen::VectorXd& phi) const {
    const PostureResponse response = posture_response(problem_, phi);
    const auto value = [&](const Vector3d& d) {
      return objective_value(problem_, response, impulse_along(problem_, event_, response, d));
    };
    if (problem_.measure.kind != RiskMeasure::WorstCase) return value(event_.n);
    return worst_over_cone(value, event_.n, problem_.uncertainty.cone_half_angle,
                           problem_.uncertainty.cone_plane_normal,
                           std::min(kConeSamples, context_.options.cone_samples))
        .value;
  }

 private:
  const Context& context_;
  const CaptureProblem& problem_;
  const ContactEvent& event_;
  std::vector<int> free_;
  std::vector<double> lower_, upper_;
  std::vector<bool> turns_;
  std::optional<Vector3d> hand_;
};

struct Found {
  Eigen::VectorXd phi;
  double value = 0;
};

/// The least measure that random postures and random steps from the best of them lead to.
std::optional<Found> search_below(const Context& context, const Postures& postures) {
  std::vector<Found> found;
  for (int s = 0; s < kStarts && !context.options.stop.reached(); ++s) {
    const auto phi = postures.allowed(postures.start(s));
    if (phi) found.push_back({*phi, postures.measure(*phi)});
  }
  std::sort(found.begin(), found.end(),
            [](const Found& a, const Found& b) { return a.value < b.value; });
  if (found.size() > kDescents) found.resize(kDescents);
  for (std::size_t i = 0; i < found.size(); ++i) {
    Random random(7, i);
    double step = 0.3;
    for (int k = 0; k < kSteps && !context.options.stop.reached(); ++k) {
      const auto next = postures.allowed(postures.beside(found[i].phi, step, random));
      const double value = next ? postures.measure(*next) : kInfinity;
      if (value < found[i].value) {
        found[i] = {*next, value};
        step *= 1.5;
      } else {
        step *= 0.85;
      }
    }
  }
  if (found.empty()) return std::nullopt;
  return *std::min_element(found.begin(), found.end(),
                           [](const Found& a, const Found& b) { return a.value < b.value; });
}

}  // namespace

void check_bound(const Context& context, const ContactEvent& event, ClaimList& claims) {
  const Plan& plan = context.plan;
  const Proof& proof = plan.certificate.proof;
  if (!proof.lower_bound || !(*proof.lower_bound > 0)) return;
  const double bound = *proof.lower_bound;
  const CaptureProblem& problem = context.problem;
  const std::string unit = objective_unit_name(problem);

  std::vector<std::string> objections;
  const auto demand = [&](bool holds, const std::string& what) {
    if (!holds) objections.push_back(what);
  };
  demand(proof.statement.find("no posture has ") != std::string::npos,
         "the statement does not say what is bounded");
  demand(proof.statement.compare(0, 6, "proven") == 0 || proof.status == ProofStatus::Undecided,
         "the statement does not begin with 'proven'");
  demand(proof.boxes > 0, "no box was looked at");
  demand(problem.variables.base_attitude == AttitudeFreedom::Fixed &&
             problem.variables.contact_time_upper <= problem.variables.contact_time_lower,
         "base or contact time are free");
  bool is_gap = false;
  double least = plan.objective.value;
  for (const Candidate& candidate : plan.candidates) {
    if (!(candidate.max_violation <= context.options.constraint_tolerance)) continue;
    least = std::min(least, candidate.value);
    is_gap = is_gap || (proof.gap && *proof.gap == candidate.value - bound);
  }
  demand(is_gap, "the gap is that of no candidate");
  demand(!proof.gap || least - bound <= *proof.gap,
         "a candidate is nearer to the bound than the gap");
  claims.none_wrong("proof_bound_statement", objections, "words, boxes and gap of the bound fit");
  claims.at_least("proof_bound", least, bound, kRounding * bound, unit,
                  fmt::format("least measure of the candidates; none may be below {:.9g}", bound));

  const Postures postures(context, event);
  const std::optional<Found> found = search_below(context, postures);
  if (!found) return;  // too few postures to be met by chance
  claims.at_least(
      "proof_bound_searched", found->value, bound, kRounding * bound, unit,
      fmt::format("least measure that random postures lead to; none may be below {:.9g} "
                  "(it proves nothing; the proof does)",
                  bound));
}

}  // namespace stillbase::verification
