#include "robot/mesh_file.hpp"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <assimp/DefaultIOSystem.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <assimp/Importer.hpp>

#include <stillbase/core/file.hpp>

#include "robot/ply_file.hpp"

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

/// Before Assimp splits faces into triangles: it follows their numbers unseen, and ends the program
/// at a face without any.
void check_faces(const aiScene& scene) {
  for (unsigned m = 0; m < scene.mNumMeshes; ++m) {
    const aiMesh& part = *scene.mMeshes[m];
    for (unsigned i = 0; i < part.mNumFaces; ++i) {
      const aiFace& face = part.mFaces[i];
      if (face.mNumIndices == 0) throw std::runtime_error("a face names no vertex");
      for (unsigned c = 0; c < face.mNumIndices; ++c) {
        if (face.mIndices[c] >= part.mNumVertices) {
          throw std::runtime_error("a face names a vertex that is not there");
        }
      }
    }
  }
}

/// Takes the parts of a scene, whose faces are checked, into one mesh.
class SceneReader {
 public:
  explicit SceneReader(const aiScene& scene) : scene_(scene) {
    std::size_t faces = 0;
    for (unsigned m = 0; m < scene.mNumMeshes; ++m) faces += scene.mMeshes[m]->mNumFaces;
    if (faces > kMostTrianglesApart) table_.assign(std::size_t{1} << 16, kFree);
    add(*scene.mRootNode, aiMatrix4x4());
  }
  Mesh take() { return std::move(mesh_); }

 private:
  /// Assimp gives every triangle of STL and OBJ files three vertices of its own. Those of a mesh
  /// with more triangles than this are joined where they are equal: six times as many cost seconds
  /// and hundreds of MB.
  static constexpr std::size_t kMostTrianglesApart = 100'000;
  static constexpr int kFree = -1;

  void add(const aiNode& node, const aiMatrix4x4& above) {
    const aiMatrix4x4 T = above * node.mTransformation;
    for (unsigned m = 0; m < node.mNumMeshes; ++m) add(*scene_.mMeshes[node.mMeshes[m]], T);
    for (unsigned c = 0; c < node.mNumChildren; ++c) add(*node.mChildren[c], T);
  }

  void add(const aiMesh& part, const aiMatrix4x4& T) {
    std::vector<int> number;
    number.reserve(part.mNumVertices);
    for (unsigned i = 0; i < part.mNumVertices; ++i) {
      const aiVector3D v = T * part.mVertices[i];
      const Vector3d vertex(v.x, v.y, v.z);
      if (!vertex.allFinite()) throw std::runtime_error("a vertex is not finite");
      number.push_back(table_.empty() ? add(vertex) : number_of(vertex));
    }
    for (unsigned i = 0; i < part.mNumFaces; ++i) {
      const aiFace& face = part.mFaces[i];
      if (face.mNumIndices != 3) continue;  // points and lines enclose nothing
      std::array<int, 3> triangle{};
      for (unsigned c = 0; c < 3; ++c) triangle[c] = number[face.mIndices[c]];
      mesh_.triangles.push_back(triangle);
    }
    if (mesh_.triangles.size() > kMaxMeshTriangles) {
      throw std::runtime_error(fmt::format("more than {} triangles", kMaxMeshTriangles));
    }
  }

  int add(const Vector3d& vertex) {
    mesh_.vertices.push_back(vertex);
    return static_cast<int>(mesh_.vertices.size()) - 1;
  }

  /// The vertex that is equal, or a new one.
  int number_of(const Vector3d& vertex) {
    if (2 * mesh_.vertices.size() >= table_.size()) grow();
    int& place = place_of(vertex);
    if (place == kFree) place = add(vertex);
    return place;
  }

  /// Where the number of a vertex stands in the table, or is to stand: open addressing.
  int& place_of(const Vector3d& vertex) {
    std::uint64_t hash = 0;
    for (const double x : vertex) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(x + 0.0)) * 0x9e3779b97f4a7c15u;  // -0 is 0
      hash ^= hash >> 32;
    }
    std::size_t i = hash & (table_.size() - 1);
    while (table_[i] != kFree && mesh_.vertices[static_cast<std::size_t>(table_[i])] != vertex) {
      i = (i + 1) & (table_.size() - 1);
    }
    return table_[i];
  }

  void grow() {
    table_.assign(2 * table_.size(), kFree);
    for (std::size_t i = 0; i < mesh_.vertices.size(); ++i) {
      place_of(mesh_.vertices[i]) = static_cast<int>(i);
    }
  }

  const aiScene& scene_;
  Mesh mesh_;
  std::vector<int> table_;  ///< numbers of vertices by their hash; empty: all stay apart
};

std::uint32_t number_at(const std::string& bytes, std::size_t place) {
  std::uint32_t number = 0;  // little-endian, as every machine that this is built for
  std::memcpy(&number, bytes.data() + place, sizeof(number));
  return number;
}

/// Assimp makes room for what the header of a file states before it finds that there is less.
/// @throws std::runtime_error the file states more than it can hold, or more than is read
void check_counts(const std::string& path, const std::string& ending, std::uintmax_t size) {
  std::string begin(std::size_t{1} << 16, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<std::size_t>(file.gcount()));
  constexpr std::size_t kStlHeader = 84, kStlTriangle = 50;  // bytes
  if (ending == ".stl" && begin.size() >= kStlHeader) {
    const std::uintmax_t count = number_at(begin, 80);
    if (count > kMaxMeshTriangles && size == kStlHeader + kStlTriangle * count) {
      throw std::runtime_error(fmt::format("more than {} triangles", kMaxMeshTriangles));
    }
  }
  const bool is_short = ending == ".glb" && begin.size() >= 20 &&
                        std::max(number_at(begin, 8), number_at(begin, 12)) > size;
  if (is_short) throw std::runtime_error("is shorter than its header says");
}

/// What Assimp reads.
Mesh imported(const std::string& path) {
  Assimp::Importer importer;
  importer.SetIOHandler(new FolderFiles(fs::path(path).parent_path()));  // takes it over
  importer.SetPropertyInteger(
      AI_CONFIG_PP_RVC_FLAGS,
      aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_COLORS |
          aiComponent_TEXCOORDS | aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS |
          aiComponent_TEXTURES | aiComponent_LIGHTS | aiComponent_CAMERAS | aiComponent_MATERIALS);
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene = importer.ReadFile(path, 0);
  if (scene != nullptr && scene->mRootNode != nullptr) {
    check_faces(*scene);
    scene = importer.ApplyPostProcessing(aiProcess_Triangulate | aiProcess_RemoveComponent);
  }
  if (scene == nullptr || scene->mRootNode == nullptr) {
    throw std::runtime_error(fmt::format("cannot be read ({})", importer.GetErrorString()));
  }
  return SceneReader(*scene).take();
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
  const std::uintmax_t size = fs::file_size(path, fault);
  if (size > kMaxMeshBytes || fault) {
    throw std::runtime_error(fmt::format("is larger than {} MiB", kMaxMeshBytes >> 20));
  }
  // Workspaces hold symbolic links to the meshes of their packages.
  const std::string real = fs::canonical(path, fault).string();
  if (fault) throw std::runtime_error("cannot be opened");
  check_counts(real, ending, size);
  Mesh mesh = ending == ".ply" ? read_ply(read_text_file(real, kMaxMeshBytes)) : imported(real);
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
