// stillbase new: from a robot file to a verified plan in three commands.
#include <map>

#include <catch2/catch.hpp>

#include "cli/arm_text.hpp"
#include "cli/tool.hpp"

using namespace stillbase::cli_test;

namespace {

/// new, check, plan and verify with the defaults alone.
void plans_as_it_is(const Workshop& shop, const std::string& robot, const std::string& options) {
  const Outcome made = shop.run("new problem.yaml --force --robot '" + robot + "' " + options);
  INFO(robot << "\n" << made.err);
  REQUIRE(made.code == 0);
  const Outcome check = shop.run("check problem.yaml");
  INFO(check.err << shop.text("problem.yaml"));
  REQUIRE(check.code == 0);
  const Outcome plan = shop.run("plan problem.yaml --force -o plan.json");
  INFO(plan.err);
  REQUIRE(plan.code == 0);
  const Outcome verify = shop.run("verify plan.json");
  INFO(verify.err << verify.out);
  CHECK(verify.code == 0);
}

}  // namespace

TEST_CASE("every shipped arm goes from its file to a verified plan in three commands") {
  const Workshop shop;
  int arms = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source_path("problems/arms"))) {
    if (entry.path().extension() != ".urdf") continue;
    ++arms;
    plans_as_it_is(shop, entry.path().string(), "");
  }
  CHECK(arms >= 2);
}

TEST_CASE("the gain of a first problem keeps weak joints within their torque limits") {
  const Workshop shop;
  plans_as_it_is(shop, source_path("problems/robots/planar_three_link.urdf"), "");
  CHECK(shop.text("problem.yaml").find("joint_rate_gain") != std::string::npos);
}

TEST_CASE("the shipped problems with mounted arms plan and verify", "[.slow]") {
  const Workshop shop;
  for (const std::string name : {"mounted_six_joint", "mounted_seven_joint", "mounted_two_arms"}) {
    const std::string problem = "'" + source_path("problems/" + name + ".yaml") + "'";
    const Outcome plan = shop.run("plan " + problem + " -o " + name + ".json");
    INFO(name << plan.err);
    REQUIRE(plan.code == 0);
    // The plan carries hulls and parts: its files are not needed.
    const Outcome verify = shop.run("verify " + name + ".json");
    INFO(verify.err << verify.out);
    CHECK(verify.code == 0);
  }
}

TEST_CASE("arms as people have them go from their file to a verified plan") {
  // Adjacent capsules stand a centimetre and a half apart, and fingers reach beyond the hand link.
  const std::string capsule = "<capsule radius=\"0.05\" length=\"0.18\"/>";
  const std::map<std::string, std::string> arms = {
      {"gripper.urdf",
       robot_text(arm_chain("zyyzyz", capsule) + gripper("<box size=\"0.02 0.02 0.1\"/>"))},
      {"no_meshes.urdf",
       robot_text(
           arm_chain("zyzyzyz", "<mesh filename=\"package://arm_description/meshes/link.stl\"/>"))},
      {"flange.urdf",
       robot_text(arm_chain("zyyzyz", "<cylinder radius=\"0.06\" length=\"0.3\"/>", "0"))},
  };
  const Workshop shop;
  for (const auto& [name, text] : arms) {
    shop.write(name, text);
    plans_as_it_is(shop, name, "");
  }
}

TEST_CASE("arms that move their hand in a plane go from their file to a verified plan") {
  const std::map<std::string, std::string> arms = {
      {"planar_2.urdf", planar_arm(2, "0 0 1")},     {"planar_3.urdf", planar_arm(3, "0 1 0")},
      {"planar_5.urdf", planar_arm(5, "0 0 1")},     {"scara.urdf", scara_arm("0.4", "0.3")},
      {"low_scara.urdf", scara_arm("0.35", "0.25")},
  };
  const Workshop shop;
  for (const auto& [name, text] : arms) {
    shop.write(name, robot_text(text));
    plans_as_it_is(shop, name, "");
  }
}

TEST_CASE("arms of two joints go from their file to a verified plan") {
  const std::string upper = column() + lying_part("upper", "foot", "revolute", "0 0 0.4", "0 0 1");
  const std::string tool = tool_on("fore", "0.35 0 0");
  const std::map<std::string, std::string> arms = {
      {"pan_tilt.urdf",
       upper + lying_part("fore", "upper", "revolute", "0.35 0 0", "0 1 0") + tool},
      {"pan_slide.urdf",
       upper + lying_part("fore", "upper", "prismatic", "0.35 0 0", "1 0 0") + tool},
      {"slides.urdf", column() + lying_part("upper", "foot", "prismatic", "0 0 0.4", "0 0 1") +
                          lying_part("fore", "upper", "prismatic", "0.35 0 0", "1 0 0") + tool},
  };
  const Workshop shop;
  for (const auto& [name, text] : arms) {
    shop.write(name, robot_text(text));
    plans_as_it_is(shop, name, "");
    // Of joints that slide 5 % of the least range, 0.3 m.
    const bool slides = name != "pan_tilt.urdf";
    const std::string margin = slides ? "margin: 0.015  # rad, and m" : "margin: 2 deg";
    CHECK(shop.text("problem.yaml").find("  joint_limit_" + margin) != std::string::npos);
  }
}

