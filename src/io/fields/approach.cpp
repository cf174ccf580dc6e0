// The section `approach`.
#include <fmt/format.h>

#include <stillbase/approach/approach.hpp>

#include "io/fields/sections.hpp"

namespace stillbase::io {

namespace {

void check_approach(MapReader& map, const CaptureProblem& problem) {
  const ApproachSpec& approach = problem.approach;
  const VariableSpec& variables = problem.variables;
  if (approach.base == BaseMode::ReactionNull) {
    // Plans state the default beside every base mode.
    if (approach.planner != ApproachSpec{}.planner) {
      map.refuse("planner", "not-used",
                 "paths within the reaction null space are found without it");
    }
    if (!approach.station_free) {
      map.refuse("station_free", "not-supported",
                 "false needs base: held or floating; a base whose attitude is kept must be free "
                 "to start where the arm's motion asks");
    }
    if (approach.polish != PathPolish::None) {
      map.refuse("polish", "not-supported",
                 "paths within the reaction null space are not polished");
    }
    if (approach.effort != ApproachEffort::First) {
      map.refuse("effort", "not-supported",
                 "best: within the reaction null space the path decides on the posture; must be "
                 "first");
    }
  } else if (approach.enabled && !approach.station_free &&
             (variables.base_attitude != AttitudeFreedom::Fixed ||
              variables.base_position != PositionFreedom::Fixed)) {
    map.refuse("station_free", "contradiction",
               "false: the base starts as stated, and its pose at the contact follows from the "
               "path (held: it stays); base_attitude and base_position must be fixed");
  }
}

}  // namespace

void approach_fields(Table& t, CaptureProblem& problem) {
  ApproachSpec& approach = problem.approach;
  t("enabled", Flag(approach.enabled), "plan a path to the configuration");
  t("base", Word(approach.base, kBaseModeNames),
    "`held` (actively), `floating` (it moves with the arm) or `reaction-null` (floating, the "
    "joints moving so that the attitude stays)");
  t("station_free", Flag(approach.station_free),
    "the start pose follows from the path's net motion; false: the base starts as stated, and its "
    "pose at the contact follows from the path (held: it stays), so base attitude and position "
    "must be fixed");
  // rad/s^2, m/s^2: a second to reach the few degrees per second at which space arms move.
  constexpr double kDefaultAcceleration = 0.1;
  t("acceleration_limit",
    JointValues(approach.acceleration_limit, problem.robot, kJointAcceleration, kAcceleration,
                {.without = kDefaultAcceleration}),
    "largest joint acceleration", {.without = fmt::format("{}", kDefaultAcceleration)});
  t("velocity_scale", Number(approach.velocity_scale, kUsedPart),
    "used part of the URDF's joint rates");
  t("wait", Number(approach.wait, Dimension::Time, kWait), "at rest before the contact");
  t("max_duration", Number(approach.max_duration, Dimension::Time, kApproachDuration),
    "from start to contact");
  t("clearance", Number(approach.clearance, Dimension::Length, kDistance), "kept between bodies");
  t("contact_allowance", Number(approach.contact_allowance, Dimension::Length, kDistance),
    "the hand's body may be near the target once the feature is this close to the hand");
  t("resolution", Number(approach.resolution, Dimension::Angle, {.lower = 1e-4, .upper = 1}),
    "between checked postures");
  t("planner", Text(approach.planner, approach_planner_names(), "planners"),
    "`rrt_connect`, `rrt_star`, `prm_star`, `bit_star`, `ait_star`, `kpiece`; not used with "
    "`reaction-null`");
  t("max_iterations", Integer(approach.max_iterations, 1, kManyTimes), "of the planner");
  t("polish", Word(approach.polish, kPathPolishNames),
    "reduce the largest attitude change of the base along the path (`attitude`) or the time of "
    "motion (`time`) by Ipopt, or `none`; not with `reaction-null`");
  t("attitude_tolerance",
    Number(approach.attitude_tolerance, Dimension::Angle, {.lower = 1e-6, .upper = 1}),
    "`reaction-null`: largest attitude change of the base");
  t("goal_factor", Number(approach.goal_factor, {.lower = 1, .upper = 1e6}),
    "candidates up to this factor of the best one's objective are goals of the path together");
  t("goal_samples", Integer(approach.goal_samples, 0, 10'000),
    "tries for further goals, as good, on the self-motion at the contact");
  t("max_approaches", Integer(approach.max_approaches, 1, 10'000),
    "candidates that are tried one by one where no good one is reached");
  t("effort", Word(approach.effort, kApproachEffortNames),
    "`first`: the first path that was found stands; `best`: it goes on to the better candidates, "
    "best first, while time is left");
  t("abort", WrittenIf(Flag(approach.abort), !approach.abort),
    "with a `contact.hand_velocity`: plan a path on which the robot stops, away from the target, "
    "if the grasp does not close",
    {.without = fmt::format("{}", ApproachSpec{}.abort)});
  if (t.reader() != nullptr) check_approach(*t.reader(), problem);
}

void fields(Table& t, Obstacle& obstacle) {
  t("name", Text(obstacle.name), "name", kNeeded);
  t("frame", Word(obstacle.frame, kFrameNames), "`inertial` or `base`");
  pose_fields(t, obstacle.pose, "the obstacle", "frame", kPlace);
  t("geometry", geometry_of(obstacle.geometry), "geometry, in m", kNeeded);
}

}  // namespace stillbase::io
