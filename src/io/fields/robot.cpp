// The section `robot`.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/error.hpp>
#include <stillbase/robot/unlocked_robot.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include "io/fields/sections.hpp"
#include "robot/assembly.hpp"
#include "robot/geometric_model.hpp"
#include "robot/srdf_reader.hpp"

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

/// Texts of the robot's files into an assembly; none when one of them is not good.
/// @param full_path of the file of a robot that is one file
std::optional<RobotAssembly> read_parts(MapReader& map, const CaptureProblem& problem,
                                        const ProblemSources& sources, std::string& full_path) {
  const RobotParts& parts = problem.parts;
  std::vector<Finding>& findings = map.context().findings;
  const std::size_t before = findings.size();
  RobotAssembly assembly(parts.collision);
  urdf::MeshFolders folders;
  for (const std::string& folder : parts.package_path) {
    folders.packages.push_back(
        (std::filesystem::path(sources.folder.value_or("")) / folder).string());
  }
  for (std::string& folder : urdf::ros_package_path())
    folders.packages.push_back(std::move(folder));
  const auto add = [&](const std::string& key, const std::string& file, const auto& use) {
    const auto text = map.read_file(key, file, sources.folder, full_path);
    if (!text) return;
    folders.robot_file = full_path;
    try {
      use(*text);
    } catch (const AssemblyError& error) {
      map.refuse(key, error.rule(), error.what());
    } catch (const InputError& error) {
      findings.insert(findings.end(), error.findings().begin(), error.findings().end());
    }
  };
  if (parts.arms.empty()) {
    add("file", problem.urdf_path,
        [&](const std::string& text) { assembly.add_robot(text, folders, problem.urdf_path); });
    if (findings.size() == before && parts.base) {
      try {
        assembly.load_root(*parts.base);
      } catch (const AssemblyError& error) {
        map.refuse("base", error.rule(), std::string("mass: ") + error.what());
      }
    }
  } else if (!parts.base) {
    map.refuse("arms", "missing-key", "arms are mounted on a base: state robot.base.mass");
  } else {
    assembly.add_base(problem.name, *parts.base);
    for (std::size_t i = 0; i < parts.arms.size(); ++i) {
      add("arms", parts.arms[i].file,
          [&](const std::string& text) { assembly.add_arm(text, folders, parts.arms[i]); });
    }
  }
  if (findings.size() != before) return std::nullopt;
  return assembly;
}

/// Limits, drives and locks joints.
/// @param unlocked_text of the robot before any joint is locked
/// @return false with findings
bool finish_parts(MapReader& map, const RobotParts& parts, RobotAssembly& assembly,
                  std::string& unlocked_text) {
  const std::size_t before = map.context().findings.size();
  const auto say = [&map](const std::string& key, const std::string& name,
                          const AssemblyError& error) {
    map.refuse(key, error.rule(), name + ": " + error.what());
  };
  for (const auto& [name, limits] : parts.limits) {
    try {
      assembly.limit(name, limits);
    } catch (const AssemblyError& error) {
      say("limits", name, error);
    }
  }
  for (const auto& [name, rotor] : parts.rotors) {
    try {
      assembly.drive(name, rotor);
    } catch (const AssemblyError& error) {
      say("rotors", name, error);
    }
  }
  if (!parts.locked.empty()) unlocked_text = assembly.text();
  for (const auto& [name, position] : parts.locked) {
    try {
      assembly.lock(name, position);
    } catch (const AssemblyError& error) {
      say("locked", name, error);
    }
  }
  return map.context().findings.size() == before;
}

/// The model of `problem.urdf`. @param source name of the text for messages; empty: it was put
/// together, and its lines mean nothing to the user
void read_model(MapReader& map, CaptureProblem& problem, const std::string& source,
                const std::string& hand) {
  try {
    problem.robot = read_urdf(problem.urdf, source, hand);
  } catch (const InputError& error) {
    for (Finding finding : error.findings()) {
      // The hand is named here, not in the robot file.
      const bool is_hand = finding.rule.rfind("hand-", 0) == 0;
      if (is_hand || source.empty()) {
        const std::string key = is_hand ? "hand" : problem.parts.arms.empty() ? "file" : "arms";
        finding.file = map.context().source;
        finding.line = map.line_of(key);
        finding.message = map.path_of(key) + ": " + finding.message;
      }
      map.context().findings.push_back(std::move(finding));
    }
  }
}