TEST_CASE("an arm whose hand points at its foot lies on the base of a first problem") {
  const Workshop shop;
  shop.write("scara.urdf", robot_text(scara_arm("0.4", "0.3")));
  shop.write("planar.urdf", robot_text(planar_arm(3, "0 0 1")));
  const Outcome lying = shop.run("new lying.yaml --robot scara.urdf");
  INFO(lying.err);
  REQUIRE(lying.code == 0);
  CHECK(lying.says("mount: the arm lies 0.1 m above the base's +z face"));
  CHECK(shop.text("lying.yaml").find("controllers: [joint_damping,") != std::string::npos);
  const Outcome standing = shop.run("new standing.yaml --robot planar.urdf");
  REQUIRE(standing.code == 0);
  CHECK_FALSE(standing.says("the arm lies"));
  const Outcome seven = shop.run("new seven.yaml --robot '" +
                                 source_path("problems/arms/seven_joint_arm.urdf") + "'");
  REQUIRE(seven.code == 0);
  CHECK(shop.text("seven.yaml").find("controllers: [rns_damped,") != std::string::npos);
}

TEST_CASE("new says what is missing where no posture is free") {
  const Workshop shop;
  // A satellite as large as the arm's reach: the target is inside it wherever the hand is.
  std::string text = arm_chain("zyyzyz", "");
  const std::string foot = "<link name=\"foot\"/>";
  text.replace(
      text.find(foot), foot.size(),
      "<link name=\"foot\"><inertial><mass value=\"500\"/><inertia ixx=\"900\" iyy=\"900\" "
      "izz=\"900\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial><collision><geometry><box "
      "size=\"6 6 6\"/></geometry></collision></link>");
  shop.write("inside.urdf", robot_text(text));
  const Outcome made = shop.run("new inside.yaml --robot inside.urdf");
  INFO(made.err);
  CHECK(made.code == 2);
  CHECK(made.says("in each the target touches the arm or the base"));
}

TEST_CASE("new says which hand it took and refuses what it cannot use") {
  const Workshop shop;
  const std::string arm = "'" + source_path("problems/arms/seven_joint_arm.urdf") + "'";
  const Outcome made = shop.run("new problem.yaml --robot " + arm);
  INFO(made.err);
  REQUIRE(made.code == 0);
  CHECK(made.says("hand link: hand"));
  CHECK(shop.run("new problem.yaml --robot " + arm).code == 7);
  CHECK(shop.run("new other.yaml --robot " + arm + " --hand claw").code == 2);
  CHECK(shop.run("new other.yaml").code == 2);
  CHECK(shop.run("new other.json --robot " + arm).code == 2);
}

TEST_CASE("packages of meshes are looked for where the command line says") {
  const Workshop shop;
  for (const std::string name : {"arm_meshes", "hand_meshes"}) {
    std::filesystem::create_directories(shop.path(name + "/" + name));
    std::filesystem::copy(source_path("problems/arms/meshes/six_joint_upper.obj"),
                          shop.path(name + "/" + name + "/link.obj"));
  }
  shop.write("arm.urdf",
             robot_text(arm_chain("zyyzyz", "<mesh filename=\"package://arm_meshes/link.obj\"/>") +
                        gripper("<mesh filename=\"package://hand_meshes/link.obj\"/>")));
  REQUIRE(shop.run("new problem.yaml --robot arm.urdf").code == 0);
  std::string text = shop.text("problem.yaml");  // its start knows nothing of the meshes
  text.insert(text.find("approach:\n") + 10, "  enabled: false\n");
  shop.write("problem.yaml", text);
  const std::string missing = "meshes that are not there";
  const std::string arm = " --package-path arm_meshes", hand = " --package-path hand_meshes";
  const auto is_missing = [&](const Outcome& run) {
    INFO(run.err);
    CHECK(run.code == 0);
    return run.out.find(missing) != std::string::npos;
  };
  CHECK(is_missing(shop.run("check" + arm + " problem.yaml")));
  CHECK_FALSE(is_missing(shop.run("check" + arm + hand + " problem.yaml")));
  CHECK_FALSE(is_missing(shop.run("check" + arm + hand + " arm.urdf --hand tool")));
  const Outcome refused = shop.run("check problem.yaml --package-path nowhere");
  CHECK(refused.code == 2);
  CHECK(refused.says("--package-path nowhere"));
}

