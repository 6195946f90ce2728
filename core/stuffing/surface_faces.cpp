#include "core/stuffing/surface_faces.h"

#include <bit>

namespace tet {
namespace {

/// Bits of a slice whose cells stay within it when they are moved by (y, z).
constexpr std::uint64_t stay_within(int dy, int dz) noexcept {
  std::uint64_t bits = 0;
  for (int bit = 0; bit < 64; ++bit) {
    const int y = (bit >> 3) + dy, z = (bit & 7) + dz;
    if (y >= 0 && y < 8 && z >= 0 && z < 8) bits |= std::uint64_t{1} << bit;
  }
  return bits;
}

/// Where the node behind a tet `+000` lies, from the tet's cell.
struct Behind {
  int x = 0, y = 0, z = 0;
  std::uint64_t within = 0;  ///< see stay_within

  /// What a slice says of the nodes behind those of its cells that stay within it.
  constexpr std::uint64_t seen(std::uint64_t slice) const noexcept {
    const int bits = 8 * y + z;
    return bits < 0 ? slice << -bits : slice >> bits;
  }
};

/// By shape, and by which of its nodes is the `+`.
constexpr auto kBehind = [] {
  std::array<std::array<Behind, 4>, kTetShapes> behind{};
  for (std::size_t s = 0; s < kTetShapes; ++s) {
    for (std::size_t k = 0; k < 4; ++k) {
      constexpr int kMiddle = 4;
      const Cell at(halo_index(kMiddle, kMiddle, kMiddle) + kMirrored[s][k]);
      const int y = at.y - kMiddle, z = at.z - kMiddle;
      behind[s][k] = {at.x - kMiddle, y, z, stay_within(y, z)};
    }
  }
  return behind;
}();

/// Keeps of some tets `+000` those whose face of zeros has no tet of the inside behind it, and
/// does not lie at the domain's end. Most tets have the node behind in the brick: these are
/// looked at a slice at a time.
class OpenTets {
 public:
  OpenTets(const CellNodes& inside, const FacesAround& around, std::size_t shape) noexcept
      : inside_(inside), around_(around), nodes_(around.around), shape_(shape) {}

  TetsOnSurface among(const BrickMask& three_zeros) const noexcept {
    TetsOnSurface open;
    for (std::size_t x = 0; x < 8; ++x) {
      std::uint64_t left = three_zeros.slice[x];
      for (std::size_t plus = 0; left != 0 && plus < 4; ++plus) {
        const std::uint64_t tets = left & plus_mask(plus).slice[x];
        left &= ~tets;
        if (tets == 0) continue;
        const std::uint64_t found = among(tets, plus, static_cast<int>(x));
        open.tets.slice[x] |= found;
        if ((plus & 1) != 0) open.plus_is_odd.slice[x] |= found;
        if ((plus & 2) != 0) open.plus_is_high.slice[x] |= found;
      }
    }
    return open;
  }

  std::uint32_t count(const BrickMask& three_zeros) const noexcept {
    std::uint32_t open = 0;
    for (std::size_t x = 0; x < 8; ++x) {
      std::uint64_t left = three_zeros.slice[x];
      for (std::size_t plus = 0; left != 0 && plus < 4; ++plus) {
        const std::uint64_t tets = left & plus_mask(plus).slice[x];
        left &= ~tets;
        if (tets == 0) continue;
        open +=
            static_cast<std::uint32_t>(std::popcount(among(tets, plus, static_cast<int>(x))));
      }
    }
    return open;
  }

 private:
  /// A tet that is asked for has one `+` node.
  const BrickMask& plus_mask(std::size_t plus) const noexcept {
    const TetShape& of = kTetShape[shape_];
    return inside_.plus[of.kind[plus]][node_around_cell(of, plus)];
  }

  std::uint64_t among(std::uint64_t tets, std::size_t plus, int x) const noexcept {
    constexpr std::size_t kMiddle = 13;  // of the bricks around, the brick itself
    const Behind& behind = kBehind[shape_][plus];
    const StuffedBrick* const own = around_.around[kMiddle];
    const int slice = x + behind.x;
    const bool is_within =
        own != nullptr && around_.domain == nullptr && slice >= 0 && slice < 8;
    const std::uint64_t within = is_within ? tets & behind.within : 0;
    std::uint64_t open = 0;
    if (within != 0) {
      const BrickMask& is_plus = own->plus[kTetShape[shape_].kind[plus]];
      open = within & ~behind.seen(is_plus.slice[static_cast<std::size_t>(slice)]);
    }
    for (std::uint64_t bits = tets & ~within; bits != 0; bits &= bits - 1) {
      const int bit = std::countr_zero(bits);
      if (is_open(plus, x, bit >> 3, bit & 7)) open |= bits & -bits;
    }
    return open;
  }

  bool is_open(std::size_t plus, int x, int y, int z) const noexcept {
    const bool at_end = around_.domain != nullptr &&
                        (around_.domain->behind_dents(shape_, x, y, z) >> plus & 1) != 0;
    const Behind& behind = kBehind[shape_][plus];
    return !at_end && !nodes_.is_plus(kTetShape[shape_].kind[plus], x + behind.x, y + behind.y,
                                      z + behind.z);
  }

  const CellNodes& inside_;
  const FacesAround& around_;
  NodesAround nodes_;
  std::size_t shape_;
};

}  // namespace

TetsOnSurface tets_on_surface(const CellNodes& inside,
                              const FacesAround& around,
                              std::size_t shape) noexcept {
  return OpenTets(inside, around, shape).among(tets_on_three_zeros(inside, shape));
}

FinestCounts count_finest_with_faces(const CellNodes& inside,
                                     const FacesAround& around,
                                     const FanMasks* fans) noexcept {
  ThreeZeros three_zeros;
  FinestCounts counts = count_finest_and_surface(inside, fans, three_zeros);
  for (std::size_t shape = 0; shape < kTetShapes; ++shape) {
    counts.triangles += OpenTets(inside, around, shape).count(three_zeros[shape]);
    if (fans != nullptr)
      counts.triangles += 2 * std::uint64_t{(*fans)[shape].count()};  // 4, not 2
  }
  return counts;
}

}  // namespace tet
