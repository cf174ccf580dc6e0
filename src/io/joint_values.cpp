// Values that a file states per joint.
#include <algorithm>

#include <fmt/format.h>

#include "io/problem_reader.hpp"

namespace stillbase::io {

std::vector<std::string> joint_names(const RobotModel& robot) {
  std::vector<std::string> names;
  for (const Joint& joint : robot.joints) names.push_back(joint.name);
  return names;
}

std::vector<std::string> link_names(const RobotModel& robot) {
  std::vector<std::string> names;
  for (const LinkFrame& link : robot.links) names.push_back(link.name);
  return names;
}

void read_joint_values(MapReader& map, const std::string& key, const RobotModel& robot,
                       Dimension revolute, Dimension prismatic, const Range& range,
                       bool may_be_uniform, Need need, JointVectord& out) {
  const Node* node = map.child(key, need);
  // Without a robot (its own findings say why) nothing can be said about joints.
  if (node == nullptr || robot.joints.empty()) return;
  ReadContext& context = map.context();
  const std::string path = map.path_of(key);
  JointVectord values = JointVectord::Zero(robot.n());
  const auto read_one = [&](const Node& value, const std::string& value_path, int k) {
    const Dimension dimension = robot.joints[k].is_prismatic() ? prismatic : revolute;
    const auto number = read_number(context, value, value_path, dimension, range);
    if (number) values[k] = *number;
  };

  if (node->kind == Node::Kind::Map) {
    const std::vector<std::string> names = joint_names(robot);
    std::vector<std::string> missing = names;
    for (std::size_t i = 0; i < node->keys.size(); ++i) {
      const std::string value_path = path + "." + node->keys[i];
      if (!check_name(context, node->key_lines[i], value_path, node->keys[i], names, "joints")) {
        continue;
      }
      read_one(node->items[i], value_path, find_joint(robot, node->keys[i]));
      missing.erase(std::remove(missing.begin(), missing.end(), node->keys[i]), missing.end());
    }
    if (!missing.empty()) {
      context.add(node->line, "missing-key",
                  fmt::format("{}: must name every joint; missing: {}", path, list_of(missing)));
    }
  } else if (node->kind == Node::Kind::Sequence) {
    if (static_cast<int>(node->items.size()) != robot.n()) {
      context.add(node->line, "wrong-length",
                  fmt::format("{}: has {} elements; must have {}, one per joint: {}", path,
                              node->items.size(), robot.n(), list_of(joint_names(robot))));
      return;
    }
    for (int k = 0; k < robot.n(); ++k) {
      read_one(node->items[k], fmt::format("{}[{}]", path, k), k);
    }
  } else if (may_be_uniform && node->kind != Node::Kind::Null) {
    for (int k = 0; k < robot.n(); ++k) {
      const std::size_t before = context.findings.size();
      read_one(*node, path, k);
      if (context.findings.size() != before) return;
    }
  } else {
    context.add(node->line, "wrong-type",
                fmt::format("{}: must be a list of {} numbers or a map of joint names to numbers{}",
                            path, robot.n(), may_be_uniform ? ", or one number for all" : ""));
    return;
  }
  out = values;
}

void read_joint_flags(MapReader& map, const std::string& key, const RobotModel& robot, Need need,
                      std::vector<bool>& out) {
  const Node* node = map.child(key, need);
  if (node == nullptr || robot.joints.empty()) return;
  ReadContext& context = map.context();
  const std::string path = map.path_of(key);
  if (node->kind != Node::Kind::Sequence && (node->text == "all" || node->text == "none")) {
    out.assign(robot.joints.size(), node->text == "all");
    return;
  }
  if (node->kind != Node::Kind::Sequence) {
    context.add(node->line, "wrong-type",
                fmt::format("{}: must be all, none or a list of joint names", path));
    return;
  }
  std::vector<bool> flags(robot.joints.size(), false);
  for (std::size_t i = 0; i < node->items.size(); ++i) {
    const std::string item_path = fmt::format("{}[{}]", path, i);
    const auto name = read_text(context, node->items[i], item_path);
    if (!name ||
        !check_name(context, node->items[i].line, item_path, *name, joint_names(robot), "joints")) {
      continue;
    }
    const int k = find_joint(robot, *name);
    if (flags[k]) {
      context.add(node->items[i].line, "duplicate-name",
                  fmt::format("{}: joint '{}' is already named", item_path, *name));
    }
    flags[k] = true;
  }
  out = flags;
}

}  // namespace stillbase::io
