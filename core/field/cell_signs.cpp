#include "core/field/cell_signs.h"

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/volume/volume_reader.h"

namespace tet {
namespace {

/// For each of a voxel brick's 8 voxels along one axis, the lattice brick's 8 cells along it
/// that the voxel has a say in: a trilinear value depends on voxels less than one away.
using CellsOfVoxels = std::array<std::uint8_t, 8>;

CellsOfVoxels cells_of_voxels(double spacing_voxels,
                              std::int32_t lattice_brick,
                              std::int32_t voxel_brick) noexcept {
  CellsOfVoxels cells{};
  for (int i = 0; i < 8; ++i) {
    const double voxel = 8.0 * voxel_brick + i;
    for (int c = 0; c < 8; ++c) {
      const double begin = spacing_voxels * (8.0 * lattice_brick + c);
      const bool reached = begin < voxel + 1 && begin + spacing_voxels > voxel - 1;
      cells[static_cast<std::size_t>(i)] |= static_cast<std::uint8_t>(reached << c);
    }
  }
  return cells;
}

std::uint8_t any_of(const CellsOfVoxels& cells) noexcept {
  std::uint8_t any = 0;
  for (const std::uint8_t c : cells) any |= c;
  return any;
}

/// A slice's bits for the cells `z` of each of the rows `y`.
std::uint64_t rows_of(std::uint8_t y, std::uint8_t z) noexcept {
  std::uint64_t rows = 0;
  for (unsigned bits = y; bits != 0; bits &= bits - 1) {
    rows |= std::uint64_t{z} << 8 * std::countr_zero(bits);
  }
  return rows;
}

void add_slices(BrickMask& mask, std::uint8_t x, std::uint64_t rows) noexcept {
  for (unsigned bits = x; bits != 0; bits &= bits - 1) {
    mask.slice[static_cast<std::size_t>(std::countr_zero(bits))] |= rows;
  }
}

class CellSigns {
 public:
  CellSigns(const PhiField& field, BrickCoord brick)
      : field_(field), brick_(brick), reader_(*field.volume) {}

  void add(BrickCoord voxels) noexcept {
    const double s = field_.spacing_voxels;
    x_ = cells_of_voxels(s, brick_.x, voxels.x);
    y_ = cells_of_voxels(s, brick_.y, voxels.y);
    z_ = cells_of_voxels(s, brick_.z, voxels.z);
    const VolumeReader::Brick found = reader_.brick(voxels);
    const bool min_inside = field_.phi(found.range.min) < 0;
    const bool max_inside = field_.phi(found.range.max) < 0;
    if (min_inside != max_inside) return add_values(found.values);
    add_slices(min_inside ? inside_ : outside_, any_of(x_), rows_of(any_of(y_), any_of(z_)));
  }

  BrickMask both() const noexcept { return inside_ & outside_; }

 private:
  void add_values(const float* values) noexcept {
    for (std::size_t i = 0; i < 8; ++i) {
      std::uint64_t inside = 0, outside = 0;
      for (std::size_t j = 0; j < 8; ++j) {
        std::uint8_t z_inside = 0, z_outside = 0;
        for (std::size_t k = 0; k < 8; ++k) {
          (field_.phi(*values++) < 0 ? z_inside : z_outside) |= z_[k];
        }
        inside |= rows_of(y_[j], z_inside);
        outside |= rows_of(y_[j], z_outside);
      }
      add_slices(inside_, x_[i], inside);
      add_slices(outside_, x_[i], outside);
    }
  }

  const PhiField& field_;
  BrickCoord brick_;
  VolumeReader reader_;
  CellsOfVoxels x_{}, y_{}, z_{};
  BrickMask inside_, outside_;
};

}  // namespace

BrickMask cells_with_both_signs(const PhiField& field, BrickCoord brick) noexcept {
  CellSigns signs(field, brick);
  // Voxel bricks that the lattice brick meets, or that lie less than a voxel beyond it.
  const double s = field.spacing_voxels;
  const auto first = [&](std::int32_t at) {
    return static_cast<std::int32_t>(std::floor(s * at - 1.0 / kBrickEdge));
  };
  const auto last = [&](std::int32_t at) {
    return static_cast<std::int32_t>(std::floor(s * (at + 1.0) + 1.0 / kBrickEdge));
  };
  for (std::int32_t x = first(brick.x); x <= last(brick.x); ++x) {
    for (std::int32_t y = first(brick.y); y <= last(brick.y); ++y) {
      for (std::int32_t z = first(brick.z); z <= last(brick.z); ++z) signs.add({x, y, z});
    }
  }
  return signs.both();
}

}  // namespace tet
