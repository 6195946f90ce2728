// The tets around some of a mesh's vertices.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/tet_mesh.h"

namespace tet {

/// A corner of a tet: 4 * tet + corner, where corner is 0 .. 3.
struct TetCorner {
  std::uint64_t index = 0;

  std::uint64_t tet() const noexcept { return index / 4; }
  std::size_t corner() const noexcept { return index % 4; }
};

/// Some vertices, as those of some tets, and for each of them the corners of all tets around
/// it.
///
/// Chosen vertices are numbered in the order of their ids; a star's corners are in the order of
/// tets. One value for any number of threads.
class VertexStars {
 public:
  static constexpr std::uint32_t kNotChosen = 0xffffffff;

  /// Chooses the vertices of `tets`. Parallel; takes 4 bytes for every vertex of the mesh.
  VertexStars(const TetMesh& mesh, std::span<const std::uint64_t> tets);
  /// Chooses vertices by their ids, which ascend.
  static VertexStars around(const TetMesh& mesh, std::span<const std::uint64_t> vertices);

  std::size_t size() const noexcept { return vertex_.size(); }
  /// The mesh's id of a chosen vertex.
  std::uint64_t vertex(std::size_t chosen) const noexcept { return vertex_[chosen]; }
  std::span<const TetCorner> star(std::size_t chosen) const noexcept {
    return std::span(corners_).subspan(first_[chosen], first_[chosen + 1] - first_[chosen]);
  }
  /// The number of a vertex of the mesh, or kNotChosen.
  std::uint32_t number(std::uint64_t vertex) const noexcept { return number_[vertex]; }

 private:
  explicit VertexStars(const TetMesh& mesh);
  void number_chosen();
  void gather(const TetMesh& mesh);

  std::vector<std::uint32_t> number_;  // of every vertex of the mesh
  std::vector<std::uint64_t> vertex_;
  std::vector<std::uint64_t> first_;  // of each chosen vertex in corners_, and one more
  std::vector<TetCorner> corners_;
};

/// Chosen vertices in sets of which no two share a tet, so that those of one set may move at
/// the same time. Each set ascends.
std::vector<std::vector<std::uint32_t>> independent_sets(const TetMesh& mesh,
                                                         const VertexStars& stars);

}  // namespace tet
