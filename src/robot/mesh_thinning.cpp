#include "robot/mesh_thinning.hpp"

#include <algorithm>
#include <cstdint>
#include <unordered_map>

#include <stillbase/core/constants.hpp>

namespace stillbase {

namespace {

constexpr int kFinestGrid = 65535;

using Cell = std::uint64_t;

/// Cells of the vertices in a grid of so many cells along the longest side.
std::vector<Cell> cells_of(const std::vector<Vector3d>& vertices, int cells) {
  Vector3d low = Vector3d::Constant(kInfinity), high = -low;
  for (const Vector3d& v : vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  const double extent = (high - low).maxCoeff();
  std::vector<Cell> list;
  list.reserve(vertices.size());
  for (const Vector3d& v : vertices) {
    Cell cell = 0;
    for (int k = 0; k < 3; ++k) {
      const double part = extent > 0 ? (v[k] - low[k]) / extent : 0;
      cell = (cell << 16) | static_cast<Cell>(std::min<double>(part * cells, cells - 1));
    }
    list.push_back(cell);
  }
  return list;
}

bool keeps_corners(const std::array<int, 3>& triangle, const std::vector<Cell>& cells) {
  const Cell a = cells[static_cast<std::size_t>(triangle[0])];
  const Cell b = cells[static_cast<std::size_t>(triangle[1])];
  const Cell c = cells[static_cast<std::size_t>(triangle[2])];
  return a != b && b != c && c != a;
}

std::size_t triangles_in(const Mesh& mesh, int cells) {
  const std::vector<Cell> list = cells_of(mesh.vertices, cells);
  return static_cast<std::size_t>(
      std::count_if(mesh.triangles.begin(), mesh.triangles.end(),
                    [&](const auto& triangle) { return keeps_corners(triangle, list); }));
}

/// Starting with its lowest corner; the order, which says where outside is, stays.
std::array<int, 3> turned(std::array<int, 3> triangle) {
  std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()), triangle.end());
  return triangle;
}

Mesh clustered(const Mesh& mesh, int cells) {
  const std::vector<Cell> list = cells_of(mesh.vertices, cells);
  Mesh result;
  std::unordered_map<Cell, int> numbers;
  std::vector<int> number(mesh.vertices.size(), -1), members;
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    if (!keeps_corners(triangle, list)) continue;
    std::array<int, 3> corners{};
    for (std::size_t c = 0; c < 3; ++c) {
      const auto v = static_cast<std::size_t>(triangle[c]);
      if (number[v] < 0) {
        const auto [at, is_new] = numbers.try_emplace(list[v], static_cast<int>(members.size()));
        if (is_new) {
          result.vertices.emplace_back(Vector3d::Zero());
          members.push_back(0);
        }
        number[v] = at->second;
        result.vertices[static_cast<std::size_t>(at->second)] += mesh.vertices[v];
        ++members[static_cast<std::size_t>(at->second)];
      }
      corners[c] = number[v];
    }
    result.triangles.push_back(turned(corners));
  }
  for (std::size_t i = 0; i < members.size(); ++i) result.vertices[i] /= members[i];
  std::sort(result.triangles.begin(), result.triangles.end());
  result.triangles.erase(std::unique(result.triangles.begin(), result.triangles.end()),
                         result.triangles.end());
  return result;
}

}  // namespace

Mesh thinned(const Mesh& mesh, std::size_t most) {
  Mesh joined = clustered(mesh, kFinestGrid);
  if (joined.triangles.size() <= most) return joined;
  int coarse = 1, fine = kFinestGrid;  // one cell holds everything: no triangle is left
  while (fine - coarse > 1) {
    const int middle = coarse + (fine - coarse) / 2;
    (triangles_in(joined, middle) <= most ? coarse : fine) = middle;
  }
  return clustered(joined, coarse);
}

void thin_together(std::vector<Mesh>& meshes, std::size_t most) {
  std::vector<std::size_t> sizes;
  for (const Mesh& mesh : meshes) sizes.push_back(mesh.triangles.size());
  std::sort(sizes.begin(), sizes.end());
  std::size_t left = most, share = 0;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    share = left / (sizes.size() - i);
    if (sizes[i] > share) break;
    left -= sizes[i];
    share = sizes[i];
  }
  for (Mesh& mesh : meshes) {
    if (mesh.triangles.size() > share) mesh = thinned(mesh, share);
  }
}

}  // namespace stillbase
