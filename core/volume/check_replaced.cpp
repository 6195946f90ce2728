#include "core/volume/check_replaced.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>

#include <absl/strings/str_format.h>

#include "core/base/brick_sets.h"

namespace tet {
namespace {

bool same_bits(std::span<const float> a, std::span<const float> b) noexcept {
  // 0 and -0 differ here, as they do where values are compared to keep what is the same.
  // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison)
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

bool same_range(const ValueRange& a, const ValueRange& b) noexcept {
  return same_bits(std::span(&a.min, 1), std::span(&b.min, 1)) &&
         same_bits(std::span(&a.max, 1), std::span(&b.max, 1));
}

std::span<const float> values_of(const Volume& volume, std::size_t brick) {
  return std::span(volume.values).subspan(brick * kBrickCells, kBrickCells);
}

/// Finds sorted bricks among others; they are asked for in ascending order.
class SortedBricks {
 public:
  explicit SortedBricks(const std::vector<BrickCoord>& bricks) : bricks_(bricks) {}

  bool have(BrickCoord brick) {
    while (at_ < bricks_.size() && bricks_[at_] < brick) ++at_;
    return at_ < bricks_.size() && bricks_[at_] == brick;
  }

 private:
  const std::vector<BrickCoord>& bricks_;
  std::size_t at_ = 0;
};

/// Calls `visit(brick, i, j)` for each brick that one of the volumes has values of, in their
/// order, with its place in either; none where it has none. Ends once that is false.
template <class Visit>
void for_each_stored(const Volume& before, const Volume& after, const Visit& visit) {
  using Place = std::optional<std::size_t>;
  std::size_t i = 0, j = 0;
  while (i < before.bricks.size() || j < after.bricks.size()) {
    const bool was = i < before.bricks.size(), is = j < after.bricks.size();
    const BrickCoord brick = was && is ? std::min(before.bricks[i], after.bricks[j])
                                       : (was ? before.bricks[i] : after.bricks[j]);
    const bool in_before = was && before.bricks[i] == brick;
    const bool in_after = is && after.bricks[j] == brick;
    if (!visit(brick, in_before ? Place(i) : Place(), in_after ? Place(j) : Place())) return;
    i += in_before;
    j += in_after;
  }
}

/// Finds the first brick with values, outside of `replaced`, that differs.
std::optional<BrickCoord> unlike_values(const Volume& before,
                                        const Volume& after,
                                        const std::vector<BrickCoord>& replaced) {
  const std::vector<BrickCoord> around = with_neighbours(replaced);
  SortedBricks named(replaced), near(around);
  std::optional<BrickCoord> unlike;
  for_each_stored(before, after, [&](BrickCoord brick, auto i, auto j) {
    const auto same = [&] {
      return i && j && same_range(before.ranges[*i], after.ranges[*j]) &&
             (!near.have(brick) || same_bits(values_of(before, *i), values_of(after, *j)));
    };
    if (!named.have(brick) && !same()) unlike = brick;
    return !unlike;
  });
  return unlike;
}

/// Calls `visit(brick)` for each brick of a region that has another constant. Those that are
/// constant in one volume alone have values in the other.
template <class Visit>
void for_each_other_constant(const Region& before, const Region& after, const Visit& visit) {
  for (std::size_t i = 0; i < before.brick_index.size(); ++i) {
    if (before.brick_index[i] != Region::kConstant) continue;
    if (after.brick_index[i] != Region::kConstant) continue;
    if (same_bits(std::span(&before.constant[i], 1), std::span(&after.constant[i], 1)))
      continue;
    const auto at = static_cast<std::int32_t>(i);
    visit(BrickCoord{before.min.x + at / 256, before.min.y + at / 16 % 16,
                     before.min.z + at % 16});
  }
}

absl::Status differs(BrickCoord brick) {
  const auto first = [](std::int32_t at) { return kBrickEdge * at; };
  const auto last = [](std::int32_t at) { return kBrickEdge * at + kBrickEdge - 1; };
  return absl::InvalidArgumentError(absl::StrFormat(
      "samples from (%d, %d, %d) to (%d, %d, %d) have changed, and are not in what is said to "
      "be "
      "replaced: name all boxes that have, or none, and both volumes are compared",
      first(brick.x), first(brick.y), first(brick.z), last(brick.x), last(brick.y),
      last(brick.z)));
}

}  // namespace

bool alike_but_for_leaves(const Volume& a, const Volume& b) {
  const auto same_cube = [](const ConstantCube& one, const ConstantCube& other) {
    return one.min == other.min && one.edge == other.edge &&
           same_bits(std::span(&one.value, 1), std::span(&other.value, 1));
  };
  const auto same_place = [](const Region& one, const Region& other) {
    return one.min == other.min;
  };
  return a.kind == b.kind && a.transform == b.transform &&
         same_bits(std::span(&a.background, 1), std::span(&b.background, 1)) &&
         std::ranges::equal(a.cubes, b.cubes, same_cube) &&
         std::ranges::equal(a.regions, b.regions, same_place);
}

absl::Status check_replaced(const Volume& before,
                            const Volume& after,
                            const std::vector<BrickCoord>& replaced) {
  auto unlike = unlike_values(before, after, replaced);
  for (std::size_t i = 0; i < before.regions.size() && !unlike; ++i) {
    for_each_other_constant(before.regions[i], after.regions[i], [&](BrickCoord brick) {
      if (!unlike && !std::ranges::binary_search(replaced, brick)) unlike = brick;
    });
  }
  return unlike ? differs(*unlike) : absl::OkStatus();
}

std::vector<BrickCoord> changed_among(const Volume& before,
                                      const Volume& after,
                                      const std::vector<BrickCoord>& replaced) {
  std::vector<BrickCoord> changed;
  SortedBricks named(replaced);
  for_each_stored(before, after, [&](BrickCoord brick, auto i, auto j) {
    if (!named.have(brick)) return true;
    const bool same = i && j && same_bits(values_of(before, *i), values_of(after, *j));
    if (!same) changed.push_back(brick);
    return true;
  });
  for (std::size_t i = 0; i < before.regions.size(); ++i) {
    for_each_other_constant(before.regions[i], after.regions[i], [&](BrickCoord brick) {
      if (std::ranges::binary_search(replaced, brick)) changed.push_back(brick);
    });
  }
  sort_unique(changed);
  return changed;
}

}  // namespace tet
