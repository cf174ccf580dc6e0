#include "app/page_visuals.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <utility>

#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/core/sha256.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include "app/judgement.hpp"
#include "app/page_motion.hpp"
#include "app/tool.hpp"
#include "io/fields/values.hpp"
#include "robot/mesh_thinning.hpp"
#include "robot/visual_shapes.hpp"

namespace stillbase::app {

namespace {

namespace fs = std::filesystem;
using io::Json;

constexpr std::size_t kDrawnTriangles = 10'000;

std::string base64(const std::vector<std::uint16_t>& numbers) {
  constexpr const char* kLetters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes, text;
  for (const std::uint16_t x : numbers) {
    bytes += static_cast<char>(x & 0xff);
    bytes += static_cast<char>(x >> 8);
  }
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) {
      return k < bytes.size() ? static_cast<unsigned char>(bytes[k]) : 0u;
    };
    const std::uint32_t three = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
    for (std::size_t c = 0; c < 4; ++c) {
      text += i + c > bytes.size() ? '=' : kLetters[(three >> (18 - 6 * c)) & 63];
    }
  }
  return text;
}

Json mesh_json(const Mesh& mesh) {
  Vector3d low = mesh.vertices.front(), high = low;
  for (const Vector3d& v : mesh.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  const double step = std::max((high - low).maxCoeff() / 65535, 1e-300);
  std::vector<std::uint16_t> vertices, corners;
  for (const Vector3d& v : mesh.vertices) {
    for (int k = 0; k < 3; ++k) {
      const double number = std::round((v[k] - low[k]) / step);
      vertices.push_back(static_cast<std::uint16_t>(std::clamp(number, 0.0, 65535.0)));
    }
  }
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    for (const int corner : triangle) corners.push_back(static_cast<std::uint16_t>(corner));
  }
  return {{"closed", enclosed_volume(mesh) > 0},
          {"low", rounded_list(low)},
          {"step", step},
          {"vertices", base64(vertices)},
          {"triangles", base64(corners)}};
}

Json visual_json(const urdf::VisualShape& shape, const LinkFrame& link) {
  Json out{{"body", link.body}, {"link", link.name}, {"pose", pose_json(link.pose * shape.pose)}};
  if (shape.color) out["color"] = rounded_list(*shape.color);
  if (shape.geometry) {
    Geometry geometry = *shape.geometry;
    out["geometry"] = io::geometry_of(geometry).write();
  } else {
    out["mesh"] = shape.mesh;
    out["scale"] = rounded_list(shape.scale);
  }
  return out;
}

urdf::MeshFolders folders_of(const RobotFile& file) {
  urdf::MeshFolders folders{file.path, file.package_path};
  for (std::string& folder : urdf::ros_package_path()) {
    folders.packages.push_back(std::move(folder));
  }
  return folders;
}

}  // namespace

std::vector<RobotFile> robot_files(const CaptureProblem& problem, const std::string& problem_path) {
  const fs::path folder = fs::path(problem_path).parent_path();
  std::vector<std::string> packages;
  for (const std::string& name : problem.parts.package_path) {
    packages.push_back((folder / name).string());
  }
  std::vector<RobotFile> files;
  for (const MountedArm& arm : problem.parts.arms) {
    files.push_back({(folder / arm.file).string(), arm.prefix, packages});
  }
  if (files.empty()) files.push_back({(folder / problem.urdf_path).string(), "", packages});
  return files;
}

std::vector<RobotFile> robot_files(const PlanFile& file, const std::string& plan_path) {
  const auto problem_path = problem_file_of(file, plan_path, "");
  if (!problem_path) return {};
  std::vector<RobotFile> files = robot_files(file.plan.problem, *problem_path);
  std::erase_if(files, [&](const RobotFile& robot) {
    try {
      const std::string sha256 = sha256_hex(read_text_file(robot.path, kMaxUrdfBytes));
      return std::none_of(file.inputs.begin(), file.inputs.end(), [&](const InputFile& input) {
        return input.role == "robot" && input.sha256 == sha256;
      });
    } catch (const FileError&) {
      return true;
    } catch (const InputError&) {  // too large
      return true;
    }
  });
  return files;
}

Json visuals_json(const RobotModel& robot, const std::vector<RobotFile>& files) {
  std::vector<Mesh> meshes;
  Json shapes = Json::array();
  for (const RobotFile& file : files) {
    urdf::Findings findings(file.path);
    urdf::Visuals visuals = read_visual_shapes(read_text_file(file.path, kMaxUrdfBytes),
                                               folders_of(file), kDrawnTriangles, findings);
    for (urdf::VisualShape& shape : visuals.shapes) {
      const LinkFrame* const link = find_link(robot, file.prefix + shape.link);
      if (link == nullptr) continue;  // the floating root that the reader left out
      shape.mesh += meshes.size();
      shapes.push_back(visual_json(shape, *link));
    }
    std::move(visuals.meshes.begin(), visuals.meshes.end(), std::back_inserter(meshes));
    for (const Finding& remark : findings.remarks()) say(to_string(remark));
  }
  if (shapes.empty()) return nullptr;
  thin_together(meshes, kDrawnTriangles);
  Json drawn = Json::array();
  for (const Mesh& mesh : meshes) drawn.push_back(mesh_json(mesh));
  return {{"meshes", drawn}, {"shapes", shapes}};
}

}  // namespace stillbase::app
