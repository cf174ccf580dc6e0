// What follows the contact, as plan files and simulations state it.
#include "io/fields/plan.hpp"

#include "io/names.hpp"

namespace stillbase::io {

void after_horizon_fields(Table& t, AfterHorizon& after) {
  t("joint_rate", Number(after.joint_rate, kNonNegative), "norm at the horizon",
    needed("rad/s (m/s)"));
  t("moves", Flag(after.moves),
    "whether a joint would cover more than 1e-3 rad (m) in ten horizons at its rate", kNeeded);
  t("stop_time", OrNull(Number(after.stop_time), !after.stop_time),
    "of the first joint that reaches a stop, after the impact; null: none within ten horizons",
    needed("s"));
  t("joint", Text(after.joint), "that reaches it; empty: none", kNeeded);
}

static void fields(Table& t, LimitUse& use) {
  double margin = use.margin();
  t("limit", Word(use.limit, capture_limit_names()), "", kNeeded);
  t("place", Text(use.place),
    "joint, axis of B, hand link, `contact_time` or `horizon` where most of it is used", kNeeded);
  t("value", Number(use.value, kNonNegative),
    "largest one at `place` from the contact to the horizon; of `wheel_momentum` with the preset, "
    "and also with all of `angular` in the wheels where the controller hands it to them; of joint "
    "stops and the contact window the distance from the middle of the range",
    needed("`unit`"));
  t("most", Number(use.most, kNonNegative), "that is allowed", needed("`unit`"));
  t("margin", Number(margin), "most - value", needed("`unit`"));
  t("unit", Text(use.unit), "of value, most and margin", kNeeded);
  MapReader* map = t.reader();
  if (map == nullptr || !map->context().findings.empty() || margin == use.margin()) return;
  map->refuse("margin", "inconsistent", "is not most - value");
}

static void fields(Table& t, HeldLimit& held) {
  t("limit", Word(held.limit, capture_limit_names()), "", kNeeded);
  t("place", Text(held.place), "joint, axis of B or hand link", kNeeded);
  t("time", Number(held.time, kNonNegative), "with at least 90 % of the limit until the rest",
    needed("s"));
}

void managed_momentum_fields(Table& t, ManagedMomentum& managed) {
  t("angular", Vector(managed.angular), "about the common centroid", needed("N m s", "B"));
  t("linear", Vector(managed.linear), "", needed("N s", "B"));
  t("least_time", OrNull(Number(managed.least_time, kNonNegative), !managed.least_time),
    "max_i |angular_i| / torque_i of the wheels; a lower bound of the time while the base keeps "
    "its "
    "attitude; null: no wheels that could take it",
    needed("s"));
  t("remaining", OrNull(Number(managed.remaining, kNonNegative), !managed.remaining),
    "angular momentum outside the wheels at the horizon; null: not simulated", needed("N m s"));
  t("rest_time", OrNull(Number(managed.rest_time, kNonNegative), !managed.rest_time),
    "after the contact, from which on at most 1 % of the angular momentum is outside the wheels "
    "and joints have at most 1 % of their largest rate, or no more than the sensors' errors; null: "
    "not within the horizon",
    needed("s"));
  t("limits", maps_of(managed.limits),
    "how much of each limit is used from the contact to the horizon, the tightest one first",
    kNeeded);
  HeldLimit held = managed.longest_held.value_or(HeldLimit{});
  t("longest_held",
    Map([&](Table& m) { fields(m, held); },
        {.name = "longest_held", .is_written = managed.longest_held.has_value()}),
    "limit that binds under `detumble`: the load that is near its limit for the longest time; "
    "absent: none comes near, or another controller");
  MapReader* map = t.reader();
  if (map != nullptr && map->has("longest_held")) managed.longest_held = held;
}

}  // namespace stillbase::io
