#include "app/draft_arm.hpp"

#include <algorithm>
#include <cctype>

namespace stillbase::app {

namespace {

/// Whether a joint closes a hand, by the names that files give to such joints and their links.
bool moves_finger(const urdf::TreeJoint& joint) {
  const auto has = [](std::string name, std::initializer_list<const char*> parts) {
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return std::any_of(parts.begin(), parts.end(),
                       [&](const char* part) { return name.find(part) != std::string::npos; });
  };
  const std::string& name = joint.joint.name;
  const std::initializer_list<const char*> fingers = {"finger", "jaw", "knuckle", "thumb", "claw"};
  if (has(name, fingers) || has(joint.child_name, fingers)) return true;
  return has(name, {"gripper"}) && !has(name, {"roll", "rot", "yaw", "pitch", "wrist", "flex"});
}

}  // namespace

ArmTree::ArmTree(const urdf::Tree& tree) : tree_(tree) {
  for (const urdf::TreeJoint& joint : tree.joints) above_[joint.child_name] = &joint;
}

bool ArmTree::has_link(const std::string& name) const {
  return std::any_of(tree_.links.begin(), tree_.links.end(),
                     [&](const urdf::TreeLink& link) { return link.name == name; });
}

std::vector<const urdf::TreeJoint*> ArmTree::way_to(const std::string& link) const {
  std::vector<const urdf::TreeJoint*> joints;
  for (auto at = above_.find(link); at != above_.end();
       at = above_.find(joints.back()->parent_name)) {
    joints.push_back(at->second);
  }
  return joints;
}

long ArmTree::moving_before(const std::string& link) const {
  const auto joints = way_to(link);
  return std::count_if(joints.begin(), joints.end(), [](auto* j) { return !j->is_fixed; });
}

std::string ArmTree::body_of(const std::string& link) const {
  std::string body = link;
  for (auto at = above_.find(link); at != above_.end() && at->second->is_fixed;
       at = above_.find(body)) {
    body = at->second->parent_name;
  }
  return body;
}

long ArmTree::branches_at(const std::string& body) const {
  return std::count_if(tree_.joints.begin(), tree_.joints.end(), [&](const auto& joint) {
    return !joint.is_fixed && body_of(joint.parent_name) == body;
  });
}

double ArmTree::mass_on_root() const {
  double mass = 0;
  for (const urdf::TreeLink& link : tree_.links) {
    if (link.inertial && moving_before(link.name) == 0) mass += link.inertial->mass;
  }
  return mass;
}

double ArmTree::mass() const {
  double sum = 0;
  for (const urdf::TreeLink& link : tree_.links) sum += link.inertial ? link.inertial->mass : 0;
  return sum;
}

std::vector<std::string> ArmTree::tips_beyond(const std::string& hand) const {
  const std::string body = body_of(hand);
  std::vector<std::string> tips;
  for (const urdf::TreeLink& link : tree_.links) {
    if (!link.child_joints.empty() || body_of(link.name) == body) continue;
    const auto way = way_to(link.name);
    if (std::any_of(way.begin(), way.end(),
                    [&](auto* joint) { return body_of(joint->parent_name) == body; })) {
      tips.push_back(link.name);
    }
  }
  return tips;
}

std::string ArmTree::hand() const {
  const auto rank = [&](const urdf::TreeLink& link) {
    int name = 0;
    for (const char* part : {"tool0", "tcp", "hand", "grasp", "ee", "tool", "gripper", "flange"}) {
      ++name;
      if (link.name.find(part) != std::string::npos)
        return std::pair(moving_before(link.name), -name);
    }
    return std::pair(moving_before(link.name), -100);
  };
  const auto end = std::max_element(
      tree_.links.begin(), tree_.links.end(),
      [&](const urdf::TreeLink& a, const urdf::TreeLink& b) { return rank(a) < rank(b); });
  // Fingers have the names of fingers, or they branch and have fewer joints than the arm that
  // carries them; arms on a torso have more.
  std::string hand = end->name;
  const long joints = moving_before(hand);
  long fingers = 0;
  bool is_finger = true;  // and so are those further out
  for (const urdf::TreeJoint* joint : way_to(end->name)) {
    if (joint->is_fixed) continue;
    ++fingers;
    is_finger = is_finger && fingers < joints && moves_finger(*joint);
    if (is_finger) hand = joint->parent_name;
    if (2 * fingers < joints && branches_at(body_of(joint->parent_name)) > 1) {
      hand = joint->parent_name;
    }
  }
  return hand;
}

}  // namespace stillbase::app
