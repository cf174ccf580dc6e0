// The readers of files as the fuzzer and the replay of its corpus call them: a text is accepted or
// refused with findings. Anything else is a fault: another exception, a crash, numbers that are
// not finite, a copy that does not read back.
#pragma once

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <stillbase/core/error.hpp>
#include <stillbase/io/benchmark_file.hpp>
#include <stillbase/io/campaign_file.hpp>
#include <stillbase/io/estimate_file.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/io/state_file.hpp>
#include <stillbase/io/target_file.hpp>
#include <stillbase/io/verification_file.hpp>
#include <stillbase/robot/suspicions.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include "io/fields/sections.hpp"
#include "robot/assembly.hpp"
#include "robot/mesh_file.hpp"
#include "robot/mesh_text.hpp"
#include "robot/mesh_thinning.hpp"
#include "robot/scene_file.hpp"
#include "robot/srdf_reader.hpp"
#include "support/temporary_folder.hpp"

namespace stillbase::fuzz {

inline void require(bool is_sound, const char* fault) {
  if (!is_sound) throw std::logic_error(fault);
}

/// @return whether `read` accepted; false: it refused with findings
template <class Read>
bool accepts(Read read) {
  try {
    read();
    return true;
  } catch (const InputError& error) {
    require(!error.findings().empty(), "refused without a finding");
    return false;
  }
}

/// The same, and what is accepted and written reads back to the same text.
template <class Read, class Write>
bool accepts_and_copies(std::string_view text, Read read, Write write) {
  std::string copy;
  if (!accepts([&] { copy = write(read(text)); })) return false;
  try {
    require(write(read(copy)) == copy, "the copy of an accepted text reads differently");
  } catch (const InputError& error) {
    throw std::logic_error(std::string("the copy of an accepted text is refused: ") + error.what());
  }
  return true;
}

/// The robot of every problem and state of the corpus: two joints on a base, a hand.
inline const std::string& robot_text() {
  static const std::string text = R"(<robot name="r">
<link name="base"><inertial><mass value="100"/>
<inertia ixx="10" iyy="10" izz="10" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="link_1"><inertial><origin xyz="0.5 0 0"/><mass value="10"/>
<inertia ixx="0.1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="link_2"><inertial><origin xyz="0.5 0 0"/><mass value="10"/>
<inertia ixx="0.1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="hand"/>
<joint name="joint_1" type="revolute"><parent link="base"/><child link="link_1"/>
<origin xyz="1 0 0"/><axis xyz="0 0 1"/><limit lower="-3" upper="3" velocity="1" effort="9"/></joint>
<joint name="joint_2" type="prismatic"><parent link="link_1"/><child link="link_2"/>
<origin xyz="1 0 0"/><axis xyz="1 0 0"/><limit lower="0" upper="1" velocity="1" effort="9"/></joint>
<joint name="tip" type="fixed"><parent link="link_2"/><child link="hand"/><origin xyz="1 0 0"/></joint>
</robot>)";
  return text;
}

inline bool urdf(std::string_view text) {
  return accepts([&] {
    const RobotModel robot = read_urdf(text, "fuzz.urdf", "");
    require(std::isfinite(robot.total_mass()) && robot.base.inertia.allFinite() &&
                robot.joints.size() == robot.bodies.size() && robot.p_hand.allFinite(),
            "an unsound robot was accepted");
    for (const Body& body : robot.bodies) {
      require(body.mass > 0 && body.inertia.allFinite() && body.centroid.allFinite(),
              "an unsound body was accepted");
    }
    robot_suspicions(robot);
  });
}

inline bool srdf(std::string_view text) {
  return accepts([&] { read_srdf(text, "fuzz.srdf"); });
}

/// Ending of the mesh format that a text looks like.
inline std::string mesh_ending(std::string_view text) {
  if (text.starts_with("ply")) return ".ply";
  if (text.starts_with("solid") || text.substr(0, 84).find('\0') != text.npos) return ".stl";
  return ".obj";
}

inline std::string scene_ending(std::string_view text) {
  if (text.starts_with("glTF")) return ".glb";
  return text.starts_with("{") ? ".gltf" : ".dae";
}

/// A robot with one mesh, scaled and mirrored.
inline std::string robot_with_mesh(const std::string& file) {
  return R"(<robot name="r"><link name="a"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><mesh filename=")" +
         file + R"(" scale="1 -2 0.5"/></geometry></collision></link></robot>)";
}

/// A mesh is read from its file by a robot that names it: half of the texts become one hull, half
/// of them parts. The text with hulls that a plan carries must be one of a robot.
inline bool robot_takes_mesh(std::string_view text, const std::string& ending) {
  static const TemporaryFolder folder;
  const std::string name = "mesh" + ending;
  std::ofstream(folder.path(name), std::ios::binary) << text;
  RobotAssembly assembly(text.size() % 2 == 0 ? CollisionMeshes::Hull : CollisionMeshes::Decompose);
  if (!accepts([&] {
        assembly.add_robot(robot_with_mesh(name), {folder.path("robot.urdf"), {}}, "robot.urdf");
      })) {
    return false;
  }
  if (!assembly.is_changed()) return true;  // a mesh that is not read, which is no fault
  require(accepts([&] { read_urdf(assembly.text(), "fuzz.urdf", ""); }),
          "the hulls of an accepted mesh are refused");
  return true;
}

