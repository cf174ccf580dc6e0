#include "robot/visual_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include <stillbase/core/error.hpp>

#include "robot/mesh_thinning.hpp"
#include "robot/urdf_element.hpp"

namespace stillbase::urdf {

namespace {

/// Meshes of a robot, each file read once.
class VisualMeshes {
 public:
  VisualMeshes(const MeshFolders& folders, std::size_t most) : folders_(folders), most_(most) {}

  /// Index of a mesh; none: it is not there.
  /// @throws std::runtime_error why it is not drawn
  std::optional<std::size_t> add(const std::string& name) {
    const std::filesystem::path path = find_mesh(name, folders_);
    if (path.empty()) return std::nullopt;
    const auto [known, is_new] = known_.try_emplace(path.string());
    if (is_new) {
      std::error_code fault;
      bytes_ += std::filesystem::file_size(path, fault);
      if (fault || bytes_ > kMaxMeshBytes) {
        throw std::runtime_error(
            fmt::format("the meshes have more than {} MiB together", kMaxMeshBytes >> 20));
      }
      Mesh mesh = thinned(reader_.read(path.string()), most_);
      if (mesh.triangles.empty()) throw std::runtime_error("its faces have no area");
      known->second = meshes.size();
      meshes.push_back(std::move(mesh));
    }
    if (!known->second) throw std::runtime_error("cannot be read");
    return known->second;
  }

  std::vector<Mesh> meshes;

 private:
  const MeshFolders& folders_;
  std::size_t most_;
  std::uintmax_t bytes_ = 0;
  MeshReader reader_;
  std::map<std::string, std::optional<std::size_t>> known_;  ///< none: it cannot be read
};

/// Bound on the distance of a shape's points from the frame of its link.
double farthest(const VisualShape& shape, const std::vector<Mesh>& meshes) {
  struct Reach {
    double operator()(const Sphere& s) const { return s.radius; }
    double operator()(const Capsule& c) const { return c.radius + c.length / 2; }
    double operator()(const Cylinder& c) const { return std::hypot(c.radius, c.length / 2); }
    double operator()(const Box& b) const { return b.size.norm() / 2; }
    double operator()(const ConvexMesh&) const { return 0; }
  };
  double reach = 0;
  if (shape.geometry) {
    reach = std::visit(Reach{}, *shape.geometry);
  } else {
    for (const Vector3d& v : meshes[shape.mesh].vertices) {
      reach = std::max(reach, v.cwiseProduct(shape.scale).norm());
    }
  }
  return shape.pose.position.norm() + reach;
}

/// The parts of a link; none, and a remark, when one of them says what cannot be.
std::vector<VisualPart> parts_of(const tinyxml2::XMLElement& xml, MaterialColors& colors,
                                 Findings& findings) {
  Findings own("");
  Element link(xml, own);
  const auto remark = [&](int line, const std::string& why) {
    findings.remark(line, "visual", "<visual> that cannot be read: left out",
                    fmt::format("{} ({})", link.text("name", false), why));
  };
  try {
    std::vector<VisualPart> parts = read_visuals(link, colors);
    own.raise();
    for (const Finding& shape : own.left_out()) remark(shape.line, shape.message);
    return parts;
  } catch (const InputError& error) {
    remark(link.line(), error.findings().front().message);
    return {};
  }
}

MaterialColors colors_of(const tinyxml2::XMLElement& robot) {
  MaterialColors colors;
  Findings own("");
  for (const auto* e = robot.FirstChildElement("material"); e != nullptr;
       e = e->NextSiblingElement("material")) {
    Element material(*e, own);
    if (const auto color = read_color(material)) colors[material.text("name", false)] = *color;
  }
  return colors;
}

}  // namespace

Visuals read_visual_shapes(std::string_view text, const MeshFolders& folders, std::size_t most,
                           Findings& findings) {
  tinyxml2::XMLDocument document;
  parse_robot(text, document, findings);
  MaterialColors colors = colors_of(*document.RootElement());
  VisualMeshes meshes(folders, most);
  Visuals visuals;
  for (const auto* e = document.RootElement()->FirstChildElement("link"); e != nullptr;
       e = e->NextSiblingElement("link")) {
    const char* const name = e->Attribute("name");
    const std::string link = name == nullptr ? "" : name;
    for (const VisualPart& part : parts_of(*e, colors, findings)) {
      VisualShape shape{link, {}, part.color, std::nullopt};
      if (part.shape) {
        shape.pose = part.shape->first;
        shape.geometry = part.shape->second;
      } else {
        try {
          const auto mesh = meshes.add(part.mesh->file);
          if (!mesh) {
            findings.remark(part.mesh->line, "visual", "meshes of <visual> that are not there",
                            fmt::format("{} ({})", link, in_quotes(part.mesh->file)));
            continue;
          }
          shape.mesh = *mesh;
        } catch (const std::exception& error) {  // of its place, its file or its contents
          findings.remark(
              part.mesh->line, "visual", "meshes of <visual> that cannot be drawn",
              fmt::format("{} ({}: {})", link, in_quotes(part.mesh->file), error.what()));
          continue;
        }
        shape.pose = part.mesh->pose;
        shape.scale = part.mesh->scale;
      }
      if (farthest(shape, meshes.meshes) > kFarthestDrawn || shape.scale.prod() == 0) {
        findings.remark(e->GetLineNum(), "visual",
                        "<visual> without size or too large to draw: left out", link);
        continue;
      }
      visuals.shapes.push_back(std::move(shape));
    }
  }
  visuals.meshes = std::move(meshes.meshes);
  return visuals;
}

}  // namespace stillbase::urdf
