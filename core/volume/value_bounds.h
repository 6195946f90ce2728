// What values a volume has in a box, without looking at each of them.
#pragma once

#include <vector>

#include "core/base/types.h"
#include "core/volume/volume.h"
#include "core/volume/volume_reader.h"

namespace tet {

/// Ranges of a volume's values in cubes of 128 voxels, 256 and so on, until a few hold all of
/// it. Immutable once made.
class ValueBounds {
 public:
  /// Reads the whole volume, which may go afterwards. Parallel.
  explicit ValueBounds(const Volume& volume);

  /// The range of all values, the background included.
  const ValueRange& all() const noexcept { return all_; }

  /// Holds every value in the box, of any size, in a time that does not depend on it; exact for
  /// up to kFewVoxels voxels. `reader` reads the same volume.
  ValueRange within(VolumeReader& reader, const VoxelBox& box) const noexcept;

  static constexpr double kFewVoxels = 512;

  /// A cube that is neither background throughout nor within a constant one of 4096 voxels.
  struct Cell {
    BrickCoord at;  ///< in units of its level's edge
    ValueRange range;
  };
  using Level = std::vector<Cell>;  ///< sorted by place, unique

 private:
  ValueRange of_cells(VolumeReader& reader,
                      std::size_t level,
                      const VoxelBox& box) const noexcept;
  ValueRange of_few(const VoxelBox& box) const noexcept;

  std::vector<Level> levels_;
  ValueRange background_, all_;
};

}  // namespace tet