/// The text of a STL, OBJ or PLY file; behind "MESH" what a child returns that has read another
/// format.
inline bool mesh(std::string_view text) {
  Mesh mesh;
  try {
    mesh = text.starts_with("MESH") ? mesh_of_bytes(text.substr(4))
                                    : read_mesh_text(text, mesh_ending(text));
  } catch (const std::runtime_error&) {
    return false;
  }
  for (const Vector3d& vertex : mesh.vertices) {
    require(vertex.cwiseAbs().maxCoeff() <= kMaxMeshCoordinate, "an unsound vertex was accepted");
  }
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    for (const int corner : triangle) {
      require(corner >= 0 && static_cast<std::size_t>(corner) < mesh.vertices.size(),
              "an unsound triangle was accepted");
    }
  }
  if (mesh.triangles.empty()) return false;
  require(std::isfinite(enclosed_volume(mesh)), "the volume of a mesh is not finite");
  return true;
}

/// The same files as collision shapes of a robot, and thinned as a page draws them.
inline bool collision(std::string_view text) {
  if (!robot_takes_mesh(text, mesh_ending(text))) return false;
  if (text.starts_with("version https://git-lfs")) return true;  // which is no mesh
  require(thinned(read_mesh_text(text, mesh_ending(text)), 10).triangles.size() <= 10,
          "a thinned mesh has too many triangles");
  return true;
}

/// COLLADA and glTF files, which Assimp reads in a child: the fuzzer does not see into it.
inline bool scene(std::string_view text) { return robot_takes_mesh(text, scene_ending(text)); }

inline bool problem(std::string_view text) {
  return accepts_and_copies(
      text,
      [](std::string_view from) { return read_problem_text(from, "fuzz.yaml", robot_text()); },
      problem_to_json);
}

inline bool target(std::string_view text) {
  return accepts([&] {
    const TargetBody body = read_target_text(text, "fuzz.yaml");
    require(body.mass > 0 && std::isfinite(body.mass) && body.inertia.allFinite() &&
                body.inverse_inertia().allFinite(),
            "an unsound target was accepted");
    for (const ContactFeature& feature : body.features) {
      require(feature.point.allFinite() && std::abs(feature.normal.norm() - 1) < 1e-9,
              "an unsound feature was accepted");
    }
  });
}

inline bool state(std::string_view text) {
  static const RobotModel robot = read_urdf(robot_text(), "robot.urdf", "");
  return accepts([&] {
    const RobotState state = read_state(text, "fuzz.json", robot);
    require(state.phi.size() == robot.n() && state.phidot.size() == robot.n() &&
                state.phi.allFinite() && state.phidot.allFinite() && state.Omega.allFinite() &&
                (!state.Fbar || state.Fbar->allFinite()),
            "an unsound state was accepted");
  });
}

inline bool estimates(std::string_view text) {
  return accepts([&] {
    for (const StateEstimate& estimate : read_estimates_text(std::string(text), "fuzz.csv")) {
      const TargetState& state = estimate.state;
      require(std::isfinite(state.time) && state.pose.position.allFinite() &&
                  state.linear_velocity.allFinite() && state.angular_velocity.allFinite(),
              "an unsound estimate was accepted");
    }
  });
}

inline bool plan(std::string_view text) {
  return accepts_and_copies(
      text, [](std::string_view from) { return read_plan(from, "fuzz.plan.json"); },
      [](const PlanFile& file) { return plan_to_json(file.plan, file.tool, {}, file.inputs); });
}

/// Without the problem files that it names.
inline bool suite(std::string_view text) {
  return accepts([&] {
    SuiteSpec suite;
    io::read_map(text, "fuzz.yaml",
                 [&](io::Table& table) { io::suite_fields(table, suite, std::nullopt); });
    require(std::isfinite(suite.gradient_cost), "an unsound suite was accepted");
  });
}

inline bool campaign(std::string_view text) {
  return accepts([&] { read_campaign_spec(std::string(text), "fuzz.yaml"); });
}

inline bool campaign_case(std::string_view text) {
  return accepts_and_copies(
      text, [](std::string_view from) { return case_from_text(std::string(from)); }, case_to_text);
}

inline bool case_result(std::string_view text) {
  return accepts_and_copies(
      text, [](std::string_view from) { return case_result_from_text(std::string(from)); },
      case_result_to_text);
}

inline bool outcomes(std::string_view text) {
  return accepts_and_copies(
      text, [](std::string_view from) { return trial_outcomes_from_text(std::string(from)); },
      trial_outcomes_to_text);
}

inline bool request(std::string_view text) {
  return accepts_and_copies(text, request_from_text, request_to_text);
}

inline bool records(std::string_view text) {
  return accepts_and_copies(
      text, [](std::string_view from) { return read_records(from, "fuzz.jsonl"); },
      [](const std::vector<RunRecord>& records) {
        std::string lines;
        for (const RunRecord& record : records) lines += record_to_text(record, "a host") + "\n";
        return lines;
      });
}

inline bool best_known(std::string_view text) {
  return accepts_and_copies(
      text, [](std::string_view from) { return read_best_known(from, "fuzz.json"); },
      best_known_to_json);
}

inline bool references(std::string_view text) {
  return accepts_and_copies(
      text, [](std::string_view from) { return read_bench_references(from, "fuzz.json"); },
      bench_references_to_json);
}

struct Reader {
  const char* name;  ///< also of its folder in corpus/
  bool (*accepts)(std::string_view text);
};

inline constexpr Reader kReaders[] = {{"urdf", urdf},
                                      {"srdf", srdf},
                                      {"mesh", mesh},
                                      {"collision", collision},
                                      {"scene", scene},
                                      {"problem", problem},
                                      {"target", target},
                                      {"state", state},
                                      {"estimates", estimates},
                                      {"plan", plan},
                                      {"suite", suite},
                                      {"campaign", campaign},
                                      {"campaign_case", campaign_case},
                                      {"request", request},
                                      {"case_result", case_result},
                                      {"outcomes", outcomes},
                                      {"records", records},
                                      {"best_known", best_known},
                                      {"references", references}};

}  // namespace stillbase::fuzz
