// The key `robot.rotors`.
#include "io/problem_text.hpp"
#include "support/temporary_folder.hpp"

using namespace stillbase;
using namespace stillbase::io_test;

namespace {

/// Read from a folder, as the tool does: parts are put together from their files alone.
CaptureProblem read_with_rotors(const std::string& rotors, const std::string& resistance) {
  std::string text = replaced(kProblem, "robots/", source_path("problems/robots/"));
  text = replaced(text, "  hand: hand\n", "  hand: hand\n" + rotors);
  text = replaced(text, "{model: rotor_inertia, rotor_inertia: [0.5, 0.25]}", resistance);
  return read_problem(TemporaryFolder().write("problem.yaml", text));
}

std::string refusal_of_rotors(const std::string& rotors, const std::string& resistance = "free") {
  try {
    (void)read_with_rotors(rotors, resistance);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a problem states the drives of joints") {
  const CaptureProblem problem =
      read_with_rotors("  rotors: {joint_2: {inertia: 2e-4, gear_ratio: 50}}\n", "free");
  CHECK(problem.robot.joints[0].reflected_inertia() == 0);
  CHECK(problem.robot.joints[1].reflected_inertia() == Approx(0.5));
  CHECK(problem.urdf.find("drake:rotor_inertia value=\"0.0002\"") != std::string::npos);
  const std::string copy = problem_to_json(problem);
  CHECK(copy.find("rotors") != std::string::npos);
  const CaptureProblem again = read_problem_text(copy, "copy.yaml", problem.urdf);
  CHECK(again.robot.joints[1].reflected_inertia() == problem.robot.joints[1].reflected_inertia());
}

TEST_CASE("drives that no joint can have are refused") {
  CHECK(refusal_of_rotors("  rotors: {joint_9: {inertia: 1}}\n").find("joint_9") !=
        std::string::npos);
  CHECK(refusal_of_rotors("  rotors: {joint_2: {inertia: -1}}\n").find("inertia") !=
        std::string::npos);
  CHECK(refusal_of_rotors("  rotors: {joint_2: {inertia: .nan}}\n").find("inertia") !=
        std::string::npos);
  CHECK(refusal_of_rotors("  rotors: {joint_2: {gear_ratio: 2}}\n").find("inertia") !=
        std::string::npos);
  CHECK(
      refusal_of_rotors("  rotors: {joint_2: {inertia: 1, gear_ratio: 0}}\n").find("gear_ratio") !=
      std::string::npos);
}

TEST_CASE("a rotor is not counted twice") {
  const std::string rotors = "  rotors: {joint_2: {inertia: 2e-4, gear_ratio: 50}}\n";
  const std::string twice = "{model: rotor_inertia, rotor_inertia: {joint_1: 0.5, joint_2: 0.25}}";
  CHECK(refusal_of_rotors(rotors, twice).find("rotor_inertia.joint_2") != std::string::npos);
  CHECK(
      refusal_of_rotors(rotors, "{model: rotor_inertia, rotor_inertia: {joint_1: 0.5, joint_2: 0}}")
          .empty());
}
