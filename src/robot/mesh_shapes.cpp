#include "robot/mesh_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>

#include "robot/convex_hull.hpp"
#include "robot/mesh_parts.hpp"

namespace stillbase::urdf {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostFoldersUp = 8;  ///< from a robot file to the folder of its packages

bool is_there(const fs::path& path) {
  std::error_code fault;
  const fs::file_status status = fs::status(path, fault);
  if (fault == std::errc::too_many_symbolic_link_levels) {
    throw PathError(fmt::format("{}: symbolic links in a circle", path.string()));
  }
  return fs::exists(status);
}

/// `name` below `folder` if it is there; it must not climb out of `root`.
fs::path find_below(const fs::path& folder, const std::string& name, const fs::path& root) {
  const fs::path path = (folder / name).lexically_normal();
  if (!is_there(path)) return {};
  const fs::path relative = path.lexically_relative(root.lexically_normal());
  if (relative.empty() || *relative.begin() == "..") {
    throw PathError(
        fmt::format("the path {} leaves the folder {}", in_quotes(name), root.string()));
  }
  return path;
}

std::vector<fs::path> folders_up_from(const fs::path& file) {
  std::vector<fs::path> folders;
  fs::path folder = fs::absolute(file).lexically_normal().parent_path();
  while (folders.size() < kMostFoldersUp) {
    folders.push_back(folder);
    if (folder == folder.parent_path()) break;
    folder = folder.parent_path();
  }
  return folders;
}

/// Path of a file of a package; empty: there is none.
fs::path find_in_package(const std::string& package, const std::string& name,
                         const MeshFolders& folders) {
  std::vector<fs::path> packages;
  for (const fs::path& folder : folders_up_from(folders.robot_file)) {
    if (folder.filename() == package) packages.push_back(folder);
    packages.push_back(folder / package);
  }
  for (const std::string& given : folders.packages) {
    const fs::path folder = fs::absolute(given).lexically_normal();
    if (folder.filename() == package) packages.push_back(folder);
    packages.push_back(folder / package);
  }
  for (const fs::path& folder : packages) {
    const fs::path path = find_below(folder, name, folder);
    if (!path.empty()) return path;
  }
  return {};
}

/// The folder that relative names may not leave: that of the package, or the one above the file,
/// since urdf/ and meshes/ lie side by side.
fs::path root_of(const std::string& robot_file) {
  const std::vector<fs::path> folders = folders_up_from(robot_file);
  for (const fs::path& folder : folders) {
    if (is_there(folder / "package.xml")) return folder;
  }
  return folders.size() > 1 ? folders[1] : folders[0];
}

/// A mirrored mesh keeps its outside: its triangles turn round.
/// @throws std::runtime_error beyond kFarthestVertex, smaller than kSmallestMesh
Mesh scaled(Mesh mesh, const Vector3d& scale) {
  Vector3d lower = Vector3d::Constant(kInfinity), upper = -lower;
  for (Vector3d& vertex : mesh.vertices) {
    vertex = vertex.cwiseProduct(scale);
    lower = lower.cwiseMin(vertex);
    upper = upper.cwiseMax(vertex);
  }
  const double farthest = std::max(-lower.minCoeff(), upper.maxCoeff());
  if (!(farthest <= kFarthestVertex)) {
    throw std::runtime_error(fmt::format(
        "reaches {:.3g} m from its own origin, with its scale; {:g} m are allowed: is it in other "
        "units than m?",
        farthest, kFarthestVertex));
  }
  const double size = (upper - lower).maxCoeff();
  if (size > 0 && size < kSmallestMesh) {
    throw std::runtime_error(fmt::format(
        "is {:.3g} m large, with its scale; {:g} m is the smallest size: is it in other units than "
        "m?",
        size, kSmallestMesh));
  }
  if (scale.prod() < 0) {
    for (std::array<int, 3>& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  }
  return mesh;
}

/// Puts one hull or several around a mesh; remarks on those that are much larger than it.
void enclose(const Mesh& mesh, CollisionMeshes collision, const std::string& link, MeshUse& use,
             Findings& findings) {
  constexpr double kWorthSaying = 1.3;  // times the volume: a hole or a notch of a quarter
  std::vector<EnclosingHull> hulls;
  if (collision == CollisionMeshes::Decompose) {
    hulls = convex_parts(mesh);
  } else {
    hulls.push_back(enclosing_hull(mesh.vertices));
  }
  double together = 0;
  for (EnclosingHull& hull : hulls) {
    together += hull.volume;
    use.hulls.push_back(std::move(hull.mesh));
  }
  const double volume = enclosed_volume(mesh);
  const double times = volume > 0 ? together / volume : 1;
  if (hulls.size() > 1) {
    const std::string size = volume > 0 ? fmt::format(", {:.3g} times its volume", times) : "";
    findings.remark(use.line, "parts", "concave meshes are split into convex parts",
                    fmt::format("{} ({} parts{})", link, hulls.size(), size));
  } else if (times > kWorthSaying) {
    findings.remark(use.line, "hull",
                    collision == CollisionMeshes::Hull
                        ? "the hull is larger than its mesh (in a problem, `robot.collision: "
                          "decompose` splits it into convex parts)"
                        : "the hull is larger than its mesh, and parts are no smaller",
                    fmt::format("{} ({:.3g} times)", link, times));
  }
}

}  // namespace

Mesh MeshReader::read(const std::string& path) {
  if (has_met_limit_) {
    throw std::runtime_error("is not read, since an earlier one took too long or too much memory");
  }
  try {
    return read_mesh(path);
  } catch (const MeshLimitError&) {
    has_met_limit_ = true;
    throw;
  }
}

const Mesh& MeshFiles::read(const std::string& path) {
  const auto [at, is_new] = files_.try_emplace(path);
  File& file = at->second;
  if (is_new) {
    try {
      file.mesh = reader_.read(path);
    } catch (const std::exception& error) {
      file.fault = error.what();
    }
  }
  if (!file.fault.empty()) throw std::runtime_error(file.fault);
  return file.mesh;
}

fs::path find_mesh(const std::string& written, const MeshFolders& folders) {
  std::string name = written;
  std::replace(name.begin(), name.end(), '\\', '/');  // of exporters under Windows
  for (const char* scheme : {"package://", "model://"}) {
    if (!name.starts_with(scheme)) continue;
    const std::string path = name.substr(std::string(scheme).size());
    const std::size_t slash = path.find('/');
    if (slash == std::string::npos) return {};
    return find_in_package(path.substr(0, slash), path.substr(slash + 1), folders);
  }
  std::string path = name;
  if (name.starts_with("file://")) {
    path = name.substr(7);
  } else if (name.find("://") != std::string::npos) {
    return {};  // of the net
  }
  if (fs::path(path).is_absolute()) {
    const fs::path full = fs::path(path).lexically_normal();
    return is_there(full) ? full : fs::path();
  }
  const std::vector<fs::path> above = folders_up_from(folders.robot_file);
  const fs::path full = find_below(above[0], path, root_of(folders.robot_file));
  if (!full.empty()) return full;
  // Some files are written for programs that start in a folder above.
  for (std::size_t i = 1; i < std::min<std::size_t>(above.size(), 3); ++i) {
    const fs::path other = (above[i] / path).lexically_normal();
    if (path.find("..") == std::string::npos && is_there(other)) return other;
  }
  return {};
}

std::vector<std::string> ros_package_path() {
  std::vector<std::string> folders;
  const char* const list = std::getenv("ROS_PACKAGE_PATH");
  std::string text = list == nullptr ? "" : list;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(':'), text.size());
    if (end > 0) folders.push_back(text.substr(0, end));
    text.erase(0, end + 1);
  }
  return folders;
}

