// Values of volumes at points that lie anywhere.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/types.h"
#include "core/volume/volume.h"
#include "core/volume/volume_reader.h"

namespace tet {

/// Samples volumes that lie alike, as the components of one grid do. Points that follow each
/// other are quick where they lie together: their voxels are copied side by side first.
///
/// Not thread-safe: one per task. The volumes must outlive it.
class PointSampler {
 public:
  /// There is at least one component, and all have the transform of the first.
  explicit PointSampler(std::span<const std::shared_ptr<const Volume>> components);

  std::size_t components() const noexcept { return readers_.size(); }

  /// Points that are sampled at a time.
  static constexpr std::size_t kMaxPoints = 512;

  template <class T>
  using Column = std::array<T, kMaxPoints>;

  /// World coordinates of the first `count` points; any will do.
  struct Points {
    std::size_t count = 0;
    std::array<Column<double>, 3> at;
  };

  /// Says for each point which of its eight voxels is the lowest, and how far the point is from
  /// it, in [0, 1).
  struct Places {
    std::array<Column<std::int32_t>, 3> voxel;
    std::array<Column<double>, 3> weight;
  };

  /// Voxels of a box, with those of z next to each other.
  struct Block {
    static constexpr std::int64_t kMaxVoxels = 1 << 13;
    VoxelBox box;
    std::int32_t rows = 0, row = 0;  ///< along y, and voxels in each
    std::array<float, kMaxVoxels> values;
  };

  /// Memory to sample in, for one sampler after the other.
  struct Workspace {
    Places places;
    Block block;
    Column<float> found;
  };

  /// Trilinear interpolation between the eight voxel centres around each point, in double, and
  /// rounded once; where nothing is stored a voxel has the background. Component c of point i
  /// goes to values[i * stride + c], and depends on the point alone.
  void sample(const Points& points,
              Workspace& workspace,
              float* values,
              std::size_t stride) noexcept;

 private:
  void sample_run(std::size_t begin,
                  std::size_t end,
                  Workspace& workspace,
                  float* values,
                  std::size_t stride) noexcept;

  VoxelTransform to_voxel_;  ///< voxel = linear * (world - translation)
  std::vector<VolumeReader> readers_;
};

}  // namespace tet
