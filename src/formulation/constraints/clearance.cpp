// Distances between bodies at the contact.
#include <algorithm>
#include <vector>

#include <stillbase/core/error.hpp>

#include "formulation/constraints/clearance_kernel.hpp"
#include "formulation/constraints/constraint.hpp"

namespace stillbase {

// As placed() has it.
Vector3d ShapeOrigin::at(const ConstraintPoint<double>& point) const {
  const Kinematics<double>& kin = point.posture.kinematics;
  if (body >= 0) {
    const auto index = static_cast<std::size_t>(body);
    return kin.o[index] + kin.R[index] * p;
  }
  if (body != kTargetBody) return p;
  return kin.r_bh + point.placement.contact.R_EB.transpose() * p;
}

namespace {

/// Axes of a shape, from those of its body.
template <class S>
Matrix3<S> axes(const Matrix3<S>& R, const ClearanceShape& shape) {
  if (!shape.is_turned()) return R;
  return R * shape.R.cast<S>();
}

/// A shape in B; the target lies with its contact at the hand.
template <class S>
PlacedShape<S> placed(const ClearanceShape& shape, const TargetPlacement& target,
                      const ConstraintPoint<S>& at) {
  const Kinematics<S>& kin = at.posture.kinematics;
  const Vector3<S> p_shape = shape.p.cast<S>();
  if (shape.body >= 0) {
    const Matrix3<S>& R = kin.R[static_cast<std::size_t>(shape.body)];
    return {&shape, axes<S>(R, shape), kin.o[static_cast<std::size_t>(shape.body)] + R * p_shape};
  }
  if (shape.body != kTargetBody) return {&shape, shape.R.cast<S>(), p_shape};
  const Matrix3<S> R = at.placement.contact.R_EB.transpose() * target.R_ET.cast<S>();
  const Vector3<S> o = kin.r_bh - R * target.r.cast<S>();
  return {&shape, axes<S>(R, shape), o + R * p_shape};
}

/// Of normal . (velocity of the body at a point).
template <class S>
void add_gradient_of_body(int body, const Vector3<S>& normal, const Vector3<S>& point,
                          const ConstraintPoint<S>& at, ScalarGradient<S>& gradient) {
  const Kinematics<S>& kin = at.posture.kinematics;
  if (body == kTargetBody) {
    // It moves with the hand and rotates with the contact frame, against the rotation of B.
    for (int k = 0; k < at.model.n(); ++k) {
      const Vector3<S> column = at.posture.jacobian.J_phi.template block<3, 1>(0, k);
      gradient.phi[k] += normal.dot(column);
    }
    at.model.template add_contact_turn<S>(at.placement.rates,
                                          normal.cross(Vector3<S>(point - kin.r_bh)), gradient);
    return;
  }
  const RobotModel& robot = at.model.problem.robot;
  const std::vector<Joint>& joints = robot.tree();
  for (int k = body; k != kBase; k = joints[static_cast<std::size_t>(k)].parent) {
    const auto index = static_cast<std::size_t>(k);
    Vector3<S> z = kin.z(k);
    if (robot.is_coupled()) z *= S(robot.couplings[index].ratio);
    const Vector3<S> lever = point - kin.o[index];
    gradient.phi[robot.coordinate(k)] +=
        normal.dot(joints[index].is_prismatic() ? z : Vector3<S>(z.cross(lever)));
  }
}

/// The distance of a pair, at least the clearance.
class PairDistance {
 public:
  /// @param first, second numbers of the shapes
  PairDistance(const ClearancePair& pair, const TargetPlacement& target, double clearance,
               std::size_t first, std::size_t second)
      : pair_(pair),
        target_(target),
        clearance_(clearance),
        spheres_{first, second, pair.first.reach() + pair.second.reach()} {}

  template <class S>
  S operator()(const ConstraintPoint<S>& at, ScalarGradient<S>* gradient) const {
    const Separation<S> found =
        separate<S>(placed<S>(pair_.first, target_, at), placed<S>(pair_.second, target_, at));
    if (gradient != nullptr) {
      add_gradient_of_body<S>(pair_.first.body, found.normal, found.point, at, *gradient);
      add_gradient_of_body<S>(pair_.second.body, -found.normal, found.point, at, *gradient);
    }
    return found.distance;
  }