void put_before_ros_package_path(const std::vector<std::string>& folders) {
  if (folders.empty()) return;
  std::string list;
  for (const std::string& folder : folders) list += fs::absolute(folder).string() + ':';
  for (const std::string& folder : ros_package_path()) list += folder + ':';
  list.pop_back();
  setenv("ROS_PACKAGE_PATH", list.c_str(), 1);
}

bool enclose_meshes(Tree& tree, const MeshFolders& folders, CollisionMeshes collision,
                    Findings& findings) {
  MeshFiles files;
  bool has_hull = false;
  for (TreeLink& link : tree.links) {
    for (MeshUse& use : link.meshes) {
      if (!use.hulls.empty()) {
        has_hull = true;
        if (collision == CollisionMeshes::Decompose) {
          findings.remark(use.line, "hull",
                          "the file gives the hulls of these meshes: `decompose` leaves them",
                          link.name);
        }
        continue;
      }
      try {
        const fs::path path = find_mesh(use.file, folders);
        if (path.empty()) {
          findings.remark(use.line, "mesh",
                          "meshes that are not there: clearance does not cover these links",
                          fmt::format("{} ({})", link.name, use.file));
          continue;
        }
        if (const std::string why = why_unread(path.string()); !why.empty()) {
          findings.remark(use.line, "mesh",
                          "meshes that are not read: clearance does not cover these links",
                          fmt::format("{} ({}: {})", link.name, use.file, why));
          continue;
        }
        enclose(scaled(files.read(path.string()), use.scale), collision, link.name, use, findings);
        has_hull = true;
      } catch (const PathError& error) {
        findings.add(use.line, "mesh-path", error.what());
      } catch (const std::exception& error) {  // of the mesh's file or its points
        findings.add(use.line, "mesh", fmt::format("{}: {}", in_quotes(use.file), error.what()));
      }
    }
  }
  return has_hull;
}

}  // namespace stillbase::urdf