/// Adds what read_model() remarked upon bodies, which no part of the robot says alone.
/// @param is_file the model is that of the robot file, so its lines mean something to the user
void add_body_remarks(const CaptureProblem& problem, bool is_file, std::vector<Finding>& remarks) {
  for (Finding remark : problem.robot.remarks) {
    const bool is_known = std::any_of(remarks.begin(), remarks.end(), [&](const Finding& known) {
      return known.rule == remark.rule && known.message == remark.message;
    });
    if (remark.rule != "inertia" || is_known) continue;
    remark.file = problem.urdf_path.empty() ? "robot" : problem.urdf_path;
    if (!is_file) remark.line = 0;
    remarks.push_back(std::move(remark));
  }
}

/// What the robot is before its joints are locked.
void read_unlocked(MapReader& map, const std::string& text, const RobotAssembly& assembly,
                   const RobotParts& parts, UnlockedRobot& unlocked) {
  try {
    unlocked.robot = read_geometric_model(text);
  } catch (const InputError& error) {
    for (const Finding& finding : error.findings()) {
      map.refuse("locked", finding.rule, "before they are locked: " + finding.message);
    }
  }
  for (const auto& [name, position] : parts.locked) {
    unlocked.locked[assembly.joint_named(name)] = position;
  }
}

/// Adds the pairs of an SRDF file whose links the robot has to the allowed contacts.
/// @return the only chain's last link; empty: there is none, or several
std::string read_srdf_file(MapReader& map, const std::string& name, const ProblemSources& sources,
                           const RobotAssembly& assembly, CaptureProblem& problem) {
  std::string full_path;
  const auto text = map.read_file("srdf", name, sources.folder, full_path);
  if (!text) return "";
  try {
    const Srdf srdf = read_srdf(*text, full_path);
    for (const auto& [first, second] : srdf.disabled_collisions) {
      for (const std::string& a : assembly.links_named(first)) {
        for (const std::string& b : assembly.links_named(second)) {
          if (a != b) problem.allowed_contacts.emplace_back(a, b);
        }
      }
    }
    if (srdf.chain_tips.size() != 1) return "";
    const std::vector<std::string> tips = assembly.links_named(srdf.chain_tips.front());
    return tips.size() == 1 ? tips.front() : "";
  } catch (const InputError& error) {
    std::vector<Finding>& findings = map.context().findings;
    findings.insert(findings.end(), error.findings().begin(), error.findings().end());
  }
  return "";
}

