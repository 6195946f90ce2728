#include "core/volume/voxel_block.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "core/base/vector_clones.h"

namespace tet {
namespace {

struct Span {
  std::int32_t min, max;
};

/// Written without std::min, which refers to what it compares: that becomes no vectors.
TET_VECTOR_CLONES
Span span_of(const std::int32_t* at, std::size_t count) noexcept {
  Span span{at[0], at[0]};
  for (std::size_t i = 1; i < count; ++i) {
    const std::int32_t value = at[i];
    span.min = value < span.min ? value : span.min;
    span.max = value > span.max ? value : span.max;
  }
  return span;
}

/// Calls `copy(brick, the part of the box in it)` for each brick that the box reaches into.
template <class Copy>
void for_each_brick(const VoxelBox& box, const Copy& copy) noexcept {
  constexpr std::int32_t kShift = 3;
  const auto part = [](std::int32_t brick, std::int32_t min, std::int32_t max) {
    const std::int32_t first = brick * kBrickEdge;
    return std::pair(std::max(first, min), std::min(first + kBrickEdge - 1, max));
  };
  for (std::int32_t x = box.min.x >> kShift; x <= box.max.x >> kShift; ++x) {
    const auto [x0, x1] = part(x, box.min.x, box.max.x);
    for (std::int32_t y = box.min.y >> kShift; y <= box.max.y >> kShift; ++y) {
      const auto [y0, y1] = part(y, box.min.y, box.max.y);
      for (std::int32_t z = box.min.z >> kShift; z <= box.max.z >> kShift; ++z) {
        const auto [z0, z1] = part(z, box.min.z, box.max.z);
        copy(BrickCoord{x, y, z}, VoxelBox{{x0, y0, z0}, {x1, y1, z1}});
      }
    }
  }
}

/// Most rows are whole: those are copied without a call.
inline void copy_row(const float* from, std::size_t count, float* to) noexcept {
  if (count == kBrickEdge) {
    std::memcpy(to, from, kBrickEdge * sizeof(float));
  } else {
    std::copy_n(from, count, to);
  }
}

}  // namespace

std::int64_t voxels_in(const VoxelBox& box) noexcept {
  const auto edge = [](std::int32_t min, std::int32_t max) {
    // Longer ones need not be told apart, and their product is a number yet.
    return std::min<std::int64_t>(std::int64_t{max} - min + 1, 1 << 20);
  };
  return edge(box.min.x, box.max.x) * edge(box.min.y, box.max.y) * edge(box.min.z, box.max.z);
}

bool contains(const VoxelBox& outer, const VoxelBox& inner) noexcept {
  const auto within = [](std::int32_t low, std::int32_t min, std::int32_t max,
                         std::int32_t high) { return low <= min && max <= high; };
  return within(outer.min.x, inner.min.x, inner.max.x, outer.max.x) &&
         within(outer.min.y, inner.min.y, inner.max.y, outer.max.y) &&
         within(outer.min.z, inner.min.z, inner.max.z, outer.max.z);
}

VoxelBox box_of_cells(const std::int32_t* x,
                      const std::int32_t* y,
                      const std::int32_t* z,
                      std::size_t count) noexcept {
  const Span of_x = span_of(x, count), of_y = span_of(y, count), of_z = span_of(z, count);
  return {{of_x.min, of_y.min, of_z.min}, {of_x.max + 1, of_y.max + 1, of_z.max + 1}};
}

void copy_voxels(VolumeReader& reader, const VoxelBox& box, float* values) noexcept {
  const VoxelCoord min = box.min;
  const std::int32_t rows = box.max.y - min.y + 1, length = box.max.z - min.z + 1;
  for_each_brick(box, [&](BrickCoord coord, const VoxelBox& part) {
    const VolumeReader::Brick brick = reader.brick(coord);
    const auto count = static_cast<std::size_t>(part.max.z - part.min.z + 1);
    for (std::int32_t x = part.min.x; x <= part.max.x; ++x) {
      for (std::int32_t y = part.min.y; y <= part.max.y; ++y) {
        float* const row = values + std::ptrdiff_t{(x - min.x) * rows + y - min.y} * length +
                           part.min.z - min.z;
        if (brick.values == nullptr) {
          std::fill_n(row, count, brick.range.min);
        } else {
          copy_row(brick.values + ((x & 7) * 8 + (y & 7)) * 8 + (part.min.z & 7), count, row);
        }
      }
    }
  });
}

void VoxelBlock::copy(VolumeReader& reader, const VoxelBox& from) noexcept {
  box = from;
  copy_voxels(reader, box, values.data());
}

TET_VECTOR_CLONES
void interpolate_in(const VoxelBlock& block,
                    const double* x,
                    const double* y,
                    const double* z,
                    std::size_t count,
                    double* values) noexcept {
  const float* const v = block.values.data();
  const VoxelCoord min = block.box.min;
  const std::int32_t row = block.box.max.z - min.z + 1;
  const std::int32_t slice = row * (block.box.max.y - min.y + 1);
  for (std::size_t i = 0; i < count; ++i) {
    const double low_x = std::floor(x[i]), low_y = std::floor(y[i]), low_z = std::floor(z[i]);
    const std::int32_t at = (static_cast<std::int32_t>(low_x) - min.x) * slice +
                            (static_cast<std::int32_t>(low_y) - min.y) * row +
                            (static_cast<std::int32_t>(low_z) - min.z);
    const auto along_z = [&](std::int32_t from) {
      const double low = v[from], high = v[from + 1];
      return low + (z[i] - low_z) * (high - low);
    };
    const auto along_y = [&](std::int32_t from) {
      const double low = along_z(from);
      return low + (y[i] - low_y) * (along_z(from + row) - low);
    };
    const double low = along_y(at);
    values[i] = low + (x[i] - low_x) * (along_y(at + slice) - low);
  }
}

}  // namespace tet
