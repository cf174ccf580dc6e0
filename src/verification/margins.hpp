// Margins that a problem may demand at the contact, by `reference`: joint rates, singular values,
// distances of shapes. Written apart from the planner's own.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "verification/checks.hpp"

namespace stillbase::verification {

/// Limit of a joint's rate right after the impact; infinite without one.
double joint_rate_limit(const CaptureProblem& problem, int joint);

/// Smallest singular value of the coupling matrix that is not zero by rank, kg m^2.
double coupling_singular_value(const PostureResponse& response);

/// The same of Jhat_phi, its angular rows times a length, m.
double jacobian_singular_value(const PostureResponse& response, double length);

/// The shapes of robot, obstacles and target at the contact, numbered from 1 in this order.
class ContactShapes {
 public:
  /// @param target T_NT, or null
  ContactShapes(const CaptureProblem& problem, const Configuration& at, const Pose* target);

  /// Signed distance of two shapes, m: by a search along the segment of a sphere or capsule or of
  /// an edge of a box; of boxes that overlap, and of those about cylinders, the widest gap along a
  /// separating axis; of a cylinder the larger of those of the capsule and the box about it. Empty
  /// for numbers out of range and for shapes that no constraint is about. Where the distance of
  /// the spheres about the shapes is above `enough`: that one, which is no larger.
  std::optional<double> distance(int i, int j, double enough = kInfinity) const;
  /// Of every corner of a box of the base and one of the target from the other one, and of each
  /// edge of one from each of the other, m: 16 and 144, all at least the distance of the boxes,
  /// smooth, and infinite for edges that do not pass each other; none of other shapes.
  /// @pre i < j
  std::vector<double> feature_distances(int i, int j) const;
  /// Whether a clearance applies to these two. Neighbours in the tree are left out: some of them
  /// overlap by construction.
  bool must_be_apart(int i, int j) const;
  /// Whether they are of a body and its parent in the tree.
  bool are_neighbours(int i, int j) const;
  int count() const { return static_cast<int>(shapes_.size()); }
  const std::string& name(int i) const { return shape(i).name; }

 private:
  struct Shape {
    int body;  ///< kBase, a body, or kTarget
    std::string name;
    bool is_obstacle = false;
    Pose pose;  ///< in B
    const Geometry* geometry;
  };
  const Shape& shape(int i) const { return shapes_[static_cast<std::size_t>(i - 1)]; }

  const CaptureProblem& problem_;
  std::vector<Shape> shapes_;
};

/// The two numbers in clearance_<i>_<j>_<names>; empty for another name.
std::optional<std::pair<int, int>> clearance_numbers(const std::string& name);

/// The margins of the problem at one configuration.
struct MarginNumbers {
  double rate_excess = -kInfinity;  ///< largest |rate| less its limit, rad/s (m/s)
  std::string fastest;              ///< that joint
  std::optional<double> coupling, jacobian;
  std::optional<double> distance;  ///< smallest of pairs that must be apart, m
  std::string nearest;             ///< that pair
};
MarginNumbers margin_numbers(const Situation& situation);

/// The smallest distance of neighbours in the tree that are apart in the start posture, m: a
/// planner may demand clearance of those as well. Infinite without any.
double neighbours_distance(const CaptureProblem& problem, const Configuration& at);

/// One check for each margin that the problem demands.
void check_margins(const Situation& situation, const VerifyOptions& options, ClaimList& claims);

}  // namespace stillbase::verification
