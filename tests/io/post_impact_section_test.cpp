// The section `post_impact`: what it may say, and what it may not.
#include <catch2/catch.hpp>

#include <stdlib.h>

#include <stillbase/core/error.hpp>
#include <stillbase/io/problem_file.hpp>

#include "io/io_support.hpp"
#include "support/temporary_folder.hpp"

using namespace stillbase;
using namespace stillbase::io_test;

namespace {

CaptureProblem read_with(
    const std::string& lines, const std::string& restitution = "0.1",
    const std::string& resistance = "{model: rotor_inertia, rotor_inertia: 5}") {
  std::string text = file_text(source_path("problems/servicer_6dof_held.yaml"));
  text = replaced(text, "restitution: 0.1", "restitution: " + restitution);
  text = replaced(text, "joint_resistance: {model: rotor_inertia, rotor_inertia: 5}",
                  "joint_resistance: " + resistance);
  text = replaced(text, "robots/", source_path("problems/robots/"));
  text = replaced(text, "targets/", source_path("problems/targets/"));
  return read_problem(TemporaryFolder().write("problem.yaml", text + lines));
}

/// The findings of a problem with these lines at the end of its last section.
std::string refusal(const std::string& lines, const std::string& restitution = "0.1",
                    const std::string& resistance = "free") {
  try {
    (void)read_with(lines, restitution, resistance);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("contact, sensors, model and thrusters are read, and the normalised copy says the same") {
  const CaptureProblem problem = read_with(R"(  control_period: 0.02 s
  contact: {model: compliant, stiffness: 2e4 N/m, damping: 30 N s/m, friction: 0.2}
  sensor: {base_rate_error: 0.01 deg/s, joint_position_error: 0.001, joint_rate_error: 0.002,
           delay: 0.04 s, seed: 7}
  model: {base_mass_scale: 1.1, arm_mass_scale: 0.9, friction_scale: 0.5}
  thrusters: {torque: 2 N m, gain: 0.5, dead_band: 0.01 deg/s}
)");
  const auto check = [](const PostImpactSpec& spec) {
    CHECK(spec.contact.model == ContactModel::Compliant);
    CHECK(spec.contact.stiffness == 2e4);
    REQUIRE(spec.contact.damping);
    CHECK(*spec.contact.damping == 30);
    CHECK(spec.contact.friction == 0.2);
    CHECK(spec.sensor.base_rate_error == Approx(1.745e-4).epsilon(1e-3));
    CHECK(spec.sensor.joint_position_error == 0.001);
    CHECK(spec.sensor.joint_rate_error == 0.002);
    CHECK(spec.sensor.delay == 0.04);
    CHECK(spec.sensor.seed == 7);
    CHECK(spec.model.base_mass_scale == 1.1);
    CHECK(spec.model.arm_mass_scale == 0.9);
    CHECK(spec.model.friction_scale == 0.5);
    CHECK(spec.thrusters.torque == 2);
    CHECK(spec.thrusters.gain == 0.5);
    CHECK(spec.thrusters.dead_band == Approx(1.745e-4).epsilon(1e-3));
  };
  check(problem.post_impact);
  const std::string copy = problem_to_json(problem);
  const CaptureProblem again = read_problem_text(copy, "copy", problem.urdf);
  check(again.post_impact);
  CHECK(problem_to_json(again) == copy);
}

TEST_CASE("wheels are stated alike by two keys or per axis by a map, and come back the same") {
  const auto wheels = [](const CaptureProblem& problem) { return problem.post_impact.wheels; };
  const auto but_for_name = [](const CaptureProblem& problem) {
    const std::string text = problem_to_json(problem);
    return text.substr(text.find("\"purpose\""));
  };
  const CaptureProblem alike = read_with("  wheel_torque: 0.2 N m\n  wheel_momentum: 4 N m s\n");
  CHECK(wheels(alike).torque == Vector3d::Constant(0.2));
  CHECK(wheels(alike).momentum == Vector3d::Constant(4));
  const CaptureProblem full = read_with("  wheels: {torque: 0.2 N m, capacity: 4 N m s}\n");
  CHECK(but_for_name(full) == but_for_name(alike));
  CHECK(problem_to_json(full).find("\"wheels\"") == std::string::npos);
  const CaptureProblem uneven =
      read_with("  wheels: {torque: [1, 0, 2], capacity: [4, 1, 5], preset: [-2, 0, 5]}\n");
  CHECK(wheels(uneven).torque == Vector3d(1, 0, 2));
  CHECK(wheels(uneven).momentum == Vector3d(4, 1, 5));
  CHECK(wheels(uneven).preset == Vector3d(-2, 0, 5));
  const std::string copy = problem_to_json(uneven);
  CHECK(copy.find("wheel_torque") == std::string::npos);
  const CaptureProblem again = read_problem_text(copy, "copy", uneven.urdf);
  CHECK(but_for_name(again) == but_for_name(uneven));
  CHECK(wheels(again).preset == Vector3d(-2, 0, 5));
}

TEST_CASE("a contact is named by a word alone, and damping follows from the restitution") {
  CHECK(read_with("  contact: compliant\n").post_impact.contact.model == ContactModel::Compliant);
  CHECK_FALSE(read_with("  contact: compliant\n").post_impact.contact.damping);
  CHECK(read_with("").post_impact.contact.model == ContactModel::Instantaneous);
}

TEST_CASE("a section that makes no sense is refused with its key") {
  struct Bad {
    const char *lines, *restitution, *resistance, *says;
  };
  const Bad bads[] = {
      {"  contact: glue\n", "0.1", "free", "post_impact.contact"},
      {"  contact: {stiffness: 1e5}\n", "0.1", "free", "post_impact.contact.model"},
      {"  contact: {model: instantaneous, stiffness: 1e6}\n", "0.1", "free", "not-used"},
      {"  contact: latch\n", "0", "free", "post_impact.contact: 'latch' moved to impact.contact"},
      {"  contact: {model: latch}\n", "0", "free", "'latch' moved to impact.contact"},
      {"  contact: jump\n", "0.1", "free", "'jump' is called 'instantaneous'"},
      {"  contact: {model: compliant, stiffness: 0}\n", "0.1", "free", "stiffness"},
      {"  contact: {model: compliant, damping: -1}\n", "0.1", "free", "damping"},
      {"  contact: {model: compliant, damping: much}\n", "0.1", "free", "damping"},
      {"  contact: {model: compliant, colour: red}\n", "0.1", "free", "colour"},
      {"  contact: compliant\n", "0", "free", "always leaves some restitution"},
      {"  contact: compliant\n", "0.1", "{model: locked, locked: all}", "locked"},
      {"  sensor: {delay: 0.015 s}\n", "0.1", "free", "whole number of control periods"},
      {"  sensor: {base_rate_error: -1}\n", "0.1", "free", "base_rate_error"},
      {"  sensor: {joint_rate_error: .nan}\n", "0.1", "free", "joint_rate_error"},
      {"  model: {arm_mass_scale: 0}\n", "0.1", "free", "arm_mass_scale"},
      {"  model: {friction_scale: -1}\n", "0.1", "free", "friction_scale"},
      {"  thrusters: {torque: -1}\n", "0.1", "free", "torque"},
      {"  thrusters: {torque: 1 kg}\n", "0.1", "free", "torque"},
      {"  thrusters: 3\n", "0.1", "free", "post_impact.thrusters"},
      {"  thrusters: {gain: 2}\n", "0.1", "free", "not-used: post_impact.thrusters.gain"},
      {"  thrusters: {torque: 0, dead_band: 1 deg/s}\n", "0.1", "free",
       "not-used: post_impact.thrusters.dead_band"},
      {"  model: {target_mass_scale: 2}\n", "0.1", "free",
       "not-used: post_impact.model.target_mass_scale"},
      {"  wheels: {torque: [1, 1]}\n", "0.1", "free", "post_impact.wheels.torque"},
      {"  wheels: {capacity: 4}\n", "0.1", "free", "post_impact.wheels.torque"},
      {"  wheels: {torque: 0}\n", "0.1", "free", "leave `wheels` out"},
      {"  wheels: {torque: 1 kg}\n", "0.1", "free", "post_impact.wheels.torque"},
      {"  wheels: {torque: 1, capacity: -4}\n", "0.1", "free", "post_impact.wheels.capacity"},
      {"  wheels: {torque: 1, capacity: 4, preset: [0, -5, 0]}\n", "0.1", "free",
       "is -5 N m s about y, above the capacity of 4 N m s"},
      {"  wheels: {torque: [1, 0, 1], capacity: [1, 1, 0]}\n", "0.1", "free",
       "is zero about z, where a wheel is"},
      {"  wheel_torque: 1\n  wheel_momentum: 0\n", "0.1", "free", "wheel_momentum"},
      {"  wheels: {torque: [1, 0, 1], preset: [0, 1, 0]}\n", "0.1", "free", "where no wheel is"},
      {"  wheels: {torque: 1}\n  wheel_torque: 1\n", "0.1", "free", "wheel_torque"},
      {"  controllers: [detumble]\n", "0.1", "free", "controllers"},
      {"  grip: {force: 10 N}\n", "0.1", "free", "not-used: post_impact.grip"},
      {"  grip: {force: 0}\n", "0.1", "free", "post_impact.grip.force"},
      {"  grip: {}\n", "0.1", "free", "missing-key: post_impact.grip: must state force"},
      {"  grip: {moment: 1 N}\n", "0.1", "free", "post_impact.grip.moment"},
      {"  contact: compliant\n  model: {target_mass_scale: 0}\n", "0.1", "free",
       "not-used: post_impact.model.target_mass_scale"},
  };
  for (const Bad& bad : bads) {
    const std::string says = refusal(bad.lines, bad.restitution, bad.resistance);
    INFO(bad.lines << says);
    CHECK(says.find(bad.says) != std::string::npos);
  }
}

TEST_CASE("a field without effect may stand at its default, as it does in every plan") {
  CHECK(refusal("  thrusters: {torque: 0, gain: 1, dead_band: 0}\n"
                "  model: {target_mass_scale: 1}\n") == "");
}

TEST_CASE("momentum that the wheels hold before goes with no approach of a floating base") {
  const std::string latch =
      replaced(replaced(file_text(source_path("problems/detumble_client_1000.yaml")), "robots/",
                        source_path("problems/robots/")),
               "targets/", source_path("problems/targets/"));
  const std::string preset =
      replaced(latch, "capacity: [10, 10, 12]", "capacity: [10, 10, 12], preset: [0.2, -0.2, 0.3]");
  const auto finding = [](const std::string& text) -> std::string {
    try {
      (void)read_problem(TemporaryFolder().write("problem.yaml", text));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const std::string floating = finding(preset);
  INFO(floating);
  CHECK(floating.find("not-supported: post_impact.wheels.preset: momentum in the wheels turns a "
                      "floating base") != std::string::npos);
  CHECK(floating.find("approach.base 'held' or 'reaction-null'") != std::string::npos);
  const std::string stated = "  base: floating\n  station_free: true\n";
  CHECK(finding(replaced(preset, stated, "  base: held\n")).empty());
  CHECK(finding(replaced(preset, stated, "  base: reaction-null\n")).empty());
  CHECK(finding(replaced(preset, "approach:\n", "approach:\n  enabled: false\n")).empty());
  // What was put in before needs no time while the robot waits.
  CHECK(finding(replaced(replaced(preset, stated, "  base: held\n"), "wait: 3 s", "wait: 0 s"))
            .empty());
}

TEST_CASE("a grip whose limits are in wrong units is told of them alone") {
  const std::string both = refusal("  grip: {force: 200 N m, moment: 100 N}\n");
  INFO(both);
  CHECK(both.find("post_impact.grip.force") != std::string::npos);
  CHECK(both.find("post_impact.grip.moment") != std::string::npos);
  CHECK(both.find("must state force, moment or both") == std::string::npos);
}
