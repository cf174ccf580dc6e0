// Margins that a problem may demand at the contact, by `reference`: joint rates, singular values,
// distances of shapes. Written apart from the planner's own.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "verification/checks.hpp"

namespace stillbase::verification {

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
    int body;  ///< kBase, a body, or kOnTarget
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

/// The closest of the shapes that must be apart.
struct ClosestShapes {
  std::optional<double> distance;  ///< m; empty: no two have to be apart
  std::string pair;
};
ClosestShapes closest_shapes(const Situation& situation);

/// Whether the problem demands a margin: a limit with a check of its own, or a clearance.
bool demands_margins(const CaptureProblem& problem);

/// The least distance from the limits of all margins, each in its own unit; infinite without any.
/// Neighbours in the tree that are apart in the start posture count as well: a planner may demand
/// clearance of those.
double least_margin(const Situation& situation);

/// One check for each margin that the problem demands.
void check_margins(const Situation& situation, const VerifyOptions& options, ClaimList& claims);

}  // namespace stillbase::verification
