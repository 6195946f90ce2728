// Which edges of a mesh are curved, and how far.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/cancel.h"
#include "core/base/vec3.h"
#include "core/field/phi_field.h"
#include "core/mesh/faces.h"
#include "core/mesh/tet_mesh.h"
#include "core/second_order/curved_tet.h"
#include "core/second_order/edge_numbers.h"

namespace tet {

/// The edges of the surface, and where the middle of each belongs.
class CurvedEdges {
 public:
  /// The determinant of a curved tet, as it is stored, is nowhere below this share of the
  /// straight one's.
  static constexpr double kLeastShare = 0.2;

  /// The sides of `surface`, all straight so far.
  CurvedEdges(const TetMesh& mesh,
              const EdgeNumbers& edges,
              const std::vector<Triangle>& surface);

  /// Finds for each edge whose vertices are among those from `first_vertex` on how far from its
  /// middle the surface of `field` is, along phi's slope there and within the faces of a box
  /// that both ends lie in. Parallel; once cancelled, some of them.
  void bend(const PhiField& field,
            std::uint64_t first_vertex,
            std::uint64_t vertex_count,
            const Cancellation& cancellation);

  /// Halves the bend of every edge of a tet that is too much deformed, twice at most, and then
  /// makes it straight, until no tet is: all at once, from the same edges, so that no order
  /// exists. Parallel.
  void keep_tets_good(const Cancellation& cancellation);

  /// From the middle of the straight edge to its middle node.
  Vector offset(std::uint64_t edge) const noexcept;

  /// Edges off the straight line, and those that are less curved than the surface.
  std::uint64_t curved() const noexcept;
  std::uint64_t straightened() const noexcept;

 private:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  static constexpr std::uint8_t kStraight = 3;  ///< halvings, of which this is the last

  struct Edge {
    std::uint64_t low = 0, high = 0;  ///< vertices
    Vector bend{};
    std::uint8_t halvings = 0;
  };

  bool is_good(std::uint64_t tet) const noexcept;
  Vector offset_of(const Edge& edge) const noexcept;

  const TetMesh& mesh_;
  const EdgeNumbers& edges_;
  std::vector<std::uint32_t> slot_;  // of every edge among those of the surface
  std::vector<Edge> surface_;        // by their numbers
};

}  // namespace tet
