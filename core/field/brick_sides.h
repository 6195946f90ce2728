// On which sides of the surface the parts of a volume's bricks lie that other bricks' halos
// have of them.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/field/phi_field.h"

namespace tet {

/// Voxels of a brick along an axis.
struct BrickPart {
  std::size_t first, count;
};
/// What a brick's halo has of the brick before, of the brick itself, and of the one behind.
inline constexpr std::array<BrickPart, 3> kBrickParts{{{6, 2}, {0, 8}, {0, 3}}};

/// The part that is all of a brick, numbered as by BrickSides.
inline constexpr std::size_t kAllOfBrick = 13;

/// The sides of the surface that values lie on.
struct Sides {
  bool inside = false, outside = false;

  bool both() const noexcept { return inside && outside; }
  void add(const Sides& more) noexcept {
    inside = inside || more.inside;
    outside = outside || more.outside;
  }
};

/// Remembers of each brick of a volume with values on both sides which of its parts have which.
/// A brick is looked at once, when one of its parts is asked for first. Thread-safe: whoever
/// looks finds the same.
class BrickSides {
 public:
  /// The field is of a volume, and has to outlive it.
  explicit BrickSides(const PhiField& field)
      : field_(field), parts_(field.volume->bricks.size()) {}

  /// `brick` is a place in the volume's bricks. The part is that of kBrickParts along each
  /// axis: 9*x + 3*y + z.
  Sides of_part(std::size_t brick, std::size_t part) noexcept {
    std::uint64_t parts = parts_[brick].load(std::memory_order_relaxed);
    if (parts == 0) parts = look_at(brick);
    return part_of(parts, part);
  }

  /// Reads what find_sides tells.
  static Sides part_of(std::uint64_t parts, std::size_t part) noexcept {
    return {(parts >> part & 1) != 0, (parts >> (27 + part) & 1) != 0};
  }

 private:
  std::uint64_t look_at(std::size_t brick) noexcept;

  const PhiField& field_;
  /// Parts with values inside, then those with others; 0: not looked at yet.
  std::vector<std::atomic<std::uint64_t>> parts_;
};

/// The sides of all parts of a brick of 512 values: those with values inside at the lowest
/// bits, those with others behind them.
std::uint64_t find_sides(const InsideTestOfValue& inside, const float* values) noexcept;

}  // namespace tet
