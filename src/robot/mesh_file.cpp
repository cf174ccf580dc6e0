#include "robot/mesh_file.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string_view>

#include <assimp/DefaultIOSystem.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <assimp/Importer.hpp>

namespace stillbase {

namespace {

namespace fs = std::filesystem;

/// Opens files below one folder alone: what a mesh file names beside itself lies there.
class FolderFiles : public Assimp::DefaultIOSystem {
 public:
  explicit FolderFiles(const fs::path& folder) : folder_(fs::weakly_canonical(folder)) {}
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    std::error_code fault;
    const fs::path path = fs::weakly_canonical(file, fault);
    const fs::path below = path.lexically_relative(folder_);
    const bool is_below = !fault && !below.empty() && *below.begin() != "..";
    const bool is_small =
        is_below && fs::is_regular_file(path, fault) && fs::file_size(path, fault) <= kMaxMeshBytes;
    return is_small && !fault ? DefaultIOSystem::Open(file, mode) : nullptr;
  }

 private:
  fs::path folder_;
};

void add(const aiScene& scene, const aiNode& node, const aiMatrix4x4& above, Mesh& mesh) {
  const aiMatrix4x4 T = above * node.mTransformation;
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& part = *scene.mMeshes[node.mMeshes[m]];
    const int first = static_cast<int>(mesh.vertices.size());
    for (unsigned i = 0; i < part.mNumVertices; ++i) {
      const aiVector3D v = T * part.mVertices[i];
      mesh.vertices.emplace_back(v.x, v.y, v.z);
      if (!mesh.vertices.back().allFinite()) throw std::runtime_error("a vertex is not finite");
    }
    for (unsigned i = 0; i < part.mNumFaces; ++i) {
      const aiFace& face = part.mFaces[i];
      if (face.mNumIndices != 3) continue;  // points and lines enclose nothing
      std::array<int, 3> triangle{};
      for (unsigned c = 0; c < 3; ++c) {
        if (face.mIndices[c] >= part.mNumVertices) {
          throw std::runtime_error("a face names a vertex that is not there");
        }
        triangle[c] = first + static_cast<int>(face.mIndices[c]);
      }
      mesh.triangles.push_back(triangle);
    }
    if (mesh.triangles.size() > kMaxMeshTriangles) {
      throw std::runtime_error(fmt::format("more than {} triangles", kMaxMeshTriangles));
    }
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c) add(scene, *node.mChildren[c], T, mesh);
}

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

Mesh read_mesh(const std::string& path) {
  const std::string ending = ending_of(path);
  const auto kinds = {".stl", ".obj", ".dae", ".gltf", ".glb", ".ply"};
  if (std::find(kinds.begin(), kinds.end(), ending) == kinds.end()) {
    throw std::runtime_error("is no STL, OBJ, COLLADA (.dae), glTF or PLY file");
  }
  std::error_code fault;
  if (!fs::is_regular_file(path, fault) || fault) throw std::runtime_error("is no file");
  if (fs::file_size(path, fault) > kMaxMeshBytes || fault) {
    throw std::runtime_error(fmt::format("is larger than {} MiB", kMaxMeshBytes >> 20));
  }
  // Workspaces hold symbolic links to the meshes of their packages.
  const std::string real = fs::canonical(path, fault).string();
  if (fault) throw std::runtime_error("cannot be opened");
  Assimp::Importer importer;
  importer.SetIOHandler(new FolderFiles(fs::path(real).parent_path()));  // takes it over
  importer.SetPropertyInteger(
      AI_CONFIG_PP_RVC_FLAGS,
      aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_COLORS |
          aiComponent_TEXCOORDS | aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS |
          aiComponent_TEXTURES | aiComponent_LIGHTS | aiComponent_CAMERAS | aiComponent_MATERIALS);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(real, aiProcess_Triangulate | aiProcess_RemoveComponent);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    throw std::runtime_error(fmt::format("cannot be read ({})", importer.GetErrorString()));
  }
  Mesh mesh;
  add(*scene, *scene->mRootNode, aiMatrix4x4(), mesh);
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
