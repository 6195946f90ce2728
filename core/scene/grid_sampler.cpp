#include "core/scene/grid_sampler.h"

#include <algorithm>
#include <cmath>

#include "core/base/vector_clones.h"

namespace tet::scene {
namespace {

/// Beyond index space all is background: so far, no number leaves an int32's range.
constexpr double kFar = 2.0 * kMaxVoxelCoord - 2;

double within_reach(double voxel) noexcept {
  const double above = voxel > -kFar ? voxel : -kFar;
  return above < kFar ? above : kFar;
}

/// Half the edges of the box of voxels around a cube.
std::array<double, 3> half_voxels(const Frame& frame, double half_edge) noexcept {
  std::array<double, 3> half{};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& row = frame.linear[i];
    half[i] = half_edge * (std::abs(row[0]) + std::abs(row[1]) + std::abs(row[2]));
  }
  return half;
}

/// The voxels that points near one have their values of, along an axis. Far more room than
/// rounding errors need.
struct VoxelSpan {
  std::int32_t first, last;

  VoxelSpan(double centre, double half) noexcept {
    const double room = half + 1e-9 * (half + std::abs(centre));
    first = static_cast<std::int32_t>(std::floor(within_reach(centre - room)));
    last = static_cast<std::int32_t>(std::floor(within_reach(centre + room))) + 1;
  }
};

/// Reads one cell after another. Those beside each other mostly lie in one brick, or reach from
/// it into the same neighbours: each of them is looked up once.
class CellReader {
 public:
  explicit CellReader(VolumeReader& reader) noexcept : reader_(reader) {}

  VolumeReader::Cell read(const VoxelCoord& min) noexcept {
    const BrickCoord at{min.x >> 3, min.y >> 3, min.z >> 3};
    if (at != at_) known_ = 0;
    at_ = at;
    const int x = min.x & 7, y = min.y & 7, z = min.z & 7;
    return x < 7 && y < 7 && z < 7 ? within(x, y, z) : across(x, y, z);
  }

 private:
  VolumeReader::Cell within(int x, int y, int z) noexcept {
    const VolumeReader::Brick& brick = look_up(0);
    VolumeReader::Cell cell;
    if (brick.values == nullptr) {
      cell.fill(brick.range.min);
      return cell;
    }
    const float* v = brick.values + (x * 8 + y) * 8 + z;
    return {v[0], v[1], v[8], v[9], v[64], v[65], v[72], v[73]};
  }

  VolumeReader::Cell across(int x, int y, int z) noexcept {
    VolumeReader::Cell cell;
    for (int c = 0; c < 8; ++c) {
      const int vx = x + (c >> 2), vy = y + (c >> 1 & 1), vz = z + (c & 1);
      const VolumeReader::Brick& brick = look_up((vx >> 3) * 4 + (vy >> 3) * 2 + (vz >> 3));
      cell[static_cast<std::size_t>(c)] =
          brick.values == nullptr ? brick.range.min
                                  : brick.values[((vx & 7) * 8 + (vy & 7)) * 8 + (vz & 7)];
    }
    return cell;
  }

  /// The brick at 4*x + 2*y + z from where the cell begins.
  const VolumeReader::Brick& look_up(int i) noexcept {
    VolumeReader::Brick& brick = bricks_[static_cast<std::size_t>(i)];
    if ((known_ >> i & 1U) == 0) {
      brick = reader_.brick({at_.x + (i >> 2), at_.y + (i >> 1 & 1), at_.z + (i & 1)});
      known_ |= 1U << i;
    }
    return brick;
  }

  VolumeReader& reader_;
  BrickCoord at_;
  unsigned known_ = 0;  ///< a bit for each brick
  std::array<VolumeReader::Brick, 8> bricks_;
};

}  // namespace

GridSampler::GridSampler(const GridSource& grid)
    : reader_(*grid.volume), bounds_(&grid.bounds) {}

TET_VECTOR_CLONES
void GridSampler::place(const Instruction& leaf,
                        const Points& points,
                        std::size_t count,
                        Places& places) noexcept {
  const auto a = leaf.frame.linear;
  const auto t = leaf.frame.translation;
  for (std::size_t i = 0; i < count; ++i) {
    const double px = points.x[i], py = points.y[i], pz = points.z[i];
    const double x = within_reach(a[0][0] * px + a[0][1] * py + a[0][2] * pz + t[0]);
    const double y = within_reach(a[1][0] * px + a[1][1] * py + a[1][2] * pz + t[1]);
    const double z = within_reach(a[2][0] * px + a[2][1] * py + a[2][2] * pz + t[2]);
    const double low_x = std::floor(x), low_y = std::floor(y), low_z = std::floor(z);
    places.cell_x[i] = static_cast<std::int32_t>(low_x);
    places.cell_y[i] = static_cast<std::int32_t>(low_y);
    places.cell_z[i] = static_cast<std::int32_t>(low_z);
    places.x[i] = x - low_x;
    places.y[i] = y - low_y;
    places.z[i] = z - low_z;
  }
}

