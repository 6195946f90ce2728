// Mesh quality: dihedral angles and volume, gathered shard by shard.
#pragma once

#include <array>
#include <cstdint>

#include "core/mesh/tet_mesh.h"

namespace tet {

/// Statistics of the tets of a chunk or of a whole mesh.
///
/// Sums are added in chunk order, so a mesh has one value whatever the number of threads.
struct QualityStats {
  static constexpr int kBins = 180;

  double min_dihedral_deg = 180;
  double max_dihedral_deg = 0;
  double volume = 0;  ///< world units cubed
  /// Dihedral angles (six a tet) by whole degrees: bin d counts [d, d+1).
  std::array<std::uint64_t, kBins> histogram{};

  void add(const QualityStats& other) noexcept;
};

/// Measures every tet of a mesh in memory, in parallel.
QualityStats measure_quality(const TetMesh& mesh);

}  // namespace tet
