// <transmission> of a URDF file.
#include <algorithm>

#include <fmt/format.h>

#include "robot/urdf_element.hpp"

namespace stillbase::urdf {

namespace {

struct Transmission {
  std::vector<std::string> joints;
  std::optional<double> rotor_inertia, gear_ratio;
};

Transmission read_transmission(Element& element) {
  Transmission out;
  element.look_into("joint", [&](Element& e) { out.joints.push_back(e.text("name", false)); });
  const auto read_value = [](Element& actuator, const char* name, Sign sign,
                             std::optional<double>& value) {
    actuator.look_into(name, [&](Element& e) {
      if (value) e.find("repeated-element", e.tag() + ": there is one already");
      value = e.number("value", sign);
    });
  };
  element.look_into("actuator", [&](Element& actuator) {
    read_value(actuator, "drake:rotor_inertia", Sign::NonNegative, out.rotor_inertia);
    read_value(actuator, "drake:gear_ratio", Sign::Any, out.gear_ratio);
  });
  return out;
}

}  // namespace

void read_transmissions(Element& robot, std::vector<TreeJoint>& joints) {
  std::vector<std::string> driven;
  robot.look_into("transmission", [&](Element& element) {
    const Transmission read = read_transmission(element);
    if (!read.rotor_inertia && !read.gear_ratio) {
      element.remark("not-used",
                     "<transmission>: rotors and gears belong in the problem (joint_resistance)");
      return;
    }
    if (read.joints.size() != 1) {
      element.remark("not-used", "<transmission>: a rotor of several joints, or of none");
      return;
    }
    const std::string& name = read.joints.front();
    const auto joint = std::find_if(joints.begin(), joints.end(),
                                    [&](const TreeJoint& j) { return j.joint.name == name; });
    if (joint == joints.end()) {
      element.find("transmission",
                   fmt::format("the rotor of joint {}: there is no such joint", in_quotes(name)));
      return;
    }
    if (joint->is_fixed || joint->is_free) {
      element.remark("not-used", "<transmission>: the rotor of a joint that is fixed or free",
                     name);
      return;
    }
    if (std::find(driven.begin(), driven.end(), name) != driven.end()) {
      element.find("repeated-element",
                   fmt::format("joint {} has a rotor already", in_quotes(name)));
      return;
    }
    driven.push_back(name);
    joint->joint.rotor_inertia = read.rotor_inertia.value_or(0);
    joint->joint.gear_ratio = read.gear_ratio.value_or(1);
    if (!(joint->joint.reflected_inertia() <= kLargestNumber)) {
      element.find("transmission",
                   fmt::format("joint {}: gear ratio squared times rotor inertia is too large",
                               in_quotes(name)));
    }
  });
}

}  // namespace stillbase::urdf
