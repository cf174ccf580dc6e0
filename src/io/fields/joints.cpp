// Values that a file states per joint.
#include <algorithm>

#include <fmt/format.h>

#include "io/fields/describer.hpp"
#include "io/fields/values.hpp"

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

bool JointValues::read(ReadContext& context, const Node& node, const std::string& path) {
  // Without a robot (its own findings say why) nothing can be said about joints.
  if (robot_.joints.empty()) return true;
  const std::size_t before = context.findings.size();
  JointVectord values = JointVectord::Zero(robot_.n());
  const auto read_one = [&](const Node& value, const std::string& value_path, int k) {
    const Dimension dimension =
        robot_.joints[k].is_prismatic() ? dimension_.prismatic : dimension_.revolute;
    const auto number = read_number(context, value, value_path, dimension, range_);
    if (number) values[k] = *number;
  };
  if (node.kind == Node::Kind::Map) {
    const std::vector<std::string> names = joint_names(robot_);
    std::vector<std::string> missing = names;
    for (std::size_t i = 0; i < node.keys.size(); ++i) {
      const std::string value_path = path + "." + node.keys[i];
      if (!check_name(context, node.key_lines[i], value_path, node.keys[i], names, "joints")) {
        continue;
      }
      read_one(node.items[i], value_path, find_joint(robot_, node.keys[i]));
      missing.erase(std::remove(missing.begin(), missing.end(), node.keys[i]), missing.end());
    }
    if (!missing.empty()) {
      context.add(node.line, "missing-key",
                  fmt::format("{}: must name every joint; missing: {}", path, list_of(missing)));
    }
  } else if (node.kind == Node::Kind::Sequence) {
    if (static_cast<int>(node.items.size()) != robot_.n()) {
      context.add(node.line, "wrong-length",
                  fmt::format("{}: has {} elements; must have {}, one per joint: {}", path,
                              node.items.size(), robot_.n(), list_of(joint_names(robot_))));
      return false;
    }
    for (int k = 0; k < robot_.n(); ++k) {
      read_one(node.items[k], fmt::format("{}[{}]", path, k), k);
    }
  } else if (also_.for_all && node.kind != Node::Kind::Null) {
    for (int k = 0; k < robot_.n() && context.findings.size() == before; ++k) {
      read_one(node, path, k);
    }
  } else {
    context.add(node.line, "wrong-type",
                fmt::format("{}: must be a list of {} numbers or a map of joint names to numbers{}",
                            path, robot_.n(), also_.for_all ? ", or one number for all" : ""));
  }
  if (context.findings.size() != before) return false;
  x_ = values;
  return true;
}

Json JointValues::write() const {
  Json json = Json::object();
  for (int k = 0; k < robot_.n(); ++k) json[robot_.joints[k].name] = x_[k];
  return json;
}

Shape JointValues::shape(Definitions& definitions) {
  const std::string revolute = units_of(dimension_.revolute),
                    prismatic = units_of(dimension_.prismatic);
  Json one = quantity(dimension_.name, revolute + ", " + prismatic, definitions);
  const bool is_bounded = range_.text() != kAny.text();
  if (is_bounded) add_bounds(one, range_);
  Json kinds = Json::array(
      {{{"type", "array"}, {"items", one}}, {{"type", "object"}, {"additionalProperties", one}}});
  if (also_.for_all) kinds.push_back(one);
  return {{{"anyOf", kinds}},
          fmt::format("{} ({}), per joint{}", revolute.substr(0, revolute.find(',')),
                      prismatic.substr(0, prismatic.find(',')), also_.for_all ? " or one" : ""),
          is_bounded ? range_.text() : ""};
}

bool JointFlags::read(ReadContext& context, const Node& node, const std::string& path) {
  if (robot_.joints.empty()) return true;
  if (node.kind != Node::Kind::Sequence && (node.text == "all" || node.text == "none")) {
    x_.assign(robot_.joints.size(), node.text == "all");
    return true;
  }
  if (node.kind != Node::Kind::Sequence) {
    context.add(node.line, "wrong-type",
                fmt::format("{}: must be all, none or a list of joint names", path));
    return false;
  }
  const std::size_t before = context.findings.size();
  x_.assign(robot_.joints.size(), false);
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    const std::string item_path = fmt::format("{}[{}]", path, i);
    const auto name = read_text(context, node.items[i], item_path);
    if (!name ||
        !check_name(context, node.items[i].line, item_path, *name, joint_names(robot_), "joints")) {
      continue;
    }
    const int k = find_joint(robot_, *name);
    if (x_[k]) {
      context.add(node.items[i].line, "duplicate-name",
                  fmt::format("{}: joint '{}' is already named", item_path, *name));
    }
    x_[k] = true;
  }
  return context.findings.size() == before;
}

Json JointFlags::write() const {
  Json json = Json::array();
  for (int k = 0; k < robot_.n(); ++k) {
    if (x_[k]) json.push_back(robot_.joints[k].name);
  }
  return json;
}

Shape JointFlags::shape(Definitions&) {
  return {{{"anyOf",
            Json::array(
                {{{"enum", Json::array({"all", "none"})}},
                 {{"type", "array"}, {"items", {{"type", "string"}}}, {"uniqueItems", true}}})}}};
}

}  // namespace stillbase::io
