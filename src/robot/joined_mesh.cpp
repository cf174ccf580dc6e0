#include "robot/joined_mesh.hpp"

#include <bit>
#include <cstdint>

#include "robot/mesh_text.hpp"

namespace stillbase {

namespace {

/// Meshes with more triangles than this have their vertices joined: six times as many cost seconds
/// and hundreds of MB.
constexpr std::size_t kMostTrianglesApart = 100'000;
constexpr int kFree = -1;
constexpr std::size_t kFirstPlaces = std::size_t{1} << 16;
/// Steps through the table per vertex, of which two or three are usual. A file whose vertices were
/// chosen to share a hash takes more, and keeps the rest of them apart.
constexpr std::size_t kMostSteps = 32;

}  // namespace

JoinedMesh::JoinedMesh(std::size_t triangles) {
  if (triangles > kMostTrianglesApart) table_.assign(kFirstPlaces, kFree);
}

int JoinedMesh::vertex(const Vector3d& vertex) {
  ++asked_;
  if (!table_.empty() && 2 * mesh_.vertices.size() >= table_.size()) grow();
  if (!table_.empty() && steps_ > kMostSteps * (asked_ + kFirstPlaces)) table_ = {};
  if (table_.empty()) return append(vertex);
  int& place = place_of(vertex);
  if (place == kFree) place = append(vertex);
  return place;
}

void JoinedMesh::add(const std::array<int, 3>& triangle) {
  mesh_.triangles.push_back(triangle);
  check_triangle_count(mesh_.triangles.size());
}

int JoinedMesh::append(const Vector3d& vertex) {
  mesh_.vertices.push_back(vertex);
  return static_cast<int>(mesh_.vertices.size()) - 1;
}

/// Where the number of a vertex stands in the table, or is to stand: open addressing.
int& JoinedMesh::place_of(const Vector3d& vertex) {
  std::uint64_t hash = 0;
  for (const double x : vertex) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(x + 0.0)) * 0x9e3779b97f4a7c15u;  // -0 is 0
    hash ^= hash >> 32;
  }
  std::size_t i = hash & (table_.size() - 1);
  while (table_[i] != kFree && mesh_.vertices[static_cast<std::size_t>(table_[i])] != vertex) {
    i = (i + 1) & (table_.size() - 1);
    ++steps_;
  }
  return table_[i];
}

void JoinedMesh::grow() {
  table_.assign(2 * table_.size(), kFree);
  for (std::size_t i = 0; i < mesh_.vertices.size(); ++i) {
    if (steps_ > kMostSteps * (asked_ + kFirstPlaces)) return;  // no vertex is sought any more
    place_of(mesh_.vertices[i]) = static_cast<int>(i);
  }
}

}  // namespace stillbase
