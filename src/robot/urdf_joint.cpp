// <joint> of a URDF file.
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>

#include "robot/urdf_element.hpp"

namespace stillbase::urdf {

namespace {

/// Sets type, is_fixed and is_free by the word of the file.
void read_type(Element& element, TreeJoint& out) {
  const std::string type = element.text("type", true);
  out.is_fixed = type == "fixed";
  out.is_free = type == "floating" || type == "planar";
  if (type == "prismatic") {
    out.joint.type = JointType::Prismatic;
  } else if (type == "continuous") {
    out.joint.type = JointType::Continuous;
  } else if (type != "revolute" && !out.is_fixed && !out.is_free && !type.empty()) {
    element.find("joint-type", fmt::format("joint {} is {}: no such type; allowed: revolute "
                                           "continuous prismatic fixed; a ball joint is three "
                                           "revolute ones on one point",
                                           in_quotes(out.joint.name), in_quotes(type)));
  }
}

constexpr double kEndless = 1e4;  // rad: 1600 turns either way, further than a problem can state

/// A rate or effort of zero limits nothing that could be planned with: most files mean that nobody
/// knew it. So do those with one below zero.
double read_bound(Element& limit, const char* attribute, const Joint& joint) {
  const double bound = limit.limit(attribute);
  if (std::isnan(bound)) return 0;
  if (!(bound < 0)) return bound;
  limit.remark(
      "negative-limit",
      fmt::format("a negative {} of <limit> is taken for one that is not stated", attribute),
      joint.name);
  return 0;
}

/// A turning joint of a range that no joint has is endless. Ranges that are not stated are zero, as
/// URDF says.
void read_limit(Element& limit, Joint& joint) {
  if (joint.type == JointType::Continuous) limit.only_remark();
  double lower = limit.limit("lower");
  double upper = limit.limit("upper");
  limit.only_remark();
  joint.max_velocity = read_bound(limit, "velocity", joint);
  joint.max_effort = read_bound(limit, "effort", joint);
  if (joint.type == JointType::Revolute && lower <= -kEndless && upper >= kEndless) {
    joint.type = JointType::Continuous;
    limit.remark("endless", "a range of 1e4 rad or more either way is taken for none", joint.name);
  }
  if (joint.max_velocity == 0) {
    limit.remark("no-rate-limit", "velocity of <limit> is zero or not stated", joint.name);
  }
  if (joint.max_effort == 0) {
    limit.remark("no-effort-limit", "effort of <limit> is zero or not stated", joint.name);
  }
  if (joint.type == JointType::Continuous) return;
  if (lower > upper) {
    std::swap(lower, upper);
    limit.remark("joint-limits",
                 "lower is above upper in <limit>: the range between them is read; a turning joint "
                 "without ends is 'continuous'",
                 joint.name);
  }
  joint.lower = std::max(lower, -kLargestNumber);
  joint.upper = std::min(upper, kLargestNumber);
  if (!limit.has("lower") || !limit.has("upper")) {
    limit.remark("joint-limits", "<limit> without lower or upper: it is 0, as URDF says",
                 joint.name);
  }
}

/// A coefficient of friction; what is none, or below zero, is taken for one that is not stated.
double read_friction(Element& dynamics, const char* attribute) {
  const double friction = dynamics.number(attribute, Sign::NonNegative, 0);
  return std::isnan(friction) ? 0 : friction;
}

void read_motion(Element& element, TreeJoint& out) {
  Joint& joint = out.joint;
  element.each("axis", 0, 1, [&](Element& axis) {
    out.axis = axis.vector("xyz", Sign::Any);
    if (out.axis.isZero(0)) axis.find("joint-axis", "<axis> xyz has no direction");
  });
  bool has_limit = false;
  element.first("limit", [&](Element& limit) {
    has_limit = true;
    read_limit(limit, joint);
  });
  if (joint.type != JointType::Continuous && !has_limit) {
    element.find(
        "joint-limits",
        fmt::format("joint {} is {} and needs <limit> with lower and upper", in_quotes(joint.name),
                    joint.is_prismatic() ? "prismatic" : "revolute"));
  }
  element.first("dynamics", [&](Element& dynamics) {
    dynamics.only_remark();
    joint.viscous_friction = read_friction(dynamics, "damping");
    joint.coulomb_friction = read_friction(dynamics, "friction");
  });
  element.each("mimic", 0, 1, [&](Element& mimic) {
    out.mimic = Mimic{mimic.text("joint", true), mimic.number("multiplier", Sign::Any, 1),
                      mimic.number("offset", Sign::Any, 0)};
  });
}

}  // namespace

TreeJoint read_joint(Element& element) {
  TreeJoint out;
  out.line = element.line();
  out.joint.name = element.text("name", true);
  read_type(element, out);
  out.origin = read_origin(element);
  element.each("parent", 1, 1, [&](Element& e) { out.parent_name = e.text("link", true); });
  element.each("child", 1, 1, [&](Element& e) { out.child_name = e.text("link", true); });
  if (out.is_fixed || out.is_free) {
    for (const char* name : {"axis", "limit", "dynamics", "mimic"}) {
      element.leave_out(name, "it has no meaning in a fixed joint");
    }
  } else {
    read_motion(element, out);
  }
  element.leave_out("calibration", "positions are those of the file");
  element.leave_out("safety_controller", "soft limits belong in the problem (joint_limit_margin)");
  return out;
}

}  // namespace stillbase::urdf
