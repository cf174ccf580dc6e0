// The approach path of a plan, as its file states it.
#include "io/fields/plan.hpp"

#include <cmath>

namespace stillbase::io {

namespace {

/// A list of vectors of one size.
template <class V>
List<V> vectors(std::vector<V>& list, int size) {
  return List<V>(
      list, [size](V& v) { return Numbers(v, size); }, {}, V::Zero(size));
}

/// A least distance; none where nothing is near.
Value clearance_of(double& distance) {
  return OrNull(Number(distance), std::isinf(distance), [&distance] { distance = kInfinity; });
}

void abort_fields(Table& t, const CaptureProblem& problem, AbortPath& abort) {
  const int n = problem.robot.n();
  t("times", Numbers(abort.times), "of the samples; the first one is the contact time",
    needed("s"));
  t("joint_positions", vectors(abort.joint_positions, n), "per sample", kPerJoint);
  t("joint_velocities", vectors(abort.joint_velocities, n), "zero at the last sample",
    needed("rad/s (m/s)"));
  t("base_poses", List(abort.base_poses, [](Pose& pose) { return written_pose(pose); }),
    "poses of B", needed("m", "N"));
  t("retreat", Number(abort.retreat, kNonNegative), "along the normal, as asked for", needed("m"));
  t("min_clearance", clearance_of(abort.min_clearance),
    "minimum distance among pairs that may not touch, hand and target left out; null: nothing near",
    needed("m"));
  t("effort_used", Number(abort.effort_used, kNonNegative),
    "largest part of a joint's torque limit", kNeeded);
}

}  // namespace

void approach_result_fields(Table& t, const CaptureProblem& problem, Approach& approach) {
  const int n = problem.robot.n();
  t("status", Word(approach.status, approach_status_names()), "`found`, or which kind of failure",
    kNeeded);
  t("detail", Text(approach.detail), "what failed, by how much, in words", kNeeded);
  t("times", Numbers(approach.times), "of the samples; the last one is the contact time",
    needed("s"));
  t("joint_positions", vectors(approach.joint_positions, n), "per sample", kPerJoint);
  t("joint_velocities", vectors(approach.joint_velocities, n), "per sample", needed("rad/s (m/s)"));
  t("joint_accelerations", vectors(approach.joint_accelerations, n),
    "at the begin of the segment after each sample; zero at the last one",
    needed("rad/s^2 (m/s^2)"));
  t("joint_torques", vectors(approach.joint_torques, n),
    "at the same instants, by the dynamics of the robot without friction", needed("N m (N)"));
  t("base_poses", List(approach.base_poses, [](Pose& pose) { return written_pose(pose); }),
    "poses of B", needed("m", "N"));
  t("base_velocities", vectors(approach.base_velocities, 6), "linear, then angular",
    needed("m/s, rad/s", "B"));
  t("duration", Number(approach.duration), "of the motion, without the wait", needed("s"));
  t("path_length", Number(approach.path_length), "in joint space", needed("rad"));
  t("attitude_excursion", Number(approach.attitude_excursion),
    "largest rotation angle of the base from its final attitude", needed("rad"));
  t("min_clearance", clearance_of(approach.min_clearance),
    "minimum distance among pairs that may not touch, hand and target left out; null: nothing near",
    needed("m"));
  t("effort_used", Number(approach.effort_used, kNonNegative),
    "largest part of a joint's torque limit", kNeeded);
  t("hand_error", Map([&](Table& m) {
      m("position", Number(approach.hand_position_error, kNonNegative), "distance from its place",
        needed("m"));
      m("angle", Number(approach.hand_angle_error, kNonNegative), "of its axes", needed("rad"));
    }),
    "of the hand at the end of the path", kNeeded);
  t("late_by", Number(approach.late_by, kNonNegative),
    "status `too_slow`: by which the path takes longer than there is time", needed("s"));
  t("polish", Map([&](Table& m) {
      m("quantity", Word(approach.polish, kPathPolishNames),
        "what was reduced: `none`, `attitude` or `time`", kNeeded);
      m("before", Number(approach.before_polish, kNonNegative), "of the planner's path",
        needed("rad or s"));
      m("after", Number(approach.after_polish, kNonNegative), "of the path as it is",
        needed("rad or s"));
    }),
    "reduction by the polish, of the path to rest: a hand that moves runs to the contact from "
    "there",
    kNeeded);
  AbortPath abort = approach.abort.value_or(AbortPath{});
  t("abort",
    Map([&](Table& m) { abort_fields(m, problem, abort); },
        {.is_written = approach.abort.has_value()}),
    "path to rest if the grasp of a hand that moves does not close",
    {.without = "none was asked for"});
  MapReader* map = t.reader();
  if (map != nullptr && map->has("abort")) approach.abort = abort;
  if (map == nullptr || !map->context().findings.empty()) return;
  if (abort.joint_positions.size() != abort.times.size() ||
      abort.joint_velocities.size() != abort.times.size() ||
      abort.base_poses.size() != abort.times.size()) {
    map->context().add(map->line(), "wrong-length",
                       "approach.abort: times, joint_positions, joint_velocities and base_poses "
                       "must have the same number of samples");
  }
  const std::size_t samples = approach.times.size();
  if (approach.joint_positions.size() != samples || approach.joint_velocities.size() != samples ||
      approach.joint_accelerations.size() != samples || approach.joint_torques.size() != samples ||
      approach.base_poses.size() != samples || approach.base_velocities.size() != samples) {
    map->context().add(
        map->line(), "wrong-length",
        "approach: times, joint_positions, joint_velocities, joint_accelerations, "
        "joint_torques, base_poses and base_velocities must have the same number of samples");
  }
}

}  // namespace stillbase::io
