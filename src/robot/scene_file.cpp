#include "robot/scene_file.hpp"

#include <cstdint>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>
#include <stdexcept>

#include <assimp/DefaultIOSystem.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <assimp/Importer.hpp>

#include <stillbase/core/child_process.hpp>

#include "robot/joined_mesh.hpp"
#include "robot/mesh_text.hpp"

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
  explicit SceneReader(const aiScene& scene) : scene_(scene), mesh_(faces_of(scene)) {
    add(*scene.mRootNode, aiMatrix4x4());
  }
  Mesh take() { return mesh_.take(); }

 private:
  static std::size_t faces_of(const aiScene& scene) {
    std::size_t faces = 0;
    for (unsigned m = 0; m < scene.mNumMeshes; ++m) faces += scene.mMeshes[m]->mNumFaces;
    return faces;
  }

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
      number.push_back(mesh_.vertex(Vector3d(v.x, v.y, v.z)));
    }
    for (unsigned i = 0; i < part.mNumFaces; ++i) {
      const aiFace& face = part.mFaces[i];
      if (face.mNumIndices != 3) continue;  // points and lines enclose nothing
      std::array<int, 3> triangle{};
      for (unsigned c = 0; c < 3; ++c) triangle[c] = number[face.mIndices[c]];
      mesh_.add(triangle);
    }
  }

  const aiScene& scene_;
  JoinedMesh mesh_;
};

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
    try {
      if (importer.GetException()) std::rethrow_exception(importer.GetException());
    } catch (const std::bad_alloc&) {
      throw;
    } catch (...) {  // its text is the importer's
    }
    throw std::runtime_error(fmt::format("cannot be read ({})", importer.GetErrorString()));
  }
  return SceneReader(*scene).take();
}

/// Size of a file and, of a .gltf file, of the buffers that lie beside it.
std::uintmax_t bytes_to_read(const fs::path& path) {
  std::error_code fault;
  std::uintmax_t bytes = fs::file_size(path, fault);
  if (fault) return 0;  // it is gone, as Assimp will find
  if (path.extension() != ".gltf") return bytes;
  for (const auto& entry : fs::directory_iterator(path.parent_path(), fault)) {
    if (entry.path().extension() == ".bin" && entry.is_regular_file(fault)) {
      bytes += entry.file_size(fault);
    }
  }
  return bytes;
}

}  // namespace

std::string mesh_to_bytes(const Mesh& mesh) {
  std::string bytes;
  const auto append = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  append(static_cast<std::uint64_t>(mesh.vertices.size()));
  append(static_cast<std::uint64_t>(mesh.triangles.size()));
  for (const Vector3d& vertex : mesh.vertices) {
    for (const double value : vertex) append(static_cast<float>(value));
  }
  for (const std::array<int, 3>& triangle : mesh.triangles) append(triangle);
  return bytes;
}

Mesh mesh_of_bytes(std::string_view bytes) {
  const auto take = [&](auto& value) {
    if (bytes.size() < sizeof(value))
      throw std::runtime_error("cannot be read (its end is missing)");
    std::memcpy(&value, bytes.data(), sizeof(value));
    bytes.remove_prefix(sizeof(value));
  };
  std::uint64_t vertices = 0, triangles = 0;
  take(vertices);
  take(triangles);
  check_triangle_count(triangles);
  Mesh mesh;
  for (std::uint64_t i = 0; i < vertices; ++i) {
    std::array<float, 3> values{};
    take(values);
    for (const float value : values) {
      if (const std::string fault = coordinate_fault(value); !fault.empty()) {
        throw std::runtime_error(fault);
      }
    }
    mesh.vertices.emplace_back(values[0], values[1], values[2]);
  }
  for (std::uint64_t i = 0; i < triangles; ++i) {
    std::array<int, 3> triangle{};
    take(triangle);
    for (const int corner : triangle) {
      if (corner < 0 || static_cast<std::uint64_t>(corner) >= vertices) {
        throw std::runtime_error("a face names a vertex that is not there");
      }
    }
    mesh.triangles.push_back(triangle);
  }
  return mesh;
}

Mesh read_scene(const std::string& path) {
  const std::uintmax_t bytes = bytes_to_read(path);
  ChildOptions options;
  options.processor_seconds =
      kSceneSeconds + kSceneSecondsPerMiB * static_cast<double>(bytes) / (1 << 20);
  options.seconds = kSceneSlowness * options.processor_seconds;
  options.memory = kSceneMemory + kSceneMemoryPerByte * bytes;
  ChildOutcome outcome;
  run_in_children(
      1, options, [&](int) { return mesh_to_bytes(imported(path)); },
      [&](int, const ChildOutcome& out) { outcome = out; });
  switch (outcome.end) {
    case ChildEnd::Finished:
      return mesh_of_bytes(outcome.bytes);
    case ChildEnd::Crashed:
      throw std::runtime_error(outcome.message);
    case ChildEnd::TimedOut:
      throw MeshLimitError(
          fmt::format("cannot be read (Assimp did not end within {:.1f} s of processor time, or "
                      "{:.0f} s in all)",
                      options.processor_seconds, options.seconds));
    case ChildEnd::OutOfMemory:
      throw MeshLimitError(
          fmt::format("cannot be read (Assimp took more than {} MiB)", options.memory >> 20));
    case ChildEnd::Died:
      break;
  }
  throw std::runtime_error(fmt::format("cannot be read (Assimp ended: {})", outcome.message));
}

}  // namespace stillbase
