#include "app/draft_encounter.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <stillbase/collision/contact_survey.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/dynamics/jacobian.hpp>
#include <stillbase/robot/assembled_robot.hpp>

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
  constexpr double kStep = 0.1;  // m
  constexpr int kSteps = 30;
  for (int k = 1; k <= kSteps; ++k) {
    Pose earlier = target;
    earlier.position += k * kStep * direction;
    if (scene.first_hit(kinematics, Pose{}, &earlier, kSearchClearance)) return false;
  }
  return true;
}

/// The postures between which the arm moves freely, of some that touch nothing: a search for a
/// contact finds postures of each such part about as often as it is large, and a path starts and
/// ends in one of them.
class Roadmap {
 public:
  /// @param postures outlive this
  Roadmap(const RobotModel& robot, const CollisionScene& scene,
          const std::vector<JointVectord>& postures)
      : robot_(robot), scene_(scene), postures_(postures) {
    const std::size_t count = std::min(postures.size(), kNodes);
    part_.resize(count);
    std::iota(part_.begin(), part_.end(), 0);
    for (std::size_t i = 0; i < count; ++i) {
      for (const std::size_t j : nearest(postures[i], kNeighbours + 1)) {
        const std::size_t a = part_of(i), b = part_of(j);
        if (a != b && is_line_free(robot, scene, postures[i], postures[j])) part_[a] = b;
      }
    }
    std::vector<std::size_t> sizes(count, 0);
    for (std::size_t i = 0; i < count; ++i) ++sizes[part_of(i)];
    const auto most = std::max_element(sizes.begin(), sizes.end());
    largest_ = static_cast<std::size_t>(most - sizes.begin());
    connected_ = static_cast<double>(*most) / static_cast<double>(count);
  }

  /// Part of the nodes that the largest part has.
  double connected() const { return connected_; }

  /// Whether a posture has a free line to the largest part.
  bool reaches(const JointVectord& phi) {
    for (const std::size_t i : nearest(phi, kNeighbours)) {
      if (part_of(i) == largest_ && is_line_free(robot_, scene_, phi, postures_[i])) return true;
    }
    return false;
  }

 private:
  static constexpr std::size_t kNodes = 300, kNeighbours = 8;

  std::size_t part_of(std::size_t i) const {
    while (part_[i] != i) i = part_[i];
    return i;
  }

  std::vector<std::size_t> nearest(const JointVectord& phi, std::size_t count) const {
    std::vector<std::pair<double, std::size_t>> by_distance;
    for (std::size_t i = 0; i < part_.size(); ++i) {
      by_distance.emplace_back((postures_[i] - phi).squaredNorm(), i);
    }
    count = std::min(count, by_distance.size());
    std::partial_sort(by_distance.begin(), by_distance.begin() + static_cast<long>(count),
                      by_distance.end());
    std::vector<std::size_t> list;
    for (std::size_t k = 0; k < count; ++k) list.push_back(by_distance[k].second);
    return list;
  }

  const RobotModel& robot_;
  const CollisionScene& scene_;
  const std::vector<JointVectord>& postures_;
  std::vector<std::size_t> part_;  ///< of each node: another one of its part, or itself
  std::size_t largest_ = 0;
  double connected_ = 0;
};

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
  std::vector<JointVectord> free;
  for (int i = 0; i < kPostures; ++i) {
    const JointVectord phi = middle_posture(robot, random, 0.8);
    const auto kinematics = compute_kinematics<double>(robot, phi);
    if (!own.first_hit(kinematics, Pose{}, nullptr, kSearchClearance)) free.push_back(phi);
  }
  obstruction.links_are_free = obstruction.links_are_free || !free.empty();
  std::optional<Roadmap> roadmap;
  for (const JointVectord& phi : free) {
    const auto kinematics = compute_kinematics<double>(robot, phi);
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
    if (!roadmap) roadmap.emplace(robot, own, free);
    if (!roadmap->reaches(phi)) continue;
    found.connected = roadmap->connected();
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
  for (const JointVectord& phi : free) {
    const double distance = (phi - best).norm();
    if (distance >= least) continue;
    const Vector3d hand = compute_kinematics<double>(robot, phi).r_bh;
    if ((place - hand).dot(found.direction) < 0.1) continue;
    if (!is_line_free(robot, own, phi, best)) continue;
    least = distance;
    found.start = phi;
  }
  return found;
}

/// Whether two links are on bodies with at most one body between them.
bool are_near(const RobotModel& robot, const std::string& a, const std::string& b) {
  const auto ancestors = [&](const std::string& link) {
    std::vector<int> bodies{find_link(robot, link)->body};
    while (bodies.size() < 3 && bodies.back() != kBase) {
      bodies.push_back(robot.tree()[static_cast<std::size_t>(bodies.back())].parent);
    }
    return bodies;
  };
  const std::vector<int> above_a = ancestors(a), above_b = ancestors(b);
  for (std::size_t i = 0; i < above_a.size(); ++i) {
    for (std::size_t j = 0; i + j < 3 && j < above_b.size(); ++j) {
      if (above_a[i] == above_b[j]) return true;
    }
  }
  return false;
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
    constexpr double kRounding = 1e-6;  // m, of a frame in the face of its body
    double reach = reach_of_body(robot, robot.hand_body, "", robot.p_hand, robot.R_hand * axis);
    if (reach < kRounding) reach = 0;
    standoffs = {reach, reach + 0.05, reach + 0.1, reach + 0.2};
  }
  SceneParts parts;
  parts.target = target;
  parts.feature = target.features.front();
  parts.contact_allowance = ApproachSpec{}.contact_allowance;
  constexpr double kNearlyAll = 0.8;  // of the postures that touch, or that are connected
  std::optional<DraftEncounter> most_connected;
  for (const double share : {1.0, 0.95, kNearlyAll, 0.5, 0.33}) {
    ContactSurvey::LinkPairs contacts =
        survey_contacts(robot,
                        {.postures_for_never = 200, .margin = kSearchClearance, .share = share})
            .always;
    if (share < kNearlyAll) {
      const auto is_satellite = [&](const std::string& link) {
        return link == kBaseLink || (!may_move_hand && find_link(robot, link)->body == kBase);
      };
      const auto are_far = [&](const auto& pair) {
        return is_satellite(pair.first) || is_satellite(pair.second) ||
               !are_near(robot, pair.first, pair.second);
      };
      contacts.erase(std::remove_if(contacts.begin(), contacts.end(), are_far), contacts.end());
      for (const auto& pair : parts.allowed_contacts) {
        if (are_far(pair)) contacts.push_back(pair);
      }
    }
    if (share < 1 && contacts.size() == parts.allowed_contacts.size()) continue;
    parts.allowed_contacts = std::move(contacts);
    for (const double standoff : standoffs) {
      robot.p_hand = p_hand + standoff * (robot.R_hand * axis);
      auto found = try_encounter(robot, parts, {standoff, share, outwards}, obstruction);
      if (!found) continue;
      found->standoff = standoff;
      found->is_further = standoff > standoffs.front();
      found->allowed_contacts = parts.allowed_contacts;
      found->contact_share = share;
      if (!most_connected || found->connected > most_connected->connected) most_connected = found;
      break;  // the hand's frame connects nothing
    }
    if (most_connected && most_connected->connected >= kNearlyAll) break;
  }
  robot.p_hand = p_hand;
  if (most_connected) robot.p_hand += most_connected->standoff * (robot.R_hand * axis);
  return most_connected;
}

}  // namespace stillbase::app
