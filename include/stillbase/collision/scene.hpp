// Which bodies may touch: the robot's bodies, the obstacles and the target at one instant.
//
// Pairs of shapes that are checked:
//  - two shapes of the same body never;
//  - shapes of two bodies joined by one joint, unless *both* reach that joint's origin (in the
//    parent at joint position 0) or they overlap wherever the joint stands: those overlap by
//    construction. A link whose shoulder stands off the base's box can swing into it and is
//    checked;
//  - pairs named in allowed_contacts (names of links, obstacles, or "target") never;
//  - obstacles against every body; those fixed to the base not against the base body;
//  - the target against every body and against obstacles fixed to the base. The hand's body may be
//    near the target only while the contact feature is within `contact_allowance` of the hand
//    point; earlier it is a collision. A target without a feature (a point mass with a
//    round shape) is touched at the point of its bounding sphere that is nearest to the hand.
//
// Distances of spheres and capsules from each other and from boxes are exact; other pairs go
// through GJK (FCL): box against box to 1e-6 m, where GJK fails in closed form. Overlapping pairs
// have a distance <= 0 whose size means nothing.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <stillbase/dynamics/kinematics.hpp>
#include <stillbase/plan/problem.hpp>

namespace stillbase {

/// Name of the target's body in messages and in allowed_contacts.
inline constexpr const char* kTargetName = "target";

/// Two bodies and the distance between them, m.
struct Proximity {
  std::string first, second;  ///< link, obstacle or "target"; the one further out comes first
  double distance = 0;
};
/// Where two bodies are closest to each other: a point on each, in B, m.
struct NearestPoints {
  Proximity pair;
  Vector3d on_first, on_second;
};
/// "link2 with base".
std::string to_string(const Proximity& proximity);

/// To what (m) distances of this file are known.
inline constexpr double kDistanceTolerance = 1e-6;

/// Distance (m) below which bodies are too near for an approach: its clearance less
/// kDistanceTolerance. Where a search has a constraint of the same clearance that is active,
/// rounding alone would decide otherwise.
double least_distance(const ApproachSpec& approach);

/// Upper bounds on the motion during an interval, from the instant of the query to either end.
struct SceneTravel {
  JointVectord joints;            ///< n, rad or m
  double base_translation = 0;    ///< of B's origin in N, m
  double base_rotation = 0;       ///< rad
  double target_translation = 0;  ///< of T's origin in N, m
  double target_rotation = 0;     ///< rad
};

enum class SweepVerdict {
  Clear,   ///< every pair keeps the margin during the whole interval: proven
  Unsure,  ///< the margin is kept at the instant; the interval must be split
  Hit      ///< the margin is broken at the instant
};

struct SweepResult {
  SweepVerdict verdict = SweepVerdict::Clear;
  /// The pair that decides, unless Clear. Its distance may be a lower bound unless it is a Hit.
  Proximity closest;
  /// When Unsure: the pairs that are not proven clear, counted as in shape_pairs(), ascending. If
  /// the bounds on the motion hold, no other pair breaks the margin in a part of the interval.
  std::vector<std::size_t> unsure = {};
};

struct SceneOptions {
  double reaches_joint = 1e-6;  ///< m from a joint's origin: a shape this close reaches it
  /// m, bound on the stroke of a prismatic joint without limits. Only motion bounds use it: a large
  /// one makes the sweep split more intervals and changes no verdict.
  double unlimited_stroke = 1e3;
  /// Positions of a joint's range at which its two shapes must overlap to count as overlapping
  /// wherever the joint stands.
  int overlap_positions = 64;
};

/// Bounds on the motion of a body's points: by the triangle inequality along the chain.
struct MotionBound {
  JointVectord lever;  ///< m of motion in B per rad (m) of each joint, 0 for those not in the chain
  double base_reach = 0;  ///< no point is ever further from B's origin, m
};
/// @param reach largest distance of a point from the origin of `body`, m
MotionBound motion_bound(const RobotModel& robot, int body, double reach,
                         const SceneOptions& options = {});

/// What a scene is made of beside the robot.
struct SceneParts {
  std::vector<std::pair<std::string, std::string>> allowed_contacts;
  std::vector<Obstacle> obstacles;
  std::optional<TargetBody> target;
  std::optional<ContactFeature> feature;  ///< where the hand touches the target
  double contact_allowance = 0;           ///< m
  SceneOptions options = {};
};

/// Immutable; copies are cheap and share their shapes. Any number of threads may query at once.
class CollisionScene {
 public:
  /// @throws std::invalid_argument for shapes or poses that are not finite and positive
  CollisionScene(const RobotModel& robot, const SceneParts& parts);

