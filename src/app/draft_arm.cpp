#include "app/draft_arm.hpp"

#include <algorithm>

namespace stillbase::app {

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
  // Fingers have fewer joints than the arm that carries them; arms on a torso have more.
  std::string hand = end->name;
  const long joints = moving_before(hand);
  long fingers = 0;
  for (const urdf::TreeJoint* joint : way_to(end->name)) {
    if (joint->is_fixed) continue;
    ++fingers;
    if (2 * fingers < joints && branches_at(body_of(joint->parent_name)) > 1) {
      hand = joint->parent_name;
    }
  }
  return hand;
}

}  // namespace stillbase::app
