// The approach: the robot moves from its start posture to the chosen configuration, is at rest
// there in time, and waits for the target.
//
// Assumptions. The robot is at rest with zero momentum before the approach and while it waits.
// Base `held`: the base pose is that of the configuration throughout. Base `floating` with a free
// station: Omega = -H_b^-1 H_bphi phidot along the path; the net motion g(path) of the base does
// not depend on where it starts, so the start pose is goal.base * g(path)^-1. With a stated start
// the base ends where the path leaves it, and the posture at the contact must fit that pose:
// posture and path are planned together. Base `reaction-null`: as floating with a free station, and
// the joints move in the reaction null space of (9) all along. Between the stored samples the
// joints follow cubic Hermite segments; limits, clearances and base poses hold for those segments,
// not only at the samples. Joints that the search may not change, and that already have their final
// value, stay still. Continuous joints end at the configuration's angle; the start angle is
// problem.start plus the whole turns that make the path shortest.
//
// A hand that moves at the contact (CaptureProblem::hand_motion, base floating): the approach leads
// to the posture from which a last run, evenly accelerated, arrives at the contact with the joint
// rates that the contact asks for; the robot waits before that run. Approach::abort is the path to
// rest if the grasp does not close.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <stillbase/approach/options.hpp>
#include <stillbase/core/interrupt.hpp>
#include <stillbase/plan/plan.hpp>
#include <stillbase/target/target.hpp>

namespace stillbase {

enum class ContactSolve {
  Best,    ///< the best posture near the one of the closest pose asked for before
  Nearest  ///< the posture nearest to the last best one; depends smoothly on the pose
};

/// Solves the contact when path and configuration depend on each other. Nothing is returned when
/// there is no solution nearby.
struct ContactSolver {
  /// Posture and contact time with the base at this pose (T_NB) at the contact: for a floating base
  /// with a stated start.
  std::function<std::optional<Configuration>(const Pose& base, ContactSolve how)> at_base;
  /// A configuration near a posture (n), the nearest one that solves the contact or the best one
  /// nearby: for paths within the reaction null space, which reach few postures easily.
  std::function<std::optional<Configuration>(const JointVectord& phi, ContactSolve how)>
      near_posture;
  /// The problem's objective at a configuration that near_posture returned; smaller is better.
  std::function<double(const Configuration&)> measure;
};

/// Plans the approach to a configuration: OMPL path against FCL distances, simplification, corners
/// rounded, time law within rate and acceleration limits, then robot(t) against target(t) along the
/// whole motion and the wait. The motion is checked as it is stored. After a collision another path
/// is planned, a bounded number of times (other random stream, the target's poses during the motion
/// as further obstacles, a finer grid, a longer wait).
///
/// @param goal posture and base pose at the contact, and the contact time
/// @param target predicted motion, or null: nothing but robot and obstacles. Where the impulse has
/// a
///   stated direction, the motion that brings the target to the hand at the contact time.
/// @param seed of all random choices; same seed, same bytes
/// @param stop asked during planning; reached: TimeOut
/// @param solver_calls counts the planner's runs under its name
/// @param contact at_base is needed for a floating base with a stated start; near_posture and
///   measure are used for `reaction-null` where given. The configuration at the contact then is
///   that of the last sample, and `goal` is where the search begins
/// @return status Found with every field set, or what failed with `detail` in words:
///   NotRequested (approach switched off), StartInvalid, GoalInvalid (limits or bodies closer than
///   the clearance), GoalUnreachable (no path found), UnreachableInBaseMode (no path keeps the
///   base's attitude), HitEarly (who, whom, when), TimeOut, TooSlow (by how many seconds),
///   BaseDriftOpen (no path ends at a contact that fits where it leaves the base; by how much).
/// @throws std::invalid_argument for sizes that do not fit, numbers that are not finite, limits
/// that
///   are not positive, or an unknown planner
[[nodiscard]] Approach plan_approach(const CaptureProblem& problem, const Configuration& goal,
                                     const TargetMotion* target, std::uint64_t seed,
                                     const StopCondition& stop,
                                     std::map<std::string, long>& solver_calls,
                                     const ContactSolver& contact = {},
                                     const ApproachOptions& options = {});

/// A configuration that an approach may lead to, one of several.
struct ApproachGoal {
  Configuration configuration;
  const TargetMotion* target = nullptr;  ///< as for plan_approach
  /// > 0: how often the planner samples towards this goal, relative to the others.
  double weight = 1;
  ContactSolver contact;  ///< as for plan_approach
};

struct ApproachToAny {
  Approach approach;
  std::size_t goal = 0;  ///< index of the goal that it leads to, or of the last one tried
  /// Of a failure, for each goal: attempts that count for ApproachOptions::base_hits.
  std::vector<int> base_hits = {};
};

/// Plans the approach to any of several configurations, the best one first. A short run of the
/// planner goes for the best one, another for all of them, each with its own poses of base and
/// target (not `reaction-null`, which goes for all at once). The first goal that a feasible
/// motion reaches is taken; a goal that two infeasible motions reached is left out. Not for a
/// floating base with a stated start.
///
/// @param goals at least one; those that plan_approach() refuses before planning are skipped
/// @return as plan_approach; the status of a failure is that of the attempt that came closest
/// @throws std::invalid_argument as plan_approach, and for weights that are not positive
[[nodiscard]] ApproachToAny plan_approach_to_any(const CaptureProblem& problem,
                                                 const std::vector<ApproachGoal>& goals,
                                                 std::uint64_t seed, const StopCondition& stop,
                                                 std::map<std::string, long>& solver_calls,
                                                 const ApproachOptions& options = {});

/// Names accepted in ApproachSpec::planner.
std::vector<std::string> approach_planner_names();

}  // namespace stillbase
