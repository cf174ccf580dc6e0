// Are the limits that a plan says to decide its value reached, all of them listed, and what is each
// worth?
#include "audit/binding.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "audit/tolerances.hpp"
#include "verification/known_constraints.hpp"

namespace stillbase::audit {

using namespace verification;

namespace {

/// Tolerances of the list of limits.
struct BindingOptions {
  double same_multiplier = 0.01;  ///< relative, beside the error of the differences
  double largest_error = 0.3;     ///< relative: with a larger one nothing is said of a multiplier
  double same_limit = 1e-9;       ///< relative to 1 + the limit: two codes copy or square it
  /// Of the value, per unit of a limit: twice the multiplier from which a plan lists a limit.
  double least_listed = 2e-6;
  double zero = 1e-6;  ///< of the typical objective: a smaller one falls no further
};
constexpr BindingOptions kBinding;

std::string end_of(const std::string& name, bool is_upper) {
  return name + (is_upper ? " upper" : " lower");
}

bool is_same(const ReachedLimit& one, const BindingLimit& other) {
  return one.limit.name == other.name && one.limit.is_upper == other.is_upper;
}

/// A constraint of the user, of which a plan file has no function.
bool is_of_user(const Context& context, const std::string& name) {
  const auto& list = context.plan.constraints;
  return std::any_of(list.begin(), list.end(),
                     [&](const ConstraintValue& c) { return c.name == name; }) &&
         !KnownConstraints(context.situation).find(name);
}

/// Distance from a limit in the limit's unit: of several distances the least.
double distance_from_limit(const Situation& at, const BindingLimit& stated) {
  std::vector<NamedLimit> limits;
  const std::vector<double> distances = distances_from_limits(at, &limits);
  double least = kInfinity;
  for (std::size_t i = 0; i < limits.size(); ++i) {
    if (limits[i].name != stated.name || limits[i].is_upper != stated.is_upper) continue;
    least = std::min(least, distances[i]);
  }
  return least;
}

/// Name, end, unit and numbers of one entry but for its multiplier.
void demand_entry(const Context& context, const BindingLimit& stated, const NamedLimit& limit,
                  Objections& objections) {
  const std::string name = end_of(stated.name, stated.is_upper);
  const double same = kBinding.same_limit * (1 + std::abs(limit.value));
  objections.demand(
      std::abs(stated.value - limit.value) <= same,
      fmt::format("{} is stated at {:.9g}, not {:.9g}", name, stated.value, limit.value));
  objections.demand(stated.unit == limit.unit, name + " is in " + limit.unit);
  const double margin = distance_from_limit(context.situation, stated);
  objections.demand(std::abs(stated.margin - margin) <= same,
                    fmt::format("{} is {:.3g} away, not {:.3g}", name, margin, stated.margin));
  objections.demand(stated.multiplier > 0, name + " decides nothing");
}

}  // namespace

std::vector<ReachedLimit> limits_at(const CaptureProblem& problem, const Configuration& at) {
  const Situation here(problem, at);
  std::vector<NamedLimit> limits;
  const std::vector<double> distances = distances_from_limits(here, &limits);
  std::vector<ReachedLimit> out;
  for (std::size_t i = 0; i < limits.size(); ++i) {
    if (!(std::abs(distances[i]) <= kRecord.reached)) continue;
    const auto is_there = [&](const ReachedLimit& other) {
      return other.limit.name == limits[i].name && other.limit.is_upper == limits[i].is_upper;
    };
    if (std::none_of(out.begin(), out.end(), is_there)) out.push_back({limits[i]});
  }
  return out;
}

void check_binding(const Context& context, const std::vector<ReachedLimit>& reached,
                   const std::string& objection, ClaimList& claims) {
  const Plan& plan = context.plan;
  const std::vector<BindingLimit>& list = plan.binding;
  if (list.empty() && reached.empty()) return;
  const double exponent = objective_power(context.problem).exponent;
  const double relative_slope = plan.objective.value * exponent / 2;
  const bool are_known = objection.empty();
  Objections objections;
  std::vector<std::string> open;  // names
  double worst = 0;
  int compared = 0;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const BindingLimit& stated = list[i];
    const std::string name = end_of(stated.name, stated.is_upper);
    if (is_of_user(context, stated.name)) {
      open.push_back(name);
      continue;
    }
    const auto found = std::find_if(reached.begin(), reached.end(),
                                    [&](const ReachedLimit& r) { return is_same(r, stated); });
    if (found == reached.end()) {
      objections.add(name + " is not reached, or no limit");
      continue;
    }
    demand_entry(context, stated, found->limit, objections);
    const auto repeats = [&](const BindingLimit& other) { return is_same(*found, other); };
    objections.demand(std::count_if(list.begin(), list.end(), repeats) == 1, name + " is repeated");
    objections.demand(i == 0 || stated.multiplier <= list[i - 1].multiplier,
                      name + " saves more than the one before it");
    if (!are_known || !found->is_known ||
        found->error > kBinding.largest_error * found->multiplier) {
      open.push_back(name);
      continue;
    }
    ++compared;
    const double multiplier = found->multiplier * relative_slope;
    const double same = kBinding.same_multiplier * multiplier + found->error * relative_slope;
    worst = std::max(worst, std::abs(stated.multiplier - multiplier) / std::max(same, 1e-300));
  }
  // Zero falls no further.
  const bool is_zero = std::pow(plan.objective.value, 1 / exponent) <=
                       kBinding.zero * typical_objective(context.problem);
  const bool is_minimum = plan.certificate.kkt_residual <= kRecord.stationary;
  objections.demand(is_minimum || list.empty(), "limits of a configuration that is no minimum");
  std::vector<std::string> perhaps;  // likewise
  for (const ReachedLimit& limit : reached) {
    const auto is_stated = [&](const BindingLimit& other) { return is_same(limit, other); };
    if (!is_minimum || is_zero || std::any_of(list.begin(), list.end(), is_stated)) continue;
    const std::string name = end_of(limit.limit.name, limit.limit.is_upper);
    const double multiplier = limit.multiplier * relative_slope;
    const double least = kBinding.least_listed * plan.objective.value;
    if (!are_known || (!limit.is_known && multiplier > least)) {
      perhaps.push_back(name);
    } else if (multiplier > least) {
      const bool is_certain = multiplier > least + 2 * limit.error * relative_slope;
      if (!is_certain) perhaps.push_back(name);
      objections.demand(!is_certain,
                        fmt::format("{} is reached, with a multiplier of {:.3g}, and not stated",
                                    name, multiplier));
    }
  }
  claims.none_wrong("binding_limits", objections, "limits that the plan states to be reached");
  if (compared > 0) {
    claims.at_most("binding_multipliers", worst, 1, "1",
                   fmt::format("of {} limits by differences: the largest difference over 1 % and "
                               "the error of the differences",
                               compared));
  }
  if (open.empty() && perhaps.empty()) return;
  std::string text =
      are_known
          ? "the gradients of the limits depend on each other, or are too small for differences"
          : objection;
  if (!open.empty()) text += fmt::format("; multipliers of {}", fmt::join(open, ", "));
  if (!perhaps.empty()) {
    text +=
        fmt::format("; whether limits are left out that are reached: {}", fmt::join(perhaps, ", "));
  }
  claims.not_verified(are_known ? "binding_undecided" : "binding_multipliers", text);
}

}  // namespace stillbase::audit
