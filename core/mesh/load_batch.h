// From a mesh's columns to a batch of tets that is to be measured.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/tet_batch.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Brings edges near 1 before they are measured, by a power of two: no angle gets another bit
/// for it. A float has room for the fourth power of such lengths, and has none for those of a
/// mesh in metres that is of molecules, or of galaxies.
class EdgeScale {
 public:
  /// For edges of about `spacing`; what is near 1, or not positive, scales nothing.
  explicit EdgeScale(double spacing) noexcept;

  float factor() const noexcept { return factor_; }
  /// The volume of tets that were measured so much larger or smaller.
  double volume_of(double scaled) const noexcept;

 private:
  int exponent_ = 0;
  float factor_ = 1;
};

/// Loads `count` tets from `first` on, as they are stored but for the scale; lanes beyond
/// repeat the last one.
void load_batch(const MeshView& view,
                std::uint64_t first,
                std::size_t count,
                const EdgeScale& scale,
                TetBatch& batch) noexcept;

}  // namespace tet