/// A rate or effort of zero means that the robot file does not know it.
void check_limits(MapReader& map, const RobotModel& robot) {
  for (const Joint& joint : robot.joints) {
    const bool slides = joint.is_prismatic();
    const auto need = [&](const char* key, double limit) {
      if (limit > 0) return;
      map.context().add(map.line_of("limits"), "no-limit",
                        fmt::format("{}.{}.{}: the robot file gives none (zero); state one",
                                    map.path_of("limits"), joint.name, key));
    };
    need("rate", joint.max_velocity);
    need(slides ? "force" : "torque", joint.max_effort);
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
  MapReader* const map = t.reader();
  RobotParts& parts = problem.parts;
  std::string hand = problem.robot.hand;
  if (t.states("arms", !parts.arms.empty())) {
    t("arms", maps_of(parts.arms, {.least = 1}),
      "arms that are mounted on the base, instead of `file`", kNeeded);
  } else {
    t("file", Text(problem.urdf_path), "URDF, relative to this file", kNeeded);
  }
  t("hand", Text(hand), "hand link",
    {.without = "that of the first arm with one, or the only link without children"});
  bool is_homogeneous = false;
  const auto base = [&] {
    t("base", Map([&](Table& m) {
        pose_fields(m, problem.base, "B", "N", kPlace);
        base_body_fields(m, parts.base, is_homogeneous);
      }),
      "stated base pose; with a `mass` the body that the arms are mounted on",
      {.frame = "N", .without = "`position` 0, `orientation` 1"});
  };
  t("package_path", WrittenIf(Texts(parts.package_path), !parts.package_path.empty()),
    "folders, relative to this file, in which packages of meshes are looked for first");
  t("collision",
    WrittenIf(Word(parts.collision, kCollisionMeshesNames),
              parts.collision != CollisionMeshes::Hull),
    "what stands for the collision meshes of the file or of all arms: `hull` one convex hull each, "
    "`decompose` at most 12 convex parts where a mesh is concave",
    {.without = "`hull`"});
  std::optional<RobotAssembly> assembly;
  std::string full_path, unlocked_text;
  if (map != nullptr) {
    base();
    const bool has_text = sources.urdf.has_value();
    if (!has_text && !map->was_refused("base") && !map->was_refused("arms") &&
        !(problem.urdf_path.empty() && parts.arms.empty())) {
      assembly = read_parts(*map, problem, sources, full_path);
    }
  }
  const RobotAssembly* const known = assembly ? &*assembly : nullptr;
  std::string srdf, tip;
  t("srdf", WrittenIf(Text(srdf), false),
    "SRDF, relative to this file: its disabled collisions join `allowed_contacts`, and the end of "
    "its "
    "only chain is the hand where none is named");
  if (assembly && !srdf.empty()) tip = read_srdf_file(*map, srdf, sources, *assembly, problem);
  t("locked", locked_of(parts.locked, known),
    "joints that keep a position, by name: their links merge into their parents, joints that "
    "follow them keep theirs",
    {.unit = "rad (deg), m", .without = "none"});
  t("limits", limits_of(parts.limits, known),
    "limits of joints by name, `{lower, upper, rate, torque or force}`, instead of the file's",
    {.without = "the file's"});
  t("rotors", rotors_of(parts.rotors),
    "drives of joints by name, `{inertia, gear_ratio}`, instead of the file's: gear ratio squared "
    "times inertia joins the joint's inertia in all dynamics",
    {.without = "the file's"});
  if (map != nullptr) {
    const bool is_good =
        !map->was_refused("locked") && !map->was_refused("limits") && !map->was_refused("rotors");
    if (sources.urdf) {
      problem.urdf = *sources.urdf;
      read_model(*map, problem, problem.urdf_path, hand);
    } else if (assembly && is_good && finish_parts(*map, parts, *assembly, unlocked_text)) {
      problem.urdf = assembly->text();
      read_model(*map, problem, assembly->is_changed() ? "" : full_path,
                 !hand.empty()               ? hand
                 : !assembly->hand().empty() ? assembly->hand()
                                             : tip);
      std::vector<Finding> remarks = assembly->remarks();
      add_body_remarks(problem, !assembly->is_changed(), remarks);
      if (is_homogeneous) {
        remarks.push_back({map->context().source, map->line_of("base"), "homogeneous",
                           "the base's inertia is that of a homogeneous body of its shape"});
      }
      problem.robot.remarks = std::move(remarks);
      if (sources.unlocked != nullptr && !unlocked_text.empty() && problem.robot.n() > 0) {
        read_unlocked(*map, unlocked_text, *assembly, parts, *sources.unlocked);
      }
    }
    if (problem.robot.n() > 0) check_limits(*map, problem.robot);
  }
  t("start", JointValues(problem.start, problem.robot, kJointPosition, kAngle, {.for_all = false}),
    "posture before the approach, within the joint limits", kNeeded);
  if (map != nullptr) check_start(*map, problem);
  if (map == nullptr) base();
  const auto from_srdf =
      map != nullptr ? problem.allowed_contacts : decltype(problem.allowed_contacts){};
  t("allowed_contacts",
    List(problem.allowed_contacts, [&](LinkPair& pair) { return Links(pair, problem.robot); },
         {.of = "[link, link]"}),
    "pairs [link, link] that may touch");
  if (map != nullptr && map->has("allowed_contacts")) {
    for (const LinkPair& pair : from_srdf) problem.allowed_contacts.push_back(pair);
  }
}

}  // namespace stillbase::io
