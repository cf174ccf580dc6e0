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
  t("limit", Word(use.limit, capture_limit_names()),
    "`reach`, `joint_rate`, `joint_torque`, `joint_stop`, `grip_force`, `grip_moment`, "
    "`wheel_torque`, `wheel_momentum` or `time_window`",
    kNeeded);
  t("place", Text(use.place),
    "joint, axis of B, hand link, `contact_time` or `horizon` where most of it is used", kNeeded);
  t("value", Number(use.value, kNonNegative),
    "largest one at `place` from the contact to the horizon; of `wheel_momentum` with the preset, "
    "and also with all of `angular` in the wheels where `rns_handback` or `detumble` comes first "
    "and there are no thrusters; of joint stops and the contact window the distance from the "
    "middle of the range",
    needed("`unit`"));
  t("most", Number(use.most, kNonNegative), "that is allowed", needed("`unit`"));
  t("margin", Number(margin), "most - value; negative: the limit is exceeded", needed("`unit`"));
  t("unit", Text(use.unit), "of value, most and margin", kNeeded);
  MapReader* map = t.reader();
  if (map == nullptr || !map->context().findings.empty() || margin == use.margin()) return;
  map->refuse("margin", "inconsistent", "is not most - value");
}

static void fields(Table& t, HeldLimit& held) {
  t("limit", Word(held.limit, capture_limit_names()),
    "`joint_rate`, `joint_torque`, `grip_force`, `grip_moment` or `wheel_torque`", kNeeded);
  t("place", Text(held.place), "joint, axis of B or hand link", kNeeded);
  t("time", Number(held.time, kNonNegative),
    "with at least 90 % of the limit, until `rest_time` or the horizon", needed("s"));
}

void managed_momentum_fields(Table& t, ManagedMomentum& managed) {
  t("angular", Vector(managed.angular),
    "about the common centroid: of robot and target after a latch, else of the robot",
    needed("N m s", "B"));
  t("linear", Vector(managed.linear), "the same; no wheel takes it", needed("N s", "B"));
  t("least_time", OrNull(Number(managed.least_time, kNonNegative), !managed.least_time),
    "largest |angular_i| / torque_i of the wheels; a lower bound of the time while the base keeps "
    "its attitude: a base that turns brings it to other axes; null: no wheels that could take it",
    needed("s"));
  t("remaining", OrNull(Number(managed.remaining, kNonNegative), !managed.remaining),
    "angular momentum outside the wheels at the horizon under the first controller; null: not "
    "simulated",
    needed("N m s"));
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
    Map([&](Table& m) { fields(m, held); }, {.is_written = managed.longest_held.has_value()}),
    "under `detumble` the load that is near its limit for the longest time; for at least half of "
    "it the limit binds, a wheel's torque only near `least_time`",
    {.without = "none comes near, or another controller"});
  MapReader* map = t.reader();
  if (map != nullptr && map->has("longest_held")) managed.longest_held = held;
}

}  // namespace stillbase::io