void GridSampler::focus(const Instruction& leaf,
                        const WorldPoint& centre,
                        double half_edge) noexcept {
  Points point;
  point.x[0] = centre.x;
  point.y[0] = centre.y;
  point.z[0] = centre.z;
  place(leaf, point, 1, places_);
  const std::array<double, 3> half = half_voxels(leaf.frame, half_edge);
  const VoxelSpan x(places_.cell_x[0] + places_.x[0], half[0]);
  const VoxelSpan y(places_.cell_y[0] + places_.y[0], half[1]);
  const VoxelSpan z(places_.cell_z[0] + places_.z[0], half[2]);
  focus_ = {{x.first, y.first, z.first}, {x.last, y.last, z.last}};
}

/// Whether the block has all voxels of the points that were placed, once it was copied anew
/// where that is worth it.
bool GridSampler::copy_block(std::size_t count) noexcept {
  // Fewer points are not worth it, and must not take the block from those that are.
  constexpr std::size_t kFewest = 32;
  const VoxelBox box =
      box_of_cells(places_.cell_x.data(), places_.cell_y.data(), places_.cell_z.data(), count);
  if (contains(block_.box, box)) return true;
  if (count < kFewest) return false;
  // Cells that lie beside each other are looked up in half the time of any points.
  const std::int64_t most =
      std::min(kVoxelsPerPoint / 2 * static_cast<std::int64_t>(count), VoxelBlock::kMaxVoxels);
  if (contains(focus_, box) && voxels_in(focus_) <= VoxelBlock::kMaxVoxels) {
    block_.copy(reader_, focus_);
  } else if (voxels_in(box) <= most) {
    block_.copy(reader_, box);
  } else {
    return false;
  }
  return true;
}

void GridSampler::gather(std::size_t count) noexcept {
  CellReader cells(reader_);
  for (std::size_t i = 0; i < count; ++i) {
    const VolumeReader::Cell cell =
        cells.read({places_.cell_x[i], places_.cell_y[i], places_.cell_z[i]});
    for (std::size_t c = 0; c < 8; ++c) places_.corner[c][i] = cell[c];
  }
}

/// Along z, then y, then x.
TET_VECTOR_CLONES
void GridSampler::blend(const Instruction& leaf,
                        const Places& places,
                        std::size_t count,
                        Values& values) noexcept {
  const double iso = leaf.size[0], scale = leaf.frame.scale * leaf.size[1];
  const auto& corner = places.corner;
  for (std::size_t i = 0; i < count; ++i) {
    const auto along_z = [&](std::size_t c) {
      const double low = corner[c][i], high = corner[c + 1][i];
      return low + places.z[i] * (high - low);
    };
    const double v00 = along_z(0), v01 = along_z(2), v10 = along_z(4), v11 = along_z(6);
    const double v0 = v00 + places.y[i] * (v01 - v00), v1 = v10 + places.y[i] * (v11 - v10);
    values.at[i] = scale * (v0 + places.x[i] * (v1 - v0) - iso);
  }
}

TET_VECTOR_CLONES
void GridSampler::blend_block(const Instruction& leaf,
                              const VoxelBlock& block,
                              const Places& places,
                              std::size_t count,
                              Values& values) noexcept {
  const double iso = leaf.size[0], scale = leaf.frame.scale * leaf.size[1];
  const VoxelCoord min = block.box.min;
  const std::int32_t row = block.box.max.z - min.z + 1;
  const std::int32_t slice = row * (block.box.max.y - min.y + 1);
  const float* const v = block.values.data();
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t at = (places.cell_x[i] - min.x) * slice +
                            (places.cell_y[i] - min.y) * row + (places.cell_z[i] - min.z);
    const auto along_z = [&](std::int32_t from) {
      const double low = v[from], high = v[from + 1];
      return low + places.z[i] * (high - low);
    };
    const double v00 = along_z(at), v01 = along_z(at + row);
    const double v10 = along_z(at + slice), v11 = along_z(at + slice + row);
    const double v0 = v00 + places.y[i] * (v01 - v00), v1 = v10 + places.y[i] * (v11 - v10);
    values.at[i] = scale * (v0 + places.x[i] * (v1 - v0) - iso);
  }
}

void GridSampler::evaluate(const Instruction& leaf,
                           const Points& points,
                           std::size_t count,
                           Values& values) noexcept {
  place(leaf, points, count, places_);
  if (copy_block(count)) return blend_block(leaf, block_, places_, count, values);
  gather(count);
  blend(leaf, places_, count, values);
}

void GridSampler::bound(const Instruction& leaf,
                        const Points& points,
                        std::size_t count,
                        double half_edge,
                        Values& low,
                        Values& high) noexcept {
  const std::array<double, 3> half = half_voxels(leaf.frame, half_edge);
  const double scale = leaf.frame.scale * leaf.size[1];
  place(leaf, points, count, places_);
  for (std::size_t i = 0; i < count; ++i) {
    const VoxelSpan x(places_.cell_x[i] + places_.x[i], half[0]);
    const VoxelSpan y(places_.cell_y[i] + places_.y[i], half[1]);
    const VoxelSpan z(places_.cell_z[i] + places_.z[i], half[2]);
    const auto [min, max] =
        bounds_->within(reader_, {{x.first, y.first, z.first}, {x.last, y.last, z.last}});
    const double a = scale * (static_cast<double>(min) - leaf.size[0]);
    const double b = scale * (static_cast<double>(max) - leaf.size[0]);
    low.at[i] = std::min(a, b);
    high.at[i] = std::max(a, b);
  }
}

}  // namespace tet::scene
