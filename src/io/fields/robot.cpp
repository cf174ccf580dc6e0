// The section `robot`.
#include <cmath>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>

#include <stillbase/robot/urdf_reader.hpp>

#include "io/fields/sections.hpp"

namespace stillbase::io {

namespace {

using LinkPair = std::pair<std::string, std::string>;

/// [link, link].
struct Links : Value {
  Links(LinkPair& pair, const RobotModel& robot) {
    fits = [](const Node& node) {
      return node.kind == Node::Kind::Sequence && node.items.size() == 2;
    };
    read = [&pair, &robot, are_two = fits](ReadContext& context, const Node& node,
                                           const std::string& path) {
      if (!are_two(node)) {
        context.add(node.line, "wrong-type", path + ": must be a list of [link, link]");
        return false;
      }
      const auto a = read_text(context, node.items[0], path);
      const auto b = read_text(context, node.items[1], path);
      if (!a || !b || robot.links.empty()) return false;
      const std::vector<std::string> links = link_names(robot);
      const bool are_known = check_name(context, node.line, path, *a, links, "links") &&
                             check_name(context, node.line, path, *b, links, "links");
      if (are_known && *a == *b) {
        context.add(node.line, "duplicate-name", path + ": a link cannot touch itself");
      }
      pair = {*a, *b};
      return true;
    };
    write = [&pair] { return Json::array({pair.first, pair.second}); };
    shape = [](Definitions&) -> Shape {
      return {
          {{"type", "array"}, {"items", {{"type", "string"}}}, {"minItems", 2}, {"maxItems", 2}}};
    };
  }
};

void read_robot(MapReader& map, CaptureProblem& problem, const ProblemSources& sources,
                const std::string& hand) {
  std::string full_path = problem.urdf_path;
  std::optional<std::string> text = sources.urdf;
  if (!text && !problem.urdf_path.empty()) {
    text = map.read_file("file", problem.urdf_path, sources.folder, full_path);
  }
  if (!text) return;
  problem.urdf = std::move(*text);
  try {
    problem.robot = read_urdf(problem.urdf, full_path, hand);
    // The same wherever the problem lies.
    for (Finding& remark : problem.robot.remarks) remark.file = problem.urdf_path;
  } catch (const InputError& error) {
    for (Finding finding : error.findings()) {
      // The hand is named here, not in the robot file.
      if (finding.rule.rfind("hand-", 0) == 0) {
        finding.file = map.context().source;
        finding.line = map.line_of("hand");
        finding.message = map.path_of("hand") + ": " + finding.message;
      }
      map.context().findings.push_back(std::move(finding));
    }
  }
}

void check_start(MapReader& map, const CaptureProblem& problem) {
  if (problem.start.size() != problem.robot.n()) return;
  for (int k = 0; k < problem.robot.n(); ++k) {
    const Joint& joint = problem.robot.joints[k];
    if (problem.start[k] >= joint.lower && problem.start[k] <= joint.upper) continue;
    const double in_degrees = problem.start[k] * kPi / 180;
    const bool may_be_degrees = !joint.is_prismatic() && std::abs(problem.start[k]) > 2 * kPi &&
                                in_degrees >= joint.lower && in_degrees <= joint.upper;
    map.context().add(
        map.line_of("start"), "outside-limits",
        fmt::format(
            "{}.{}: {} {} is outside the joint's limits [{}, {}]{}", map.path_of("start"),
            joint.name, problem.start[k], joint.is_prismatic() ? "m" : "rad", joint.lower,
            joint.upper,
            may_be_degrees ? fmt::format("; did you mean '{} deg'?", problem.start[k]) : ""));
  }
}

}  // namespace

void robot_fields(Table& t, CaptureProblem& problem, const ProblemSources& sources) {
  std::string hand = problem.robot.hand;
  t("file", Text(problem.urdf_path), "URDF, relative to this file", kNeeded);
  t("hand", Text(hand), "hand link", {.without = "the only link without children"});
  if (t.reader() != nullptr) read_robot(*t.reader(), problem, sources, hand);
  t("start", JointValues(problem.start, problem.robot, kJointPosition, kAngle, {.for_all = false}),
    "posture before the approach, within the joint limits", kNeeded);
  if (t.reader() != nullptr) check_start(*t.reader(), problem);
  t("base", Map([&](Table& base) { pose_fields(base, problem.base, "B", "N", kPlace); }),
    "stated base pose", {.frame = "N", .without = "`position` 0, `orientation` 1"});
  t("allowed_contacts",
    List(problem.allowed_contacts, [&](LinkPair& pair) { return Links(pair, problem.robot); },
         {.of = "[link, link]"}),
    "pairs [link, link] that may touch");
}

}  // namespace stillbase::io
