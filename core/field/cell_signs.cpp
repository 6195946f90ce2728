#include "core/field/cell_signs.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/brick_box.h"
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

void add_slices(BrickMask& mask, std::uint8_t x, std::uint64_t rows) noexcept {
  for (unsigned bits = x; bits != 0; bits &= bits - 1) {
    mask.slice[static_cast<std::size_t>(std::countr_zero(bits))] |= rows;
  }
}

/// The voxel bricks along one axis that a lattice brick meets, or that lie less than a voxel
/// beyond it, and the cells that each of them reaches.
class BricksAlong {
 public:
  BricksAlong(double spacing_voxels, std::int32_t lattice_brick)
      : first_(whole(spacing_voxels * lattice_brick - 1.0 / kBrickEdge)),
        last_(whole(spacing_voxels * (lattice_brick + 1.0) + 1.0 / kBrickEdge)) {
    of_brick_.reserve(static_cast<std::size_t>(last_ - first_) + 1);
    for (std::int32_t brick = first_; brick <= last_; ++brick) {
      of_brick_.push_back(cells_of_voxels(spacing_voxels, lattice_brick, brick));
    }
  }

  std::int32_t first() const noexcept { return first_; }
  std::int32_t last() const noexcept { return last_; }
  const CellsOfVoxels& of(std::int32_t brick) const noexcept {
    return of_brick_[static_cast<std::size_t>(brick - first_)];
  }
  std::uint8_t of_all(std::int32_t first, std::int32_t last) const noexcept {
    std::uint8_t any = 0;
    for (std::int32_t brick = first; brick <= last; ++brick) any |= any_of(of(brick));
    return any;
  }

 private:
  static std::int32_t whole(double brick) noexcept {
    return static_cast<std::int32_t>(std::floor(brick));
  }

  std::int32_t first_, last_;
  std::vector<CellsOfVoxels> of_brick_;
};

/// Calls `visit(first, last)` for each region that the span lies in, with what lies in it.
template <class Visit>
void for_each_region(const BricksAlong& span, const Visit& visit) {
  constexpr std::int32_t kLastOfRegion = Region::kEdgeBricks - 1;
  for (std::int32_t first = span.first(); first <= span.last();) {
    const std::int32_t last = std::min(first | kLastOfRegion, span.last());
    visit(first, last);
    first = last + 1;
  }
}

class CellSigns {
 public:
  CellSigns(const PhiField& field, BrickCoord brick)
      : field_(field),
        x_(field.spacing_voxels, brick.x),
        y_(field.spacing_voxels, brick.y),
        z_(field.spacing_voxels, brick.z),
        reader_(*field.volume) {}

  BrickMask find() {
    for_each_region(x_, [&](std::int32_t x_first, std::int32_t x_last) {
      for_each_region(y_, [&](std::int32_t y_first, std::int32_t y_last) {
        for_each_region(z_, [&](std::int32_t z_first, std::int32_t z_last) {
          add_part({{x_first, y_first, z_first}, {x_last, y_last, z_last}});
        });
      });
    });
    return inside_ & outside_;
  }

 private:
  /// Bricks of one region.
  void add_part(const BrickBox& part) {
    constexpr std::int32_t kInRegion = ~(Region::kEdgeBricks - 1);
    const auto& [min, max] = part;
    const auto [region, constant] =
        reader_.region({min.x & kInRegion, min.y & kInRegion, min.z & kInRegion});
    if (region != nullptr) {
      return for_each_brick(part, [&](BrickCoord brick) { add_brick(brick); });
    }
    (field_.phi(constant) < 0 ? inside_ : outside_) |=
        cells_at(x_.of_all(min.x, max.x), y_.of_all(min.y, max.y), z_.of_all(min.z, max.z));
  }

  void add_brick(BrickCoord voxels) noexcept {
    const CellsOfVoxels &x = x_.of(voxels.x), &y = y_.of(voxels.y), &z = z_.of(voxels.z);
    const VolumeReader::Brick found = reader_.brick(voxels);
    const bool min_inside = field_.phi(found.range.min) < 0;
    const bool max_inside = field_.phi(found.range.max) < 0;
    if (found.values != nullptr && min_inside != max_inside) {
      return add_values(found.values, x, y, z);
    }
    (min_inside ? inside_ : outside_) |= cells_at(any_of(x), any_of(y), any_of(z));
  }

  void add_values(const float* values,
                  const CellsOfVoxels& x,
                  const CellsOfVoxels& y,
                  const CellsOfVoxels& z) noexcept {
    for (std::size_t i = 0; i < 8; ++i) {
      std::uint64_t inside = 0, outside = 0;
      for (std::size_t j = 0; j < 8; ++j) {
        std::uint8_t z_inside = 0, z_outside = 0;
        for (std::size_t k = 0; k < 8; ++k) {
          (field_.phi(*values++) < 0 ? z_inside : z_outside) |= z[k];
        }
        inside |= rows_at(y[j], z_inside);
        outside |= rows_at(y[j], z_outside);
      }
      add_slices(inside_, x[i], inside);
      add_slices(outside_, x[i], outside);
    }
  }

  const PhiField& field_;
  const BricksAlong x_, y_, z_;
  VolumeReader reader_;
  BrickMask inside_, outside_;
};

}  // namespace

BrickMask cells_with_both_signs(const PhiField& field, BrickCoord brick) {
  return CellSigns(field, brick).find();
}

}  // namespace tet
