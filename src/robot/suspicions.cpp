#include <stillbase/robot/suspicions.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/linear_algebra.hpp>

namespace stillbase {

namespace {

/// What is known of a body's extent: points of it, in its own frame.
struct Extent {
  std::vector<Vector3d> points;
  bool has_shape = false;

  /// Largest distance of a point of the body from `from`, m.
  double reach(const Vector3d& from) const {
    double largest = 0;
    for (const Vector3d& p : points) largest = std::max(largest, (p - from).norm());
    return largest;
  }
  /// Edges of the box along the body's axes that holds the points, rising, m.
  Vector3d edges() const {
    Vector3d lower = points.front(), upper = points.front();
    for (const Vector3d& p : points) {
      lower = lower.cwiseMin(p);
      upper = upper.cwiseMax(p);
    }
    Vector3d size = upper - lower;
    std::sort(size.begin(), size.end());
    return size;
  }
};

Vector3d half_size(const Geometry& geometry) {
  if (const auto* sphere = std::get_if<Sphere>(&geometry)) {
    return Vector3d::Constant(sphere->radius);
  }
  if (const auto* capsule = std::get_if<Capsule>(&geometry)) {
    return {capsule->radius, capsule->radius, capsule->length / 2 + capsule->radius};
  }
  if (const auto* cylinder = std::get_if<Cylinder>(&geometry)) {
    return {cylinder->radius, cylinder->radius, cylinder->length / 2};
  }
  if (const auto* box = std::get_if<Box>(&geometry)) return box->size / 2;
  Vector3d half = Vector3d::Zero();
  for (const Vector3d& v : std::get<ConvexMesh>(geometry).vertices)
    half = half.cwiseMax(v.cwiseAbs());
  return half;
}

Extent extent_of(const RobotModel& robot, int body) {
  Extent extent;
  if (body != kBase) extent.points.push_back(Vector3d::Zero());
  for (const Joint& joint : robot.tree()) {
    if (joint.parent == body) extent.points.push_back(joint.p);
  }
  if (robot.hand_body == body) extent.points.push_back(robot.p_hand);
  for (const CollisionShape& shape : robot.shapes) {
    if (shape.body != body) continue;
    extent.has_shape = true;
    const Vector3d half = half_size(shape.geometry);
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3d sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
      extent.points.push_back(shape.pose * sign.cwiseProduct(half));
    }
  }
  return extent;
}

bool is_power_of_ten(double x) {
  const double exponent = std::log10(x);
  return std::abs(exponent - std::round(exponent)) < 1e-9;
}

void look_at_body(const RobotModel& robot, int index, const Body& body,
                  std::vector<std::string>& remarks) {
  const Extent extent = extent_of(robot, index);
  const Vector3d moments = principal_moments(body.inertia);
  const bool is_same_about_all = moments[2] > 0 && moments[2] - moments[0] <= 1e-9 * moments[2];
  if (is_same_about_all && is_power_of_ten(moments[1])) {
    remarks.push_back(fmt::format(
        "{}: the inertia is {:g} kg m^2 about every axis, as editors write when nobody measured it",
        body.name, moments[1]));
  }
  if (extent.points.empty()) return;

  const double reach = extent.reach(Vector3d::Zero());
  if (index != kBase && reach > 0.02 && body.centroid.norm() < 1e-3 * reach) {
    remarks.push_back(
        fmt::format("{}: the centroid is at its joint, though the body reaches {:.3g} m from it",
                    body.name, reach));
  }
  const double radius = extent.reach(body.centroid);
  const double gyration = std::sqrt(moments[2] / body.mass);
  if (extent.has_shape && radius > 0 && gyration > radius) {
    // No point is farther from the axis than from the centroid.
    remarks.push_back(fmt::format(
        "{}: the inertia needs mass {:.3g} m from the centroid, but the body ends {:.3g} m from it",
        body.name, gyration, radius));
  }
  if (radius > 0.02 && gyration > 0 && gyration < 0.1 * radius) {
    remarks.push_back(fmt::format(
        "{}: the inertia is that of a body of {:.2g} m about the centroid, but it reaches {:.3g} m",
        body.name, gyration, radius));
  }
  const Vector3d edges = extent.edges();
  if (is_same_about_all && edges[2] > 0.02 && edges[2] > 2 * edges[1]) {
    remarks.push_back(fmt::format(
        "{}: the inertia is {:.4g} kg m^2 about every axis, like a sphere's, on a body of "
        "{:.3g} x {:.3g} x {:.3g} m",
        body.name, moments[1], edges[0], edges[1], edges[2]));
  }
}

/// The tensor as the file states it: in the axes of the link, not of its joint.
Matrix3d inertia_in_link_axes(const RobotModel& robot, const Body& body) {
  const LinkFrame* const link = find_link(robot, body.name);
  const Matrix3d R =
      link == nullptr ? Matrix3d(Matrix3d::Identity()) : link->pose.orientation.toRotationMatrix();
  return R.transpose() * body.inertia * R;
}

/// Bodies of different mass or size with one tensor.
void look_for_shared_tensors(const RobotModel& robot, std::vector<std::string>& remarks) {
  std::vector<bool> is_named(robot.bodies.size(), false);
  for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
    const Body& first = robot.bodies[i];
    if (is_named[i] || first.inertia.isZero(0)) continue;
    std::string names = first.name;
    bool differ = false;
    for (std::size_t j = i + 1; j < robot.bodies.size(); ++j) {
      const Body& other = robot.bodies[j];
      if (!inertia_in_link_axes(robot, other).isApprox(inertia_in_link_axes(robot, first), 1e-9)) {
        continue;
      }
      is_named[j] = true;
      names += ", " + other.name;
      const double a = extent_of(robot, static_cast<int>(i)).reach(first.centroid);
      const double b = extent_of(robot, static_cast<int>(j)).reach(other.centroid);
      differ = differ || std::abs(other.mass - first.mass) > 0.01 * first.mass ||
               std::abs(a - b) > 0.1 * std::max(a, b);
    }
    if (differ) {
      remarks.push_back(names + ": the same inertia tensor on bodies of different mass or size");
    }
  }
}

