// Values that a file states per joint.
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

JointValues::JointValues(JointVectord& x, const RobotModel& robot, JointDimension dimension,
                         Range range, const JointOptions& options) {
  read = [&, dimension, range, options](ReadContext& context, const Node& node,
                                        const std::string& path) {
    // Without a robot (its own findings say why) nothing can be said about joints.
    if (robot.joints.empty()) return true;
    const std::size_t before = context.findings.size();
    JointVectord values = JointVectord::Zero(robot.n());
    const auto read_one = [&](const Node& value, const std::string& value_path, int k) {
      const bool slides = robot.joints[k].is_prismatic();
      const auto number = read_number(context, value, value_path,
                                      slides ? dimension.prismatic : dimension.revolute, range);
      if (number) values[k] = *number;
    };
    if (node.kind == Node::Kind::Map) {
      const std::vector<std::string> names = joint_names(robot);
      std::vector<std::string> missing = names;
      for (std::size_t i = 0; i < node.keys.size(); ++i) {
        const std::string value_path = path + "." + node.keys[i];
        if (!check_name(context, node.key_lines[i], value_path, node.keys[i], names, "joints")) {
          continue;
        }
        read_one(node.items[i], value_path, find_joint(robot, node.keys[i]));
        std::erase(missing, node.keys[i]);
      }
      if (!missing.empty()) {
        context.add(node.line, "missing-key",
                    fmt::format("{}: must name every joint; missing: {}", path, list_of(missing)));
      }
    } else if (node.kind == Node::Kind::Sequence) {
      if (static_cast<int>(node.items.size()) != robot.n()) {
        context.add(node.line, "wrong-length",
                    fmt::format("{}: has {} elements; must have {}, one per joint: {}", path,
                                node.items.size(), robot.n(), list_of(joint_names(robot))));
        return false;
      }
      for (int k = 0; k < robot.n(); ++k) {
        read_one(node.items[k], fmt::format("{}[{}]", path, k), k);
      }
    } else if (options.for_all && node.kind != Node::Kind::Null) {
      for (int k = 0; k < robot.n() && context.findings.size() == before; ++k) {
        read_one(node, path, k);
      }
    } else {
      context.add(
          node.line, "wrong-type",
          fmt::format("{}: must be a list of {} numbers or a map of joint names to numbers{}", path,
                      robot.n(), options.for_all ? ", or one number for all" : ""));
    }
    if (context.findings.size() != before) return false;
    x = values;
    return true;
  };
  leave_out = [&, options](ReadContext&, const std::string&, int) {
    if (options.without) x = JointVectord::Constant(robot.n(), *options.without);
    return false;
  };
  write = [&] {
    Json json = Json::object();
    for (int k = 0; k < robot.n(); ++k) json[robot.joints[k].name] = x[k];
    return json;
  };
  is_written = x.size() > 0;
  shape = [=](Definitions& definitions) -> Shape {
    const std::string revolute = units_of(dimension.revolute),
                      prismatic = units_of(dimension.prismatic);
    Json one = quantity(dimension.name, revolute + ", " + prismatic, definitions);
    const bool is_bounded = range.text() != kAny.text();
    if (is_bounded) add_bounds(one, range);
    Json kinds = Json::array(
        {{{"type", "array"}, {"items", one}}, {{"type", "object"}, {"additionalProperties", one}}});
    if (options.for_all) kinds.push_back(one);
    return {{{"anyOf", kinds}},
            fmt::format("{} ({}), per joint{}", revolute.substr(0, revolute.find(',')),
                        prismatic.substr(0, prismatic.find(',')), options.for_all ? " or one" : ""),
            is_bounded ? range.text() : ""};
  };
  fits = [](const Node&) { return true; };
}

JointFlags::JointFlags(std::vector<bool>& x, const RobotModel& robot) {
  read = [&](ReadContext& context, const Node& node, const std::string& path) {
    if (robot.joints.empty()) return true;
    if (node.kind != Node::Kind::Sequence && (node.text == "all" || node.text == "none")) {
      x.assign(robot.joints.size(), node.text == "all");
      return true;
    }
    if (node.kind != Node::Kind::Sequence) {
      context.add(node.line, "wrong-type",
                  fmt::format("{}: must be all, none or a list of joint names", path));
      return false;
    }
    const std::size_t before = context.findings.size();
    x.assign(robot.joints.size(), false);
    for (std::size_t i = 0; i < node.items.size(); ++i) {
      const std::string item_path = fmt::format("{}[{}]", path, i);
      const auto name = read_text(context, node.items[i], item_path);
      if (!name || !check_name(context, node.items[i].line, item_path, *name, joint_names(robot),
                               "joints")) {
        continue;
      }
      const int k = find_joint(robot, *name);
      if (x[k]) {
        context.add(node.items[i].line, "duplicate-name",
                    fmt::format("{}: joint '{}' is already named", item_path, *name));
      }
      x[k] = true;
    }
    return context.findings.size() == before;
  };
  leave_out = [&](ReadContext&, const std::string&, int) {
    x.assign(robot.joints.size(), true);
    return false;
  };
  write = [&] {
    Json json = Json::array();
    for (int k = 0; k < robot.n(); ++k) {
      if (x[k]) json.push_back(robot.joints[k].name);
    }
    return json;
  };
  shape = [](Definitions&) -> Shape {
    const Json names{{"type", "array"}, {"items", {{"type", "string"}}}, {"uniqueItems", true}};
    return {{{"anyOf", Json::array({{{"enum", Json::array({"all", "none"})}}, names})}}};
  };
  fits = [](const Node&) { return true; };
}

}  // namespace stillbase::io
