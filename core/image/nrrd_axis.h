// An axis of NRRD without a direction: where its voxels lie between its ends.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

namespace tet {

/// Whether a voxel is a length of its axis, which ends where its last voxel does ("cell"), or a
/// point of it ("node").
enum class Centering : std::uint8_t { kUnsaid, kCell, kNode };

/// What the header says of an axis.
struct PlainAxis {
  double size = 1;  ///< voxels
  std::optional<double> spacing, min, max;
  Centering centering = Centering::kUnsaid;

  /// From one voxel to the next, and the first one's place: as teem has them.
  double step() const;
  double origin() const;
};

/// Refuses a max that the voxels do not reach: one of the two is wrong. Throws ImageRefusal.
void check_plain_axis(const PlainAxis& axis, std::size_t number);

}  // namespace tet