TEST_CASE("what a problem leaves out is printed where it is checked and planned") {
  const Workshop shop;
  const std::string arm = source_path("problems/arms/six_joint_arm.urdf");
  REQUIRE(shop.run("new problem.yaml --robot '" + arm + "'").code == 0);
  std::string text = shop.text("problem.yaml");
  for (const std::string key :
       {"purpose:", "  residual_base_rate_max:", "  attitude_change_max:"}) {
    const std::size_t at = text.find(key);
    text.erase(at, text.find('\n', at) + 1 - at);
  }
  shop.write("problem.yaml", text);
  const std::string limits =
      "base rate at most 1 deg/s after 10 s, attitude change at most 20 deg (defaults)";
  const Outcome check = shop.run("check problem.yaml");
  INFO(check.err);
  REQUIRE(check.code == 0);
  CHECK(check.out.find("problem: Capture of client.") != std::string::npos);
  CHECK(check.out.find(limits) != std::string::npos);
  const Outcome plan = shop.run("plan problem.yaml -o plan.json");
  CHECK(plan.code == 0);
  CHECK(plan.says(limits));
}

TEST_CASE("the hand's frame of a first problem stands where the shapes of its body end") {
  const Workshop shop;
  shop.write("arm.urdf", robot_text(arm_chain("zyyzyz",
                                              "<capsule radius=\"0.05\" "
                                              "length=\"0.18\"/>") +
                                    gripper("<box size=\"0.02 0.02 0.1\"/>")));
  const Outcome made = shop.run("new problem.yaml --robot arm.urdf");
  INFO(made.err);
  REQUIRE(made.code == 0);
  // A finger's joint is 0.3 m before the tool, its box ends 0.2 m before the joint.
  CHECK(made.says("the hand's frame is 0.5 m beyond tool"));
  CHECK(shop.text("problem.yaml").find("hand_frame: {position: [0, 0, 0.5]}") != std::string::npos);
}

TEST_CASE("a first problem keeps the names, folders and meshes that its robot needs") {
  const Workshop shop;
  std::filesystem::create_directories(shop.path("packages/arm_description"));
  std::filesystem::copy(source_path("problems/arms/meshes/six_joint_upper.obj"),
                        shop.path("packages/arm_description/link.obj"));
  std::string text =
      robot_text(arm_chain("zyyzyz", "<mesh filename=\"package://arm_description/link.obj\"/>"));
  const auto replace = [&](const std::string& from, const std::string& to) {
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
      text.replace(at, from.size(), to);
    }
  };
  replace("\"joint_1\"", "\"mount\"");         // the joint that fixes an arm is called so, too
  replace("\"joint_2\"", "\"arm/joint: 2\"");  // would be a map in YAML
  replace("\"link_6\"", "\"satellite\"");      // the link of the base
  shop.write("my arm, new.urdf", text);
  const Outcome made =
      shop.run("new problem.yaml --robot 'my arm, new.urdf' --package-path packages");
  INFO(made.err);
  REQUIRE(made.code == 0);
  const Outcome check = shop.run("check problem.yaml");
  INFO(check.err << shop.text("problem.yaml"));
  REQUIRE(check.code == 0);
  CHECK(check.out.find("collision shapes: 7") != std::string::npos);
}

TEST_CASE("new says what speaks against a plan for what it wrote") {
  const Workshop shop;
  const std::string arms = source_path("problems/arms/");
  const auto make = [&](const std::string& arm, const std::string& options) {
    const Outcome made =
        shop.run("new problem.yaml --force --robot '" + arms + arm + ".urdf' " + options);
    INFO(made.err);
    REQUIRE(made.code == 0);
    return made;
  };
  CHECK_FALSE(make("six_joint_arm", "").says("doubtful"));
  CHECK_FALSE(make("seven_joint_arm", "").says("doubtful"));
  // The face of a large target recedes while it turns one way, and not the other way round.
  const Outcome large = make("six_joint_arm", "--target-mass 5000 --spin 20 --distance 30");
  CHECK(shop.text("problem.yaml").find("axis: [-1, -2, -2], rate: 20 deg/s") != std::string::npos);
  CHECK(large.says("doubtful: the target turns so fast that it sweeps over the arm"));
  CHECK_FALSE(large.says("does not close in"));
  CHECK(shop.run("check problem.yaml").out.find("never") == std::string::npos);

  const Outcome near = make("seven_joint_arm", "--target-mass 0.001 --spin 0.0001 --distance 0.3");
  const std::string words = "`plan` may find no approach in time; a --distance of ";
  const std::size_t at = near.err.find(words);
  INFO(near.err);
  REQUIRE(at != std::string::npos);
  const std::string distance = near.err.substr(at + words.size(), 4);
  CHECK_FALSE(make("seven_joint_arm", "--target-mass 0.001 --spin 0.0001 --distance " + distance)
                  .says("doubtful"));
}

TEST_CASE("new refuses sizes that no problem may state by the option that says them") {
  const Workshop shop;
  const std::string arm = "'" + source_path("problems/arms/six_joint_arm.urdf") + "'";
  for (const std::string option : {"--base-mass", "--target-mass", "--spin", "--distance"}) {
    const Outcome run = shop.run("new problem.yaml --robot " + arm + " " + option + " 1e40");
    INFO(run.err);
    CHECK(run.code == 2);
    CHECK(run.says(option + " 1e+40: must be at most "));
    CHECK_FALSE(run.says("six_joint_arm.urdf"));
  }
  CHECK_FALSE(shop.has("problem.yaml"));
}
