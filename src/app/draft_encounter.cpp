#include "app/draft_encounter.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/collision/contact_survey.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/dynamics/jacobian.hpp>

namespace stillbase::app {

namespace {

constexpr double kSearchClearance = 2 * kDraftClearance;  // leaves the plan room to move
constexpr int kPostures = 4000;

JointVectord middle_posture(const RobotModel& robot, Random& random, double part) {
  JointVectord phi(robot.n());
  for (int k = 0; k < robot.n(); ++k) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(k)];
    const double bound = joint.is_prismatic() ? 1 : kPi;
    const double lower = std::max(joint.lower, -bound), upper = std::min(joint.upper, bound);
    const double middle = (lower + upper) / 2, half = std::max(0.0, (upper - lower) / 2);
    phi[k] = std::clamp(middle + part * half * random.uniform(-1, 1), joint.lower, joint.upper);
  }
  return phi;
}

/// How far a shape reaches from its origin along a unit vector of its own frame, m.
struct Extent {
  Vector3d along;
  double operator()(const Sphere& s) const { return s.radius; }
  double operator()(const Capsule& c) const {
    return c.radius + c.length / 2 * std::abs(along.z());
  }
  double operator()(const Cylinder& c) const {
    return c.radius * along.head<2>().norm() + c.length / 2 * std::abs(along.z());
  }
  double operator()(const Box& b) const { return b.size.dot(along.cwiseAbs()) / 2; }
  double operator()(const ConvexMesh& mesh) const {
    double most = -kInfinity;
    for (const Vector3d& vertex : mesh.vertices) most = std::max(most, along.dot(vertex));
    return most;
  }
};

/// How far a body's shapes, without those of `link`, reach from a point along a unit vector, both
/// in the body's frame, m; 0: they do not.
double reach_of_body(const RobotModel& robot, int body, const std::string& link,
                     const Vector3d& from, const Vector3d& along) {
  double most = 0;
  for (const CollisionShape& shape : robot.shapes) {
    if (shape.body != body || shape.link == link) continue;
    const Extent extent{shape.pose.orientation.inverse() * along};
    most =
        std::max(most, along.dot(shape.pose.position - from) + std::visit(extent, shape.geometry));
  }
  return most;
}

/// Where a body's shapes lie about a point, or without shapes its mass, along axes of its frame; m.
Vector3d outline(const RobotModel& robot, int body, const Vector3d& from, const Matrix3d& axes) {
  Vector3d middle;
  for (int i = 0; i < 3; ++i) {
    const auto reach = [&](double side) {
      return reach_of_body(robot, body, "", from, side * axes.col(i));
    };
    middle[i] = reach(1) - reach(-1);
  }
  if (middle.norm() > 0.005) return middle;
  return axes.transpose() * (robot.bodies[static_cast<std::size_t>(body)].centroid - from);
}

/// The axis of the hand's frame that points on from the arm: away from the joint of its body. Where
/// the hand is at the joint: along the joint's axis away from the joint before, else to where the
/// shapes or the mass of the body are, else along the joint's axis.
Vector3d approach_axis(const RobotModel& robot, const Kinematics<double>& kinematics) {
  const Matrix3d to_hand = kinematics.R_hand.transpose();
  Vector3d in_hand = to_hand * kinematics.r_bh;
  if (const int body = robot.hand_body; body != kBase) {
    const Vector3d o = kinematics.o[body], z = kinematics.z(body);
    in_hand -= to_hand * o;
    if (in_hand.norm() < 0.01) {
      const int before = robot.tree()[static_cast<std::size_t>(body)].parent;
      const double ahead = before == kBase ? 0 : z.dot(o - kinematics.o[before]);
      in_hand = std::abs(ahead) < 0.01 ? outline(robot, body, robot.p_hand, robot.R_hand)
                                       : Vector3d(to_hand * z * ahead);
      if (in_hand.norm() < 0.001) in_hand = to_hand * z;
    }
  }
  Eigen::Index axis = 0;
  in_hand.cwiseAbs().maxCoeff(&axis);
  return in_hand[axis] < 0 ? Vector3d(-Vector3d::Unit(axis)) : Vector3d(Vector3d::Unit(axis));
}

bool is_line_free(const RobotModel& robot, const CollisionScene& scene, const JointVectord& from,
                  const JointVectord& to) {
  constexpr int kSteps = 24;
  for (int i = 0; i <= kSteps; ++i) {
    const JointVectord phi = from + (to - from) * (static_cast<double>(i) / kSteps);
    if (scene.first_hit(compute_kinematics<double>(robot, phi), Pose{}, nullptr, kDraftClearance))
      return false;
  }
  return true;
}

/// The target comes along the hand's direction without passing through the base or the arm at the
/// contact. From outside it does; a hand that points at the base may have the base there.
bool is_way_free(const CollisionScene& scene, const Kinematics<double>& kinematics,
                 const Pose& target, const Vector3d& direction) {
  constexpr double kStep = 0.1, kWay = 3;  // m
  for (double way = kStep; way <= kWay; way += kStep) {
    Pose earlier = target;
    earlier.position += way * direction;
    if (scene.first_hit(kinematics, Pose{}, &earlier, kSearchClearance)) return false;
  }
  return true;
}

