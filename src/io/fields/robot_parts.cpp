// The parts of a robot that a problem puts together.
#include <fmt/format.h>

#include "io/fields/sections.hpp"
#include "robot/assembly.hpp"

namespace stillbase::io {

namespace {

using PlacedShape = std::pair<Pose, Geometry>;

Map placed_shape_of(PlacedShape& shape) {
  return Map([&shape](Table& t) {
    pose_fields(t, shape.first, "the shape", "base body");
    t("geometry", geometry_of(shape.second), "geometry, in m", kNeeded);
  });
}

/// What a joint's values are measured in; of any joint while nothing is known of it.
enum class JointKind { Any, Turning, Sliding };

JointKind kind_of(const std::string& name, const RobotAssembly* assembly) {
  if (assembly == nullptr) return JointKind::Any;
  try {
    const std::string full = assembly->joint_named(name);
    for (const urdf::TreeJoint& joint : assembly->joints()) {
      if (joint.joint.name != full) continue;
      return joint.joint.is_prismatic() ? JointKind::Sliding : JointKind::Turning;
    }
  } catch (const AssemblyError&) {  // said where the joint is used
  }
  return JointKind::Any;
}

Dimension position_of(JointKind kind) {
  return kind == JointKind::Any       ? Dimension::JointPosition
         : kind == JointKind::Sliding ? Dimension::Length
                                      : Dimension::Angle;
}

Map limits_map(JointLimits& limits, JointKind kind) {
  return Map([&limits, kind](Table& t) {
    t("lower", Number(limits.lower, position_of(kind)), "lower end of the range",
      {.without = "the file's"});
    t("upper", Number(limits.upper, position_of(kind)), "upper end of the range",
      {.without = "the file's"});
    t("rate",
      Number(limits.rate,
             kind == JointKind::Sliding ? Dimension::Velocity : Dimension::AngularVelocity,
             kPositive),
      "of a prismatic joint in m/s", {.without = "the file's"});
    t("torque", Number(limits.torque, Dimension::Moment, kPositive), "of a revolute joint",
      {.without = "the file's"});
    t("force", Number(limits.force, Dimension::Force, kPositive), "of a prismatic joint",
      {.without = "the file's"});
  });
}

Map rotor_map(JointRotor& rotor) {
  return Map([&rotor](Table& t) {
    t("inertia", Number(rotor.inertia, Dimension::Inertia, kLarge),
      "of the rotor about its own axis", kNeeded);
    t("gear_ratio", Number(rotor.gear_ratio, kLargePositive),
      "rate of the rotor per rate of the joint, of a prismatic joint in rad/m");
  });
}

template <class T>
std::vector<std::string> keys_of(const std::map<std::string, T>& map) {
  std::vector<std::string> keys;
  for (const auto& entry : map) keys.push_back(entry.first);
  return keys;
}

}  // namespace

void base_body_fields(Table& t, std::optional<BaseBody>& body, bool& is_homogeneous) {
  const bool is_stated = t.states("mass", body.has_value());
  BaseBody stated = body.value_or(BaseBody{});
  const auto of_body = [&](const Value& value) { return WrittenIf(value, body.has_value()); };
  About about{.without = "the robot file's root link"};
  t("mass", of_body(Number(stated.mass, Dimension::Mass, kSensible)),
    "of the body that the arms are mounted on", about);
  about = {.without = "that of `shape`", .is_used = is_stated, .owner = "a `mass`"};
  t("inertia", of_body(Map([&](Table& m) { inertia_fields(m, stated.inertia); })),
    "`{ixx, iyy, izz, ixy, ixz, iyz}` about its centroid, in kg m^2", about);
  Geometry geometry = Sphere{0};
  bool has_shape = false;
  t("shape", Shorthand(geometry_of(geometry), [&] { has_shape = true; }),
    "a homogeneous body of this geometry: its inertia, and a collision shape",
    {.without = "none", .is_used = is_stated, .owner = "a `mass`"});
  t("shapes",
    of_body(List(
        stated.shapes, [](PlacedShape& shape) { return placed_shape_of(shape); }, {},
        PlacedShape{{}, Sphere{0}})),
    "further collision shapes: appendages", {.is_used = is_stated, .owner = "a `mass`"});
  MapReader* map = t.reader();
  if (map == nullptr || !is_stated) return;
  if (has_shape) {
    stated.shapes.insert(stated.shapes.begin(), {Pose{}, geometry});
    is_homogeneous = !map->has("inertia");
  } else if (!map->has("inertia")) {
    map->refuse("mass", "missing-key", "needs `inertia`, or a `shape` that is homogeneous");
  }
  if (is_homogeneous && std::holds_alternative<ConvexMesh>(geometry)) {
    map->refuse("shape", "missing-key", "the inertia of a mesh must be stated");
  } else if (is_homogeneous && !map->was_refused("shape")) {
    stated.inertia = homogeneous_inertia(stated.mass, geometry);
  }
  body = std::move(stated);
}

void fields(Table& t, MountedArm& arm) {
  t("file", Text(arm.file), "URDF of the arm, relative to this file", kNeeded);
  t("prefix", Text(arm.prefix), "put before the names of its links and joints");
  t("mount", Map([&arm](Table& m) { pose_fields(m, arm.mount, "its root link", "base body"); }),
    "place of its root link on the base", {.without = "the base's origin"});
  t("hand", Text(arm.hand), "its hand link, without prefix; the first arm with one captures",
    {.without = "none"});
  Pose frame = arm.hand_frame.value_or(Pose{});
  t("hand_frame",
    WrittenIf(Map([&frame](Table& m) { pose_fields(m, frame, "the hand's frame", "hand link"); }),
              arm.hand_frame.has_value()),
    "frame of the hand in that link", {.without = "the link's own"});
  if (t.reader() != nullptr && t.reader()->has("hand_frame")) arm.hand_frame = frame;
}

Value locked_of(std::map<std::string, double>& locked, const RobotAssembly* assembly) {
  return WrittenIf(DictionaryValue([&locked] { return keys_of(locked); },
                                   [&locked, assembly](const std::string& key) {
                                     return Number(locked[key],
                                                   position_of(kind_of(key, assembly)));
                                   },
                                   [] {
                                     static double sample = 0;
                                     return Number(sample, Dimension::JointPosition);
                                   }),
                   !locked.empty());
}

Value limits_of(std::map<std::string, JointLimits>& limits, const RobotAssembly* assembly) {
  return WrittenIf(DictionaryValue([&limits] { return keys_of(limits); },
                                   [&limits, assembly](const std::string& key) {
                                     return limits_map(limits[key], kind_of(key, assembly));
                                   },
                                   [] {
                                     static JointLimits sample;
                                     return limits_map(sample, JointKind::Any);
                                   }),
                   !limits.empty());
}

Value rotors_of(std::map<std::string, JointRotor>& rotors) {
  return WrittenIf(
      DictionaryValue([&rotors] { return keys_of(rotors); },
                      [&rotors](const std::string& key) { return rotor_map(rotors[key]); },
                      [] {
                        static JointRotor sample;
                        return rotor_map(sample);
                      }),
      !rotors.empty());
}

}  // namespace stillbase::io
