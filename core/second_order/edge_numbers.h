// The edges of a mesh, numbered.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Every edge once, sorted by its lower vertex, then by its higher one.
struct EdgeNumbers {
  std::vector<std::uint64_t> first;    ///< edge of each vertex as the lower one, and one more
  std::vector<std::uint32_t> higher;   ///< vertex of each edge
  std::vector<std::uint32_t> of_tets;  ///< six a tet, in the order of kTetEdges

  std::uint64_t count() const noexcept { return higher.size(); }
  /// The number of the edge between two vertices, which is there.
  std::uint32_t find(std::uint64_t a, std::uint64_t b) const noexcept;
  /// Calls `visit(edge, lower, higher)` for each edge of a vertex as the lower one.
  template <class Visit>
  void visit_from(std::uint64_t lower, const Visit& visit) const {
    for (std::uint64_t edge = first[lower]; edge < first[lower + 1]; ++edge) {
      visit(edge, lower, std::uint64_t{higher[edge]});
    }
  }
};

/// Counts, then fills. Parallel; one value for any number of threads. Errors:
/// kResourceExhausted (more vertices or edges than a number of 32 bits counts), kCancelled,
/// kDeadlineExceeded.
absl::StatusOr<EdgeNumbers> number_edges(const MeshView& mesh,
                                         std::uint64_t vertex_count,
                                         const Cancellation& cancellation = {});

}  // namespace tet
