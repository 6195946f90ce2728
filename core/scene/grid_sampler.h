// The leaves of a scene that are grids: phi at many points, and its range in cubes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/types.h"
#include "core/scene/grid_source.h"
#include "core/scene/instruction.h"
#include "core/volume/volume_reader.h"
#include "core/volume/voxel_block.h"

namespace tet::scene {

/// Samples one grid. Not thread-safe: one per task. The grid must outlive it.
///
/// A leaf's phi is its frame's scale times the trilinear value less the iso value, negative
/// inside.
class GridSampler {
 public:
  explicit GridSampler(const GridSource& grid);

  /// Until the next focus most points of that leaf lie in the cube around `centre`.
  void focus(const Instruction& leaf, const WorldPoint& centre, double half_edge) noexcept;

  /// Writes a leaf's phi at the first `count` points. A value depends on its point alone.
  void evaluate(const Instruction& leaf,
                const Points& points,
                std::size_t count,
                Values& values) noexcept;

  /// Bounds of a leaf's phi in the cubes around the first `count` points.
  void bound(const Instruction& leaf,
             const Points& points,
             std::size_t count,
             double half_edge,
             Values& low,
             Values& high) noexcept;

 private:
  /// Points in index space: the cells that they lie in, how far, and what is at their corners.
  struct Places {
    alignas(64) std::array<std::int32_t, kMaxPoints> cell_x, cell_y, cell_z;
    alignas(64) std::array<double, kMaxPoints> x, y, z;  ///< in [0, 1]
    /// Values of the eight voxels around each point; that of (x, y, z) is at 4*x + 2*y + z.
    alignas(64) std::array<std::array<float, kMaxPoints>, 8> corner;
  };

  bool copy_block(std::size_t count) noexcept;
  void gather(std::size_t count) noexcept;

  VolumeReader reader_;
  const ValueBounds* bounds_;
  VoxelBox focus_;  ///< voxels; empty where nobody said where points lie
  Places places_;
  VoxelBlock block_;  ///< the last that was worth copying

  static void place(const Instruction& leaf,
                    const Points& points,
                    std::size_t count,
                    Places& places) noexcept;
  static void blend(const Instruction& leaf,
                    const Places& places,
                    std::size_t count,
                    Values& values) noexcept;
  static void blend_block(const Instruction& leaf,
                          const VoxelBlock& block,
                          const Places& places,
                          std::size_t count,
                          Values& values) noexcept;
};

}  // namespace tet::scene