void look_at_joint(const Joint& joint, std::vector<std::string>& remarks) {
  const char* const rate_unit = joint.is_prismatic() ? "m/s" : "rad/s";
  const char* const effort_unit = joint.is_prismatic() ? "N" : "N m";
  const auto look = [&](const char* what, double bound, double absurd, const char* unit) {
    if (!std::isfinite(bound)) {
      remarks.push_back(fmt::format("{}: no limit on its {}", joint.name, what));
    } else if (bound == 0) {
      remarks.push_back(fmt::format("{}: its {} is limited to zero", joint.name, what));
    } else if (bound > absurd) {
      remarks.push_back(fmt::format("{}: its {} is limited to {:g} {}, which limits nothing",
                                    joint.name, what, bound, unit));
    }
  };
  look("rate", joint.max_velocity, 100, rate_unit);
  look("effort", joint.max_effort, 1e5, effort_unit);
  if (joint.type == JointType::Continuous) return;
  const double range = joint.upper - joint.lower;
  if (!joint.is_prismatic() && range > 8 * kPi) {
    remarks.push_back(
        fmt::format("{}: its limits leave {:.3g} turns", joint.name, range / (2 * kPi)));
  }
  if (range <= 0) remarks.push_back(fmt::format("{}: its limits leave no motion", joint.name));
}

void look_at_masses(const RobotModel& robot, std::vector<std::string>& remarks) {
  const double total = robot.total_mass();
  double arm = 0;
  for (const Body& body : robot.bodies) {
    arm += body.mass;
    if (body.mass < 1e-5 * total) {
      remarks.push_back(fmt::format("{}: {:g} kg of {:g} kg in all", body.name, body.mass, total));
    }
  }
  if (arm > robot.base.mass) {
    remarks.push_back(fmt::format("the joints move {:.4g} kg, more than the {:.4g} kg of the base",
                                  arm, robot.base.mass));
  }
}

void look_at_shapes(const RobotModel& robot, std::vector<std::string>& remarks) {
  if (robot.shapes.empty()) {
    remarks.push_back("no collision geometry: nothing is checked for collisions");
    return;
  }
  std::string bare;
  for (int body = kBase; body < robot.num_bodies(); ++body) {
    const bool has_shape = std::any_of(robot.shapes.begin(), robot.shapes.end(),
                                       [&](const CollisionShape& s) { return s.body == body; });
    if (has_shape) continue;
    if (!bare.empty()) bare += ", ";
    bare += body == kBase ? robot.base.name : robot.bodies[static_cast<std::size_t>(body)].name;
  }
  if (!bare.empty()) remarks.push_back(bare + ": no collision geometry");
}

/// Axes that are parallel with all joints at zero stay so when all joints turn about them.
void look_at_axes(const RobotModel& robot, std::vector<std::string>& remarks) {
  std::vector<Matrix3d> R(robot.tree().size());
  Vector3d axis = Vector3d::Zero();
  int turning = 0;
  for (std::size_t k = 0; k < robot.tree().size(); ++k) {
    const Joint& joint = robot.tree()[k];
    R[k] = joint.parent == kBase
               ? joint.R.matrix()
               : Matrix3d(R[static_cast<std::size_t>(joint.parent)] * joint.R.matrix());
    if (joint.is_prismatic()) continue;
    const Vector3d z = R[k].col(2);
    if (++turning == 1) axis = z;
    if (axis.cross(z).norm() > 1e-9) return;
  }
  if (turning > 1) {
    remarks.push_back(
        "all joints turn about parallel axes: the robot moves in a plane, and an impact out of it "
        "turns the base whatever the posture");
  }
}

}  // namespace

std::vector<std::string> robot_suspicions(const RobotModel& robot) {
  std::vector<std::string> remarks;
  look_at_body(robot, kBase, robot.base, remarks);
  for (int k = 0; k < robot.num_bodies(); ++k) {
    look_at_body(robot, k, robot.bodies[static_cast<std::size_t>(k)], remarks);
  }
  look_for_shared_tensors(robot, remarks);
  for (const Joint& joint : robot.joints) look_at_joint(joint, remarks);
  look_at_masses(robot, remarks);
  look_at_shapes(robot, remarks);
  look_at_axes(robot, remarks);
  return remarks;
}

}  // namespace stillbase
