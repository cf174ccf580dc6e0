// The shapes of robot, obstacles and target at an instant of the approach, in N, by `reference`,
// and bounds on how far they move around it.
#pragma once

#include <string>
#include <vector>

#include <stillbase/collision/scene.hpp>

#include "verification/convex_distance.hpp"
#include "verification/path_motion.hpp"

namespace stillbase::verification {

/// Upper bounds on the motion between an instant and any other of an interval.
struct PathTravel {
  Eigen::VectorXd joints;         ///< n, rad or m
  BaseTrack::Travel base;         ///< in N
  double target_translation = 0;  ///< of T's origin in N, m
  double target_rotation = 0;     ///< rad
};

class MovingShapes {
 public:
  /// @param problem must outlive this object. @param scene knows which pairs may not touch
  MovingShapes(const CaptureProblem& problem, const CollisionScene& scene);

  /// Puts everything where it is at one instant.
  /// @param base T_NB. @param target T_NT, or null: it is not there, nor are its pairs
  void place(const Eigen::VectorXd& phi, const Pose& base, const Pose* target);

  int pair_count() const { return static_cast<int>(pairs_.size()); }
  bool is_present(int pair) const { return has_target_ || !pairs_[pair].is_target; }
  bool is_hand_and_target(int pair) const { return pairs_[pair].is_hand_and_target; }
  /// "link2 with base".
  std::string name(int pair) const;

  /// How far the hand is inside the distance from the contact at which it may touch the target, m;
  /// negative: it may not.
  double hand_room() const;
  /// Bound on the change of hand_room().
  double hand_motion(const PathTravel& travel) const;

  /// Distance of a pair; where it is larger than `enough`, perhaps the lower bound alone.
  DistanceBounds distance(int pair, double enough) const;
  /// Bound on the change of that distance.
  double motion(int pair, const PathTravel& travel) const;

 private:
  struct Shape {
    int body;  ///< kBase, a body, kInertial or kOnTarget
    std::string name;
    Pose pose;  ///< in the axes of what carries it
    const Geometry* geometry;
    Ball ball;             ///< in the shape's frame
    PlacedShape placed;    ///< in N, as the next
    Vector3d centre = {};  ///< of the ball
  };
  struct Pair {
    std::size_t a, b;
    int ancestor;  ///< last body that carries both; kBase also where one is not on the robot
    bool on_robot, is_target, is_hand_and_target;
  };

  int common_ancestor(int a, int b) const;
  double motion_below(int ancestor, int body, const Vector3d& centre, double radius,
                      const Eigen::VectorXd& joints) const;
  double motion_in_N(int body, const Vector3d& centre, double radius,
                     const PathTravel& travel) const;

  const CaptureProblem& problem_;
  std::vector<Shape> shapes_;
  std::vector<Pair> pairs_;
  Vector3d contact_point_ = Vector3d::Zero();  ///< in T
  double contact_radius_ = 0;  ///< of the sphere that is touched where there is no feature, m
  bool has_target_ = false;
  std::vector<Pose> bodies_;  ///< in N, as the next
  Pose base_, target_;
  Vector3d hand_ = Vector3d::Zero();
};

}  // namespace stillbase::verification
