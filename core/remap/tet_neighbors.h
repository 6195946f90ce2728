// Which tets of a mesh share a face, and which faces nobody shares.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/remap/data_mesh.h"

namespace tet {

/// A face of a tet: the one across from a corner.
struct BorderFace {
  std::uint32_t tet = 0, corner = 0;
};

struct TetNeighbors {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  /// For each tet the one beyond the face across from each corner, or kNone. Two tets are
  /// neighbours where no third one has their face, and they lie on its two sides: so what lies
  /// around a face between neighbours is inside, whatever the mesh.
  std::vector<std::array<std::uint32_t, 4>> across;
  std::vector<BorderFace> border;  ///< faces without one beyond, in order
};

/// Parallel; one result for any number of threads.
TetNeighbors find_neighbors(const DataMesh& mesh);

/// The corners of a face.
std::array<WorldPoint, 3> places_of(const DataMesh& mesh, const BorderFace& face) noexcept;

}  // namespace tet
