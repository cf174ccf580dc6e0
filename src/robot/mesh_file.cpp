#include "robot/mesh_file.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <stillbase/core/file.hpp>

#include "robot/mesh_text.hpp"
#include "robot/obj_file.hpp"
#include "robot/ply_file.hpp"
#include "robot/scene_file.hpp"
#include "robot/stl_file.hpp"

namespace stillbase {

namespace {

namespace fs = std::filesystem;

/// In lower case.
std::string ending_of(const std::string& path) {
  std::string ending = fs::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

}  // namespace

std::string why_unread(const std::string& path) {
  const auto kinds = {".3ds",  ".3mf",  ".blend", ".fbx",  ".iges", ".igs", ".iv",
                      ".mesh", ".msh",  ".off",   ".step", ".stlb", ".stp", ".usd",
                      ".usda", ".usdc", ".usdz",  ".vrml", ".wrl",  ".x",   ".x3d"};
  const std::string ending = ending_of(path);
  if (std::find(kinds.begin(), kinds.end(), ending) != kinds.end()) {
    return fmt::format("{} is not read", ending);
  }
  constexpr std::string_view kPointer = "version https://git-lfs";
  std::string begin(kPointer.size(), '\0');
  std::error_code fault;
  if (fs::is_regular_file(path, fault) &&
      std::ifstream(path, std::ios::binary)
          .read(begin.data(), static_cast<std::streamsize>(begin.size())) &&
      begin == kPointer) {
    return "a pointer of Git LFS: `git lfs pull` fetches the file";
  }
  return "";
}

Mesh read_mesh_text(std::string_view text, const std::string& ending) {
  if (ending == ".stl") return read_stl(text);
  if (ending == ".obj") return read_obj(without_byte_order_mark(text));
  return read_ply(text);
}

Mesh read_mesh(const std::string& path) {
  const std::string ending = ending_of(path);
  const auto kinds = {".stl", ".obj", ".dae", ".gltf", ".glb", ".ply"};
  if (std::find(kinds.begin(), kinds.end(), ending) == kinds.end()) {
    throw std::runtime_error("is no STL, OBJ, COLLADA (.dae), glTF or PLY file");
  }
  std::error_code fault;
  if (!fs::is_regular_file(path, fault) || fault) throw std::runtime_error("is no file");
  const std::uintmax_t size = fs::file_size(path, fault);
  if (size > kMaxMeshBytes || fault) {
    throw std::runtime_error(fmt::format("is larger than {} MiB", kMaxMeshBytes >> 20));
  }
  // Workspaces hold symbolic links to the meshes of their packages.
  const std::string real = fs::canonical(path, fault).string();
  if (fault) throw std::runtime_error("cannot be opened");
  Mesh mesh = ending == ".dae" || ending == ".gltf" || ending == ".glb"
                  ? read_scene(real)
                  : read_mesh_text(read_text_file(real, kMaxMeshBytes), ending);
  if (mesh.triangles.empty()) throw std::runtime_error("has no faces");
  return mesh;
}

double enclosed_volume(const Mesh& mesh) {
  double volume = 0, area = 0;
  Vector3d open = Vector3d::Zero();  // of closed triangles the area vectors add up to zero
  const Vector3d& origin = mesh.vertices.front();
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    const auto corner = [&](int c) -> Vector3d {
      return mesh.vertices[static_cast<std::size_t>(triangle[static_cast<std::size_t>(c)])] -
             origin;
    };
    const Vector3d a = corner(0), b = corner(1), c = corner(2);
    const Vector3d normal = (b - a).cross(c - a) / 2;
    open += normal;
    area += normal.norm();
    volume += a.dot(b.cross(c)) / 6;
  }
  return open.norm() <= 1e-3 * area ? std::max(volume, 0.0) : 0;
}

}  // namespace stillbase
