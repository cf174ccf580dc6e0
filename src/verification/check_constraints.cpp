// The list of constraints of a plan: values and bounds recomputed for every name that is known.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "verification/clearance.hpp"
#include "verification/known_constraints.hpp"
#include "verification/margins.hpp"

namespace stillbase::verification {
namespace {

/// Tolerances of the list of constraints, in the units of each.
struct ConstraintCheckOptions {
  /// Bounds are copied from the problem; those with a margin or a square are computed.
  double same_bound = 1e-12;
  /// Of a stated violation from that of the stated value: a difference of two stated numbers.
  double same_violation = 1e-12;
};
constexpr ConstraintCheckOptions kConstraints;

double bound_difference(double stated, double wanted) {
  if (stated == wanted) return 0;  // infinities included
  if (!std::isfinite(stated) || !std::isfinite(wanted)) return kInfinity;
  return std::abs(stated - wanted) / (1 + std::abs(wanted));
}

void check_collision(const Context& context, ClaimList& claims) {
  Objections touching;
  const CollisionScene scene(context.problem);
  if (const auto pair = contact_collision(context.problem, scene, context.situation.at)) {
    touching.add(to_string(*pair));
  }
  claims.none_wrong("contact_collision", touching,
                    "bodies that touch at the contact, hand and target at the feature excepted");
}

}  // namespace

void check_constraints(const Context& context, ClaimList& claims) {
  const KnownConstraints known(context.situation);
  Largest violated, inconsistent, different, bounds;
  std::string unknown;
  const auto compare = [&](const std::string& name, double stated, double found, double scale) {
    different.take(std::abs(stated - found) / (std::abs(found) + scale), name);
  };
  std::map<std::string, double> stated;  // squares of the norms of groups
  for (const ConstraintValue& c : context.plan.constraints) {
    const double violation = std::max({c.lower - c.value, c.value - c.upper, 0.0});
    inconsistent.take(std::abs(violation - c.violation), c.name);
    violated.take(violation, c.name);
    const auto wanted = known.find(c.name);
    if (wanted) {
      bounds.take(std::max(bound_difference(c.lower, wanted->lower),
                           bound_difference(c.upper, wanted->upper)),
                  c.name);
    }
    if (wanted && wanted->value) {
      compare(c.name, c.value, *wanted->value, 1);
    } else if (wanted && !wanted->group.empty()) {
      stated[wanted->group] += c.value * c.value;
    } else {
      unknown += " " + c.name;
    }
  }
  for (const auto& [name, squared] : stated) {
    const ConstraintGroup& group = known.group(name);
    compare(name, std::sqrt(squared), group.norm, group.scale);
  }
  claims.at_most(
      "constraint_values", different.value, context.options.recompute_tolerance, "1",
      fmt::format("largest difference of stated and recomputed value: {}; not recomputed:{}",
                  different.place, unknown.empty() ? " none" : unknown));
  claims.at_most("constraint_bounds", bounds.value, kConstraints.same_bound, "1",
                 "stated bounds from those of the problem: " + bounds.place);
  claims.at_most("constraint_violation", violated.value, context.options.constraint_tolerance, "1",
                 "largest violation by the stated values: " + violated.place);
  claims.at_most("constraint_stated_violations", inconsistent.value, kConstraints.same_violation,
                 "1", "stated violations from those of the stated values and bounds");
  check_margins(context.situation, context.options, claims);
  check_collision(context, claims);
}

}  // namespace stillbase::verification