  /// Most pairs are far apart.
  ShapeSpheres spheres() const { return spheres_; }
  bool surely_holds(const ConstraintPoint<double>& at) const {
    constexpr double kRounding = 1e-9;  // m
    return is_beyond(placed<double>(pair_.first, target_, at),
                     placed<double>(pair_.second, target_, at),
                     std::max(clearance_, 0.0) + kRounding);
  }

 private:
  ClearancePair pair_;
  TargetPlacement target_;
  double clearance_;
  ShapeSpheres spheres_;
};

/// Where faces of two boxes are parallel their distance is the least of those of several corners,
/// and has a kink there, at which many searches end: base and target, the largest bodies, come to
/// stand side by side. The distance of each corner from the other box is smooth while they are
/// apart. The boxes of all links would give a thousand rows.
std::vector<ClearancePair> corners_of(const ClearancePair& pair) {
  std::vector<ClearancePair> out;
  if (!pair.first.is_box || !pair.second.is_box) return out;
  if (pair.first.body != kBase || pair.second.body != kTargetBody) return out;
  const auto add = [&](const ClearanceShape& box, const ClearanceShape& other) {
    for (unsigned i = 0; i < 8; ++i) {
      const Vector3d sign((i & 1U) != 0 ? 1 : -1, (i & 2U) != 0 ? 1 : -1, (i & 4U) != 0 ? 1 : -1);
      ClearanceShape corner;
      corner.body = box.body;
      corner.name = box.name;
      corner.p = box.p + box.R * sign.cwiseProduct(box.half);
      out.push_back({corner, other, pair.name});
    }
  };
  add(pair.first, pair.second);
  add(pair.second, pair.first);
  return out;
}

}  // namespace

void add_clearance(const CaptureModel& model, ConstraintSet& out) {
  const CaptureProblem& problem = model.problem;
  if (!problem.constraints.clearance) return;
  const auto refuse = [&problem](const std::string& message) {
    throw InputError(
        {Finding{problem.source, 0, "clearance", "constraints.clearance: " + message}});
  };
  const EncounterModel& encounter = model.encounter;
  TargetPlacement target;
  if (problem.target && !problem.target->shapes.empty()) {
    if (encounter.follows_target() && encounter.hand_point) {
      refuse("the target lies with its contact feature at the hand; leave hand.position out");
    }
    if (encounter.frame == ContactFrame::Base && model.layout.attitude_size > 0) {
      refuse("with a direction stated in the base frame the attitude of the base must be fixed");
    }
    target = target_placement(problem, encounter);
  }
  // Shapes of one origin have one number.
  const auto number_of = [&](const ClearanceShape& shape) {
    const Vector3d p =
        shape.body == kTargetBody ? Vector3d(target.R_ET * (shape.p - target.r)) : shape.p;
    const auto known = std::find_if(
        out.shapes.begin(), out.shapes.end(),
        [&](const ShapeOrigin& other) { return other.body == shape.body && other.p == p; });
    if (known != out.shapes.end()) return static_cast<std::size_t>(known - out.shapes.begin());
    out.shapes.push_back({shape.body, p});
    return out.shapes.size() - 1;
  };
  const auto add = [&](const ClearancePair& pair, bool is_part) {
    ConstraintLabel label{pair.name, "m", *problem.constraints.clearance, kInfinity};
    label.is_limit = label.has_kinks = true;
    label.is_part = is_part;
    add_constraint(is_part ? out.parts : out.rows, label,
                   PairDistance{pair, target, *problem.constraints.clearance, number_of(pair.first),
                                number_of(pair.second)});
  };
  for (const ClearancePair& pair : clearance_pairs(problem)) {
    add(pair, false);
    for (const ClearancePair& corner : corners_of(pair)) add(corner, true);
  }
}

}  // namespace stillbase