/// What is tried, the best first.
struct Attempt {
  double standoff;       ///< m
  double contact_share;  ///< of the survey
  double outwards;       ///< least cosine between the hand's axis and the direction from the base
};

std::optional<DraftEncounter> try_encounter(const RobotModel& robot, const SceneParts& with_target,
                                            const Attempt& attempt, DraftObstruction& obstruction) {
  SceneParts own_parts = with_target;
  own_parts.target.reset();
  own_parts.feature.reset();
  const CollisionScene own(robot, own_parts), both(robot, with_target);
  Random random(1);
  DraftEncounter found;
  JointVectord best;
  double best_score = 0;
  std::vector<std::pair<JointVectord, Vector3d>> free;  // postures and places of the hand
  for (int i = 0; i < kPostures; ++i) {
    const JointVectord phi = middle_posture(robot, random, 0.8);
    const auto kinematics = compute_kinematics<double>(robot, phi);
    if (own.first_hit(kinematics, Pose{}, nullptr, kSearchClearance)) continue;
    obstruction.links_are_free = true;
    free.emplace_back(phi, kinematics.r_bh);
    const Vector3d axis = approach_axis(robot, kinematics);
    const Vector3d direction = kinematics.R_hand * axis;
    // The target comes from outside, and not across the base.
    const double outwards = direction.dot(kinematics.r_bh.normalized());
    if (outwards < attempt.outwards) continue;
    obstruction.points_outwards = obstruction.points_outwards || outwards >= kOutwards;
    const auto jacobian = compute_hand_jacobian<double>(robot, kinematics);
    // Small beside a joint that moves the hand, so that a planar arm has a measure of its own.
    const Matrix3d JJ =
        jacobian.J_phi.topRows<3>() * jacobian.J_phi.topRows<3>().transpose() +
        Vector3d::Constant(1e-6 * kinematics.r_bh.squaredNorm()).asDiagonal().toDenseMatrix();
    const double score = (outwards - std::min(attempt.outwards, 0.0)) *
                         std::sqrt(std::sqrt(std::max(JJ.determinant(), 0.0)));
    if (score <= best_score) continue;
    Pose pose;
    pose.orientation = rotation_between(Vector3d::UnitX(), -direction);
    pose.position = kinematics.r_bh - pose.orientation * with_target.feature->point;
    if (both.first_hit(kinematics, Pose{}, &pose, kSearchClearance)) continue;
    if (outwards < kOutwards && !is_way_free(both, kinematics, pose, direction)) continue;
    best = phi;
    best_score = score;
    found.axis = axis;
    found.target = pose;
    found.direction = direction;
  }
  if (best.size() == 0) return std::nullopt;
  // The nearest posture from which the hand moves forwards along a free line.
  const Vector3d place = compute_kinematics<double>(robot, best).r_bh;
  found.start = best;
  double least = kInfinity;
  for (const auto& [phi, hand] : free) {
    const double distance = (phi - best).norm();
    if ((place - hand).dot(found.direction) < 0.1 || distance >= least) continue;
    if (!is_line_free(robot, own, phi, best)) continue;
    least = distance;
    found.start = phi;
  }
  return found;
}

}  // namespace

double reach_of_base(const RobotModel& robot, const std::string& link, const Vector3d& from,
                     const Vector3d& along) {
  return reach_of_body(robot, kBase, link, from, along);
}

std::optional<DraftEncounter> find_encounter(RobotModel& robot, const TargetBody& target,
                                             bool may_move_hand, double outwards,
                                             DraftObstruction& obstruction) {
  const JointVectord zero = JointVectord::Zero(robot.n());
  const Vector3d axis = approach_axis(robot, compute_kinematics<double>(robot, zero));
  const Vector3d p_hand = robot.p_hand;
  std::vector<double> standoffs{0};
  if (may_move_hand) {
    const double reach =
        reach_of_body(robot, robot.hand_body, "", robot.p_hand, robot.R_hand * axis);
    standoffs = {reach, reach + 0.05, reach + 0.1, reach + 0.2};
  }
  SceneParts parts;
  parts.target = target;
  parts.feature = target.features.front();
  parts.contact_allowance = ApproachSpec{}.contact_allowance;
  for (const double share : {1.0, 0.95, 0.8}) {
    parts.allowed_contacts =
        survey_contacts(robot,
                        {.postures_for_never = 200, .margin = kSearchClearance, .share = share})
            .always;
    for (const double standoff : standoffs) {
      robot.p_hand = p_hand + standoff * (robot.R_hand * axis);
      auto found = try_encounter(robot, parts, {standoff, share, outwards}, obstruction);
      if (!found) continue;
      found->standoff = standoff;
      found->is_further = standoff > standoffs.front();
      found->allowed_contacts = parts.allowed_contacts;
      found->contact_share = share;
      return found;
    }
  }
  robot.p_hand = p_hand;
  return std::nullopt;
}

}  // namespace stillbase::app
