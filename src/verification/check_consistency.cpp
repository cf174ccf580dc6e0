// What a plan says beside its numbers: bounds of its constraints, its list of candidates, its
// status and who found it. All of it is held against the problem, not against itself.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "verification/checks.hpp"
#include "verification/margins.hpp"

namespace stillbase::verification {
namespace {

// Bounds are copied from the problem; those with a margin or a square are computed.
constexpr double kSameBound = 1e-12;

// Largest KKT residual of an optimal plan.
constexpr double kStationary = 1e-6;

// rad, m, s: what lies this close together is one solution.
constexpr double kSameConfiguration = 5e-6;

struct Bounds {
  double lower, upper;
};

int axis_of(const std::string& name) { return name.empty() ? -1 : name.back() - 'x'; }

bool begins_with(const std::string& name, const std::string& prefix) {
  return name.compare(0, prefix.size(), prefix) == 0;
}

/// The bounds that the problem gives a constraint of this name; empty for an unknown one.
std::optional<Bounds> bounds_of(const std::string& name, const CaptureProblem& problem) {
  const double infinity = kInfinity;
  for (const char* equation : {"hand_position_", "hand_axis_", "hand_rotation_", "case_"}) {
    if (begins_with(name, equation)) return Bounds{0, 0};
  }
  if (name == "hand_facing") {
    const bool is_pose = problem.hand.constraint == HandConstraint::Pose;
    return is_pose ? Bounds{0, infinity} : Bounds{-infinity, 0};
  }
  if (name == "closing_speed") return Bounds{problem.constraints.closing_speed_min, infinity};
  const VariableSpec& free = problem.variables;
  const int axis = axis_of(name);
  if (begins_with(name, "base_position_") && axis >= 0 && axis < 3) {
    return Bounds{free.base_position_lower[axis], free.base_position_upper[axis]};
  }
  if (name == "base_attitude_squared") {
    return Bounds{0, free.base_attitude_max * free.base_attitude_max};
  }
  if (name == "base_attitude_cone") return Bounds{std::cos(free.base_attitude_max), infinity};
  if (begins_with(name, "joint_rate_")) {
    const int k = find_joint(problem.robot, name.substr(11));
    if (k < 0) return std::nullopt;
    return Bounds{-joint_rate_limit(problem, k), joint_rate_limit(problem, k)};
  }
  const ConstraintSpec& wanted = problem.constraints;
  if (name == "coupling_singular_value") {
    return Bounds{wanted.coupling_singular_value_min, infinity};
  }
  if (name == "jacobian_singular_value") {
    return Bounds{wanted.jacobian_singular_value_min, infinity};
  }
  if (clearance_numbers(name)) return Bounds{wanted.clearance.value_or(-infinity), infinity};
  if (begins_with(name, "joint_limit_")) {
    const int k = find_joint(problem.robot, name.substr(12));
    if (k < 0) return std::nullopt;
    const Joint& joint = problem.robot.joints[static_cast<std::size_t>(k)];
    const bool turns = joint.type == JointType::Continuous;
    const double margin = turns ? 0 : problem.constraints.joint_limit_margin;
    return Bounds{joint.lower + margin, joint.upper - margin};
  }
  return std::nullopt;
}

double difference(double stated, double wanted) {
  if (stated == wanted) return 0;  // infinities included
  return std::abs(stated - wanted) / (1 + std::abs(wanted));
}

void check_bounds(const Context& context, ClaimList& claims) {
  double largest = 0;
  std::string where = "none";
  for (const ConstraintValue& c : context.plan.constraints) {
    const auto bounds = bounds_of(c.name, context.problem);
    if (!bounds) continue;
    const double d =
        std::max(difference(c.lower, bounds->lower), difference(c.upper, bounds->upper));
    if (!(d <= largest)) {
      largest = d;
      where = c.name;
    }
  }
  claims.at_most("constraint_bounds", largest, kSameBound, "1",
                 "stated bounds from those of the problem: " + where);
}

/// Relative momentum that the problem's case wants to be zero, at one configuration.
double case_residual(const CaptureProblem& problem, const PostureResponse& response,
                     const ContactEvent& event) {
  Vector6d unit;
  unit << event.n, event.moment;
  if (problem.impulse.source == ImpulseSource::Given) unit.tail<3>() /= problem.impulse.magnitude;
  const reference::Impact impact = response.impact(unit);
  const double scale = response.momentum_scale(unit);
  const double total = impact.total.norm() / scale, base = impact.base.norm() / scale,
               coupling = impact.coupling.norm() / scale;
  switch (problem.constraints.impact_case) {
    case CaseConstraint::None:
      return 0;
    case CaseConstraint::C:
    case CaseConstraint::C1:
      return total;
    case CaseConstraint::C2:
      return std::max({total, base, coupling});
    case CaseConstraint::G2:
      return base;
    case CaseConstraint::G3:
      return coupling;
  }
  return 0;
}

/// Every candidate is a configuration that the problem allows, with the hand where the contact is.
void check_each_candidate(const Context& context, ClaimList& claims) {
  std::vector<std::string> objections;
  for (std::size_t i = 0; i < context.plan.candidates.size(); ++i) {
    if (context.options.stop.reached()) {
      claims.not_evaluated("candidates_allowed", 0, "1", "stopped before the last candidate");
      return;
    }
    const Candidate& candidate = context.plan.candidates[i];
    const Configuration& at = candidate.configuration;
    const CaptureProblem problem = problem_at(context.problem, at);
    const PostureResponse response = posture_response(problem, at.phi);
    const auto motion = target_motion(
        problem, at, at.base * Vector3d(response.dynamics.hand_position), at.contact_time);
    const ContactEvent event = contact_event(problem, motion ? &*motion : nullptr, at);
    const Context one{context.plan, problem, context.options, motion ? &*motion : nullptr};
    for (const std::string& objection : configuration_objections(one, at, event, response)) {
      objections.push_back(fmt::format("candidate {}: {}", i, objection));
    }
    if (!(candidate.max_violation >= 0 &&
          candidate.max_violation <= context.options.constraint_tolerance)) {
      objections.push_back(fmt::format("candidate {}: stated violation", i));
    }
  }
  claims.none_wrong("candidates_allowed", objections, "candidates that the problem does not allow");
}

bool is_same(const Configuration& a, const Configuration& b) {
  return a.feature == b.feature && (a.phi - b.phi).norm() <= kSameConfiguration &&
         std::abs(a.contact_time - b.contact_time) <= kSameConfiguration &&
         pose_error(a.base, b.base).largest() <= kSameConfiguration;
}

void check_list(const Context& context, ClaimList& claims) {
  const Plan& plan = context.plan;
  std::vector<std::string> objections;
  const auto demand = [&](bool holds, const std::string& what) {
    if (!holds) objections.push_back(what);
  };
  // A sample of the self-motion that the approach leads to stands behind those that were found.
  const bool has_sample = plan.candidates.size() > 1 &&
                          plan.candidates.back().starts_reached == 0 &&
                          plan.candidates.back().family < 0 &&
                          is_same(plan.candidates.back().configuration, plan.configuration);
  const std::size_t count = plan.candidates.size() - (has_sample ? 1 : 0);
  const std::size_t most = static_cast<std::size_t>(context.problem.search.max_candidates);
  demand(count >= 1, "there is none");
  demand(count <= most, "more than the problem keeps");
  const std::size_t distinct = static_cast<std::size_t>(plan.certificate.distinct_solutions);
  demand(count == std::min(distinct, most),
         fmt::format("{} listed of {} distinct solutions", count, distinct));
  // How many starts ended at each solution, or on each curve of them.
  std::vector<int> on_curve(plan.families.size(), 0), ended;
  for (std::size_t i = 0; i < count; ++i) {
    const Candidate& candidate = plan.candidates[i];
    if (candidate.family < 0) {
      ended.push_back(candidate.starts_reached);
      demand(candidate.starts_reached >= 1, fmt::format("{} was reached by no start", i));
    } else {
      on_curve[static_cast<std::size_t>(candidate.family)] += candidate.starts_reached;
    }
  }
  ended.insert(ended.end(), on_curve.begin(), on_curve.end());
  const int reached = std::accumulate(ended.begin(), ended.end(), 0);
  const auto once = std::count(ended.begin(), ended.end(), 1);
  for (std::size_t i = 0; i < plan.candidates.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      demand(!is_same(plan.candidates[i].configuration, plan.candidates[j].configuration),
             fmt::format("{} is {} again", i, j));
    }
  }
  const bool is_nominal = context.problem.measure.kind == RiskMeasure::Nominal;
  // The minima of a robust measure are solved from more points than the starts.
  demand(!is_nominal || reached <= plan.certificate.starts,
         "more starts ended here than were made");
  // Good and Turing's estimate follows from a list that is whole.
  const bool is_whole =
      count == distinct && plan.certificate.proof.found_by_search ==
                               static_cast<int>(plan.certificate.proof.solutions.size());
  if (is_nominal && is_whole) {
    const double unseen = static_cast<double>(once) / std::max(reached, 1);
    demand(std::abs(plan.certificate.unseen - unseen) <= 1e-12,
           fmt::format("unseen is {}, the list gives {}", plan.certificate.unseen, unseen));
  }
  // Minima of a robust measure that are on a curve count beside the starts that ended there.
  for (std::size_t i = 0; i < on_curve.size(); ++i) {
    const int starts = plan.families[i].starts;
    // A list that was cut may lack some of them.
    const bool fits = !is_nominal ? !is_whole || starts <= on_curve[i]
                      : is_whole  ? starts == on_curve[i]
                                  : starts >= on_curve[i];
    demand(fits,
           fmt::format("{} starts ended on curve {}, the list gives {}", starts, i, on_curve[i]));
  }
  for (const std::string& what : unlisted_curves(context)) objections.push_back(what);
  claims.none_wrong("candidates_list", objections,
                    "every distinct solution once, as many as the problem keeps, and the sample of "
                    "self-motion that the approach leads to");
}

void check_search(const Context& context, ClaimList& claims) {
  const Plan& plan = context.plan;
  std::vector<std::string> objections;
  const auto demand = [&](bool holds, const std::string& what) {
    if (!holds) objections.push_back(what);
  };
  demand(plan.optimizer == context.problem.search.optimizer, "the optimizer is " + plan.optimizer +
                                                                 ", the problem's is " +
                                                                 context.problem.search.optimizer);
  demand(plan.status == PlanStatus::Limit || plan.solver_calls.count(plan.optimizer) == 1,
         "no calls of the optimizer");
  for (const auto& [name, calls] : plan.solver_calls) {
    demand(calls >= 1, fmt::format("{} calls of {}", calls, name));
  }
  demand(plan.certificate.starts >= 1, "no starts");
  const bool was_cut = plan.status == PlanStatus::Limit;
  demand((std::isfinite(plan.certificate.kkt_residual) || was_cut) &&
             plan.certificate.kkt_residual >= 0,
         "the KKT residual is no number");
  const bool all_judged =
      plan.objective.is_judged &&
      std::all_of(plan.candidates.begin(), plan.candidates.end(),
                  [](const Candidate& candidate) { return candidate.is_judged; });
  demand(all_judged || (was_cut && simulates_turn(context.problem)),
         "worst cases that are not worked out without a limit that was reached");
  const bool is_stationary = plan.certificate.kkt_residual <= kStationary;
  demand(plan.status != PlanStatus::Optimal || is_stationary,
         "said to be optimal with a large KKT residual");
  demand(plan.status != PlanStatus::Feasible || !is_stationary,
         "said to be only feasible with a small KKT residual");
  const Proof& proof = plan.certificate.proof;
  demand(!proof.gap || *proof.gap >= 0, "the gap of the proof is negative");
  demand(proof.found_by_search <= static_cast<int>(proof.solutions.size()),
         "the search found more solutions than there are");
  demand(plan.certificate.max_violation <= context.options.constraint_tolerance,
         "the status is not infeasible, but the violation is large");
  claims.none_wrong("search_record", objections, "optimizer, calls, starts and status fit");
}

}  // namespace

std::vector<std::string> configuration_objections(const Context& context, const Configuration& at,
                                                  const ContactEvent& event,
                                                  const PostureResponse& response) {
  Plan alone;
  alone.configuration = at;
  const Context one{alone, context.problem, context.options, context.motion};
  ClaimList own;
  check_configuration(one, event, response, own);
  check_margins(one, event, response, own);
  std::vector<std::string> out;
  for (const Claim& claim : own.claims()) {
    // The closing speed is stated for the chosen configuration alone.
    if (!claim.pass && claim.name != "closing_speed") out.push_back(claim.name);
  }
  const double off_case = case_residual(context.problem, response, event);
  if (!(off_case <= context.options.constraint_tolerance)) out.push_back("case");
  return out;
}

void check_consistency(const Context& context, ClaimList& claims) {
  check_bounds(context, claims);
  check_list(context, claims);
  check_each_candidate(context, claims);
  check_search(context, claims);
}

}  // namespace stillbase::verification