  /// The scene of a problem: its obstacles, allowed contacts, target and chosen feature.
  /// @throws std::invalid_argument also when the target has no feature of the name asked for
  explicit CollisionScene(const CaptureProblem& problem);

  /// First pair, in a fixed order, that is closer than `margin` or overlaps.
  /// @param kinematics posture, in B
  /// @param base T_NB; matters for obstacles in N and the target alone
  /// @param target T_NT, or null: the target is elsewhere
  /// @throws std::invalid_argument for poses that are not finite
  std::optional<Proximity> first_hit(const Kinematics<double>& kinematics, const Pose& base,
                                     const Pose* target, double margin = 0) const;

  /// first_hit() with the target at the first of several poses where there is one.
  /// @param count of poses
  /// @param target T_NT at the i-th; not asked for behind a hit
  std::optional<Proximity> first_hit_of_each(const Kinematics<double>& kinematics, const Pose& base,
                                             int count, const std::function<Pose(int)>& target,
                                             double margin = 0) const;

  /// The closest pair among those that may not touch. Empty when there is no such pair.
  /// @param with_hand_and_target false: leave out the hand's body against the target, which touch
  /// at
  ///   the contact (their distance just outside contact_allowance says nothing about the path)
  /// @param below m; pairs that are no closer are left out
  std::optional<Proximity> nearest(const Kinematics<double>& kinematics, const Pose& base,
                                   const Pose* target, bool with_hand_and_target = true,
                                   double below = std::numeric_limits<double>::infinity()) const;

  /// The points of nearest(). Empty also when its bodies overlap.
  std::optional<NearestPoints> nearest_points(const Kinematics<double>& kinematics,
                                              const Pose& base, const Pose* target,
                                              bool with_hand_and_target = true) const;

  /// Distances at one instant and bounds on the motion of each pair give a verdict for an interval.
  /// @param among the pairs to look at: what the sweep of a longer interval left unsure; null: all
  SweepResult sweep(const Kinematics<double>& kinematics, const Pose& base, const Pose* target,
                    const SceneTravel& travel, double margin,
                    const std::vector<std::size_t>* among = nullptr) const;

  /// sweep() with the target at one pose after the other: the worst verdict, the pairs that are
  /// unsure beside any of them, `closest` beside the last one with that verdict.
  SweepResult sweep_each(const Kinematics<double>& kinematics, const Pose& base,
                         const std::vector<Pose>& targets, const SceneTravel& travel, double margin,
                         const std::vector<std::size_t>* among = nullptr) const;

  /// The same scene reduced to the pairs that the target is part of.
  CollisionScene target_pairs_only() const;

  /// Number of pairs that are checked.
  int pair_count() const;

  /// The pairs that are checked. Shapes are counted from 0: those of the robot, then the obstacles,
  /// then those of the target, each in the order in which they were given.
  struct ShapePair {
    std::size_t first, second;
  };
  std::vector<ShapePair> shape_pairs() const;

  struct Data;  ///< private to src/collision

 private:
  std::shared_ptr<const Data> data_;
};

}  // namespace stillbase
