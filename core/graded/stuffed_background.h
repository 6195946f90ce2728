// A background whose nodes have signs as a mesh: nodes move, tets are cut, vertices are
// numbered.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/cancel.h"
#include "core/base/types.h"
#include "core/graded/background_mesh.h"
#include "core/graded/graded_warp.h"
#include "core/graded/split_tet.h"
#include "core/graded/surface_edges.h"
#include "core/mesh/lattice_to_world.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// A background after the warp, its vertices and tets counted. A vertex belongs to a node, or
/// to the lower node of a cut edge; they are in the order of nodes, and tets in that of the
/// background's. Refers to what it is made of, which must outlive it.
class StuffedBackground {
 public:
  /// Parallel. If cancelled, discard the object.
  StuffedBackground(const BackgroundMesh& mesh,
                    const SurfaceEdges& edges,
                    const GradedLimits& limits,
                    const Cancellation& cancellation);

  std::uint64_t vertex_count() const noexcept { return vertex_count_; }
  std::uint64_t tet_count() const noexcept { return first_tet_.back(); }

  /// Lattice corners around all vertices; empty where there is none.
  VoxelBox corner_box() const noexcept;
  /// The largest octree level that a tet's node is of.
  int levels() const noexcept;

  /// Fills the columns of a mesh whose header says these counts. Parallel. Once cancelled,
  /// some.
  void fill(const LatticeToWorld& to_world,
            const Cancellation& cancellation,
            TetMesh& mesh) const;

  /// The octree level of the smallest leaves around each vertex.
  std::vector<std::uint8_t> vertex_levels() const;
  /// The faces of the mesh's box that each vertex lies in.
  std::vector<CutFaces> vertex_faces() const;

 private:
  static constexpr std::uint32_t kNoVertex = ~std::uint32_t{0};

  struct OrderedTet;

  NodeSign sign(NodeId node) const noexcept {
    if (onto_[node] != SurfaceEdges::kNone || mesh_.phi[node] == 0) return NodeSign::kZero;
    return mesh_.phi[node] < 0 ? NodeSign::kPlus : NodeSign::kMinus;
  }

  /// What there is to know of a vertex.
  struct Vertex {
    std::uint32_t id = 0;
    WorldPoint at;  ///< finest spacings
    std::uint8_t level = 0;
    CutFaces faces = 0;
  };

  void find_used_nodes();
  void number_vertices();
  void count_tets(const Cancellation& cancellation);
  bool is_cut(NodeId low, std::uint32_t edge) const noexcept;
  SplitTet split_of(const OrderedTet& tet,
                    std::array<std::uint32_t, kStencilVertices>& id) const noexcept;
  WorldPoint place_of(NodeId node) const noexcept;
  WorldPoint cut_point(NodeId low, std::uint32_t edge) const noexcept;
  NodeId low_node(std::uint32_t edge) const noexcept;
  template <class Visit>
  void for_each_vertex_of(NodeId node, const Visit& visit) const;
  template <class Index>
  Index* write_tets(std::size_t tet, bool mirrors, Index* out) const noexcept;
  template <class Index>
  void fill_tets(bool mirrors, const Cancellation& cancellation, TetMesh& mesh) const;

  const BackgroundMesh& mesh_;
  const SurfaceEdges& edges_;
  std::vector<std::uint32_t> onto_;  // of each node: the edge whose cut point it moved onto
  std::vector<bool> used_;           // nodes that are vertices
  std::uint64_t vertex_count_ = 0;
  std::vector<std::uint32_t> vertex_of_node_, vertex_of_edge_;
  std::vector<std::uint64_t> first_tet_;  // of each range of background tets, and one more
};

}  // namespace tet
