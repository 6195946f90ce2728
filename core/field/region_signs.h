// Signs of a region's bricks as bits, and which of them have both signs around them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/types.h"
#include "core/field/phi_field.h"
#include "core/volume/volume.h"
#include "core/volume/volume_reader.h"

namespace tet {

/// One bit for each of a region's 16^3 bricks: rows x*16 + y of bits z.
using RegionRows = std::array<std::uint16_t, 256>;

/// Which bricks have values inside, and which have others. Exact zeros count as outside: they
/// touch the surface either way.
struct RegionSigns {
  RegionRows inside{}, outside{};

  /// The signs of a region that has no bricks of its own, so that one value fills it.
  static RegionSigns of_constant(bool is_inside) noexcept;
};

/// The signs of every region of a volume that has bricks of its own, in their order. Parallel.
std::vector<RegionSigns> signs_of_regions(const PhiField& field);

/// The signs of a region and of the 26 around it, as far as its bricks' neighbours reach.
class SignsAround {
 public:
  SignsAround(const PhiField& field, const std::vector<RegionSigns>& of_regions);

  /// Goes to the region at `min`, a multiple of 16 bricks.
  void enter(BrickCoord min) noexcept;

  /// The region and those around it hold nothing but one sign.
  bool one_sign() const noexcept { return !any_region_ && inside_ != outside_; }
  bool inside() const noexcept { return inside_; }

  /// Bricks of the region with inside values; and those that see both signs, in their own
  /// values and those of their 26 neighbours. Not where there is but one sign.
  const RegionRows& inside_rows() const noexcept { return inside_rows_; }
  RegionRows near_surface() noexcept;

 private:
  /// Rows of 18 bricks, those of the region at 1 .. 16 along every axis.
  static constexpr std::size_t kEdge = Region::kEdgeBricks + 2;
  using HaloRows = std::array<std::uint32_t, kEdge * kEdge>;

  void add(const RegionSigns& signs, BrickCoord part) noexcept;
  static void spread(HaloRows& rows) noexcept;

  const PhiField& field_;
  const std::vector<RegionSigns>& of_regions_;
  const RegionSigns all_inside_ = RegionSigns::of_constant(true);
  const RegionSigns all_outside_ = RegionSigns::of_constant(false);
  VolumeReader reader_;
  std::array<const RegionSigns*, 27> around_{};
  bool any_region_ = false, inside_ = false, outside_ = false;
  RegionRows inside_rows_{};
  HaloRows halo_inside_{}, halo_outside_{};
};

}  // namespace tet
