// What check understands of a file, and what it finds suspicious.
#include <catch2/catch.hpp>

#include <nlohmann/json.hpp>

#include <stillbase/dynamics/kinematics.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include "cli/arm_text.hpp"
#include "cli/tool.hpp"

using namespace stillbase::cli_test;

namespace {

bool prints(const Outcome& outcome, const std::string& part) {
  INFO(outcome.out << outcome.err);
  return outcome.out.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("check tells robots, targets, problems, plans and states apart") {
  const Workshop shop;
  shop.write("problem.yaml", file_text(source_path("problems/planar_two_link_c2_a.yaml")));
  shop.write("state.json", R"({"joint_positions": [0.1, 0.2]})");
  REQUIRE(shop.run("plan problem.yaml -o plan.json").code == 0);
  const Outcome all = shop.run(
      "check robots/planar_two_link_a.urdf state.json problem.yaml targets/client_224.yaml "
      "plan.json");
  INFO(all.err << all.out);
  CHECK(all.code == 0);
  for (const char* line :
       {"planar_two_link_a.urdf: ok, a robot", "state.json: ok, a state",
        "problem.yaml: ok, a problem", "client_224.yaml: ok, a target", "plan.json: ok, a plan"}) {
    CHECK(prints(all, line));
  }
  CHECK(prints(all, "upper_edge: at (0.5, 0, 0.55) m"));

  // Alone a state is read as far as it goes.
  const Outcome alone = shop.run("check state.json problem.yaml");
  CHECK(alone.code == 0);
  CHECK(prints(alone, "ROBOT.urdf"));
  CHECK(prints(alone, "problem.yaml: ok"));
  shop.write("uneven.json", R"({"joint_positions": [0, 1], "joint_velocities": ["3 deg/s"]})");
  CHECK(shop.run("check uneven.json").code == 3);
  shop.write("stray.json", R"({"joint_positions": [0, 1], "joint_speeds": [0, 0]})");
  CHECK(shop.run("check stray.json").says("joint_speeds"));

  shop.write("other.yaml", "format: stillbase.verification\nversion: 1\n");
  const Outcome other = shop.run("check other.yaml");
  CHECK(other.code == 3);
  CHECK(other.says("stillbase.target"));
  CHECK(other.says("a state"));
  shop.write("campaign.yaml", "format: stillbase.campaign\nversion: 1\nplans: [plan.json]\n");
  CHECK(prints(shop.run("check campaign.yaml"), "1 plans, 0 problems, 1 seeds, 1000 trials each"));
  shop.write("target.yaml", "format: stillbase.target\nversion: 1\nname: x\nmodel: rigid_body\n");
  const Outcome incomplete = shop.run("check target.yaml");
  CHECK(incomplete.code == 3);
  CHECK(incomplete.says("target.yaml:1: missing-key: mass"));
}

TEST_CASE("check says what a robot is made of") {
  const Workshop shop;
  const Outcome outcome = shop.run("check robots/spart_sc_3dof.urdf");
  CHECK(outcome.code == 0);
  CHECK(prints(outcome, "4 bodies after merging fixed links, 3 joints, 130 kg"));
  CHECK(prints(outcome, "105 kg, centroid (0, 0, 0.02381) m in its frame"));
  CHECK(
      prints(outcome, "angular coupling: rank 2 in 64 of 64 random postures; largest to smallest"));
  CHECK(prints(outcome, "about 2 of 3 directions only"));
}

TEST_CASE("check remarks on what is suspicious in a robot and on nothing in a careful one") {
  const Workshop shop;
  const Outcome careful = shop.run("check robots/iiwa_on_cube.urdf");
  CHECK(careful.code == 0);
  CHECK_FALSE(prints(careful, "the centroid is at its joint"));
  CHECK_FALSE(prints(careful, "no limit"));

  shop.write_changed("bad.urdf", "problems/robots/iiwa_on_cube.urdf", "effort=\"300\"",
                     "effort=\"0\"");
  const Outcome zero = shop.run("check bad.urdf");
  CHECK(zero.code == 0);
  CHECK(prints(zero, "suspicious:"));
  CHECK(prints(zero, "its effort is limited to zero"));
}

TEST_CASE("check remarks on contact features that cannot be meant") {
  const Workshop shop;
  shop.write_changed("inward.yaml", "problems/targets/client_50.yaml", "normal: [1, 0, 0]",
                     "normal: [-1, 0, 0]");
  CHECK(prints(shop.run("check inward.yaml"), "plus_x: the normal points towards the centroid"));
  shop.write_changed("central.yaml", "problems/targets/client_50.yaml", "point: [0.3, 0.12, 0.06]",
                     "point: [0.3, 0, 0]");
  CHECK(prints(shop.run("check central.yaml"), "plus_x: the normal passes through the centroid"));
  CHECK_FALSE(prints(shop.run("check targets/client_50.yaml"), "suspicious"));
}

TEST_CASE("check prints the cone that follows from a covariance") {
  const Workshop shop;
  const Outcome outcome = shop.run("check '" + source_path("problems/ets7_client.yaml") + "'");
  INFO(outcome.err);
  CHECK(outcome.code == 0);
  CHECK(prints(outcome, "from the covariance, with probability 0.95"));
  CHECK(prints(outcome, "predicted contact at"));
  CHECK(prints(outcome, "effective mass"));
}

TEST_CASE("check prints remarks on a robot file, and refuses them with --strict") {
  const Workshop shop;
  shop.write_changed("gazebo.urdf", "problems/robots/iiwa_on_cube.urdf", "</robot>",
                     "<gazebo/></robot>");
  const Outcome check = shop.run("check gazebo.urdf");
  CHECK(check.code == 0);
  CHECK(prints(check, "not-used: <gazebo>"));
  const Outcome strict = shop.run("check gazebo.urdf --strict");
  CHECK(strict.code == 3);
  CHECK(strict.says("gazebo.urdf:"));
  CHECK(strict.says("not-used: <gazebo>"));
  CHECK(shop.run("check robots/iiwa_on_cube.urdf --strict").code == 0);
}

TEST_CASE("a plan carries the remarks on its robot file") {
  const Workshop shop;
  shop.write_changed("robots/gazebo.urdf", "problems/robots/planar_two_link_a.urdf", "</robot>",
                     "<gazebo/></robot>");
  shop.write_changed("problem.yaml", "problems/planar_two_link_c2_a.yaml",
                     "robots/planar_two_link_a.urdf", "robots/gazebo.urdf");
  REQUIRE(shop.run("plan problem.yaml -o plan.json").code == 0);
  CHECK(file_text(shop.path("plan.json")).find("\"rule\": \"not-used\"") != std::string::npos);
  CHECK(prints(shop.run("check plan.json"), "robots/gazebo.urdf:"));
  CHECK(shop.run("check plan.json --strict").code == 3);
}

TEST_CASE("a plan carries the remarks on the bodies of its robot, and verifies") {
  const Workshop shop;
  shop.write_changed("robots/rounded.urdf", "problems/robots/planar_two_link_a.urdf",
                     R"(ixx="0.333" iyy="33.3" izz="33.3")",
                     R"(ixx="0.333" iyy="33.3" izz="33.7")");
  shop.write_changed("problem.yaml", "problems/planar_two_link_c2_a.yaml",
                     "robots/planar_two_link_a.urdf", "robots/rounded.urdf");
  REQUIRE(shop.run("plan problem.yaml -o plan.json").code == 0);
  CHECK(prints(shop.run("check plan.json"), "the digits of the file"));
  CHECK(shop.run("verify plan.json").code == 0);
}

TEST_CASE("inspect prints the dynamics of an arm that has yet to be mounted") {
  const Workshop shop;
  shop.write("arm.urdf", R"(<robot name="arm"><link name="world"/><link name="link"><inertial>
<mass value="2"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="continuous"><parent link="world"/><child link="link"/></joint></robot>)");
  const Outcome inspect = shop.run("inspect arm.urdf --json");
  CHECK(inspect.code == 0);
  CHECK(prints(inspect, "\"H_phi\""));
  CHECK_FALSE(prints(inspect, "hand_inverse_inertia"));
  CHECK(shop.run("check arm.urdf").code == 0);
}

TEST_CASE("check draws what it understood, and nothing where a file is refused") {
  const Workshop shop;
  const std::string robot = "'" + source_path("problems/robots/iiwa_on_cube.urdf") + "'";
  const std::string problem = "'" + source_path("problems/iiwa_client_50.yaml") + "'";
  CHECK(shop.run("check " + robot + " " + problem + " -o page.html").code == 0);
  const std::string page = shop.text("page.html");
  CHECK(page.find("<!DOCTYPE html>") == 0);
  CHECK(page.find("iiwa_client_50") != std::string::npos);
  CHECK(shop.run("check " + robot + " -o page.html").code == 7);  // never overwrites
  shop.write("bad.yaml", "format: stillbase.problem\n");
  CHECK(shop.run("check " + robot + " bad.yaml -o bad.html").code == 3);
  CHECK_FALSE(shop.has("bad.html"));
  shop.write("state.json", "{}");
  CHECK(shop.run("check state.json -o state.html").code == 2);
}

TEST_CASE("the page of a robot with coupled joints moves each body by the joint that it follows") {
  const Workshop shop;
  shop.write("arm.urdf", robot_text(arm_chain("zyy", "") + gripper("")));
  const Outcome outcome = shop.run("check arm.urdf --hand left -o page.html");
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const std::string page = shop.text("page.html");
  const std::size_t begin = page.find("{\"stillbase\":");
  REQUIRE(begin != std::string::npos);
  const auto data = nlohmann::json::parse(page.substr(begin, page.find("</script", begin) - begin));
  const auto robot = data["documents"][0]["scene"]["robot"];
  CHECK(prints(outcome, "6 bodies after merging fixed links, 4 joints"));
  CHECK(prints(outcome, "finger_2 moves right and follows finger: position = 1 finger + 0"));
  REQUIRE(robot["joints"].size() == 4);
  REQUIRE(robot["bodies"].size() == 5);
  REQUIRE(robot["tree"].size() == 5);
  const stillbase::RobotModel model =
      stillbase::read_urdf(shop.text("arm.urdf"), "", "left", {.may_lack_base = true});
  stillbase::JointVectord phi(4);
  phi << 0.3, -0.4, 0.5, 0.03;
  const auto kinematics = stillbase::compute_kinematics<double>(model, phi);
  std::vector<stillbase::Pose> poses;
  for (const auto& moved : robot["tree"]) {
    const auto list = moved["pose"].get<std::vector<double>>();
    const stillbase::Pose at_zero{Eigen::Vector3d(list[0], list[1], list[2]),
                                  Eigen::Quaterniond(list[3], list[4], list[5], list[6])};
    const double position =
        moved.value("ratio", 1.0) * phi[moved["joint"].get<int>()] + moved.value("offset", 0.0);
    stillbase::Pose motion;
    if (moved["slides"].get<bool>()) {
      motion.position.z() = position;
    } else {
      motion.orientation = Eigen::AngleAxisd(position, Eigen::Vector3d::UnitZ());
    }
    const int parent = moved["parent"].get<int>();
    const stillbase::Pose above =
        parent < 0 ? stillbase::Pose{} : poses[static_cast<std::size_t>(parent)];
    poses.push_back(above * at_zero * motion);
  }
  for (int k = 0; k < 5; ++k) {
    INFO("body " << k);
    CHECK((poses[static_cast<std::size_t>(k)].position - kinematics.o[k]).norm() < 1e-6);
  }
}

TEST_CASE("pages draw arms by their own drawings, also those of a plan") {
  const Workshop shop;
  const auto drawn = [](const std::string& name, const std::string& geometry) {
    return "<link name=\"" + name + "\"><visual><geometry>" + geometry + "</geometry></visual>";
  };
  std::string arm = six_joint_arm();
  const auto put = [&](const std::string& name, const std::string& text) {
    const std::string link = "<link name=\"" + name + "\">";
    const std::size_t at = arm.find(link);
    REQUIRE(at != std::string::npos);
    arm.replace(at, link.size(), text);
  };
  put("link_2", drawn("link_2", "<box size=\"0.125 0.375 0.625\"/>"));
  put("link_3", drawn("link_3", "<mesh filename=\"package://none/hull.stl\"/>"));
  shop.write("arm.urdf", arm);
  shop.write("problem.yaml", R"(format: stillbase.problem
version: 1
purpose: Parts.
robot:
  base: {mass: 200 kg, shape: {box: {size: [1, 1, 1]}}}
  arms:
    - {file: arm.urdf, mount: {position: [0, 0, 0.5]}, hand: tool, prefix: r_}
  locked: {finger: 0.02 m}
  start: [0, 0.5, 1, 0, 0.5, 0]
impact: {source: given, direction: [0, 0, -1]}
objective: base_angular_velocity
approach: {enabled: false}
)");
  const Outcome plan = shop.run("plan problem.yaml -o plan.json --starts 4");
  INFO(plan.err);
  REQUIRE((plan.code == 0 || plan.code == 9));
  for (const std::string command : {"check problem.yaml -o a.html", "check plan.json -o b.html",
                                    "report plan.json -o c.html"}) {
    const Outcome outcome = shop.run(command);
    INFO(command << outcome.err);
    CHECK(outcome.code == 0);
    CHECK(outcome.says("meshes of <visual> that are not there: link_3"));
    const std::string page = shop.text(command.substr(command.size() - 6));
    CHECK(page.find(R"("link":"r_link_2","pose")") != std::string::npos);
    CHECK(page.find(R"("size":[0.125,0.375,0.625])") != std::string::npos);
  }
  // A file that is another one now is not what the plan is about.
  shop.write("arm.urdf", arm + "<!-- changed -->\n");
  const Outcome changed = shop.run("report plan.json -o d.html");
  CHECK(changed.code == 0);
  CHECK_FALSE(changed.says("visual"));
  CHECK(shop.text("d.html").find("0.375,0.625") == std::string::npos);
  // Nor is one that no robot file can be.
  shop.write("arm.urdf", std::string(3u << 20, 'x'));
  CHECK(shop.run("report plan.json -o e.html").code == 0);
}
