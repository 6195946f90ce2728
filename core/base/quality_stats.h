// Statistics of tets: their dihedral angles and their volume.
#pragma once

#include <array>
#include <cstdint>

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

  /// True when nothing was measured.
  bool empty() const noexcept { return min_dihedral_deg > max_dihedral_deg; }

  void add(const QualityStats& other) noexcept;
  /// Adds `count` tets of one shape, whose own statistics are `shape`, each `scale` times its
  /// volume.
  void add_copies(const QualityStats& shape, std::uint64_t count, double scale) noexcept;
};

/// Whether tets are measured as they are made.
enum class Statistics : std::uint8_t { kMeasured, kSkipped };

}  // namespace tet
