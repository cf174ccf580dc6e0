#include <algorithm>
#include <stdexcept>
#include <utility>

#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

void ConstantAxes::find_rows() {
  rows_ = {-1, -1, -1};
  std::array<signed char, 3> rows{};
  for (std::size_t j = 0; j < 3; ++j) {
    int entries = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      if (R_(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) == 0) continue;
      rows[j] = static_cast<signed char>(i);
      ++entries;
    }
    if (entries != 1) return;
  }
  rows_ = rows;
}

double RobotModel::total_mass() const {
  double mass = base.mass;
  for (const Body& body : bodies) mass += body.mass;
  return mass;
}

int find_joint(const RobotModel& robot, const std::string& name) {
  for (int k = 0; k < robot.n(); ++k) {
    if (robot.joints[k].name == name) return k;
  }
  return -1;
}

const LinkFrame* find_link(const RobotModel& robot, const std::string& name) {
  const auto link = std::find_if(robot.links.begin(), robot.links.end(),
                                 [&](const LinkFrame& l) { return l.name == name; });
  return link == robot.links.end() ? nullptr : &*link;
}

RobotModel with_hand(RobotModel robot, const std::string& link) {
  const LinkFrame* frame = find_link(robot, link);
  if (frame == nullptr) throw std::invalid_argument("the robot has no link '" + link + "'");
  robot.hand = link;
  robot.hand_body = frame->body;
  robot.R_hand = frame->pose.orientation.toRotationMatrix();
  robot.p_hand = frame->pose.position;
  robot.moves_hand.assign(robot.bodies.size(), false);
  for (int k = robot.hand_body; k != kBase; k = robot.tree()[k].parent) robot.moves_hand[k] = true;
  return robot;
}

std::vector<std::string> leaf_links(const RobotModel& robot) {
  std::vector<std::string> leaves;
  for (const LinkFrame& link : robot.links) {
    const bool has_child =
        std::any_of(robot.links.begin(), robot.links.end(),
                    [&](const LinkFrame& other) { return other.parent == link.name; });
    if (!has_child) leaves.push_back(link.name);
  }
  return leaves;
}

}  // namespace stillbase
