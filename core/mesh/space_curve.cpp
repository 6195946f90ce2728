#include "core/mesh/space_curve.h"

#include <array>
#include <utility>

namespace tet {
namespace {

constexpr int kBitsPerAxis = 21;

/// Puts two zeros between the bits of a number of 21.
std::uint64_t spread(std::uint64_t n) noexcept {
  n = (n | n << 32) & 0x1f00000000ffffULL;
  n = (n | n << 16) & 0x1f0000ff0000ffULL;
  n = (n | n << 8) & 0x100f00f00f00f00fULL;
  n = (n | n << 4) & 0x10c30c30c30c30c3ULL;
  return (n | n << 2) & 0x1249249249249249ULL;
}

}  // namespace

std::uint64_t curve_code(const WorldPoint& p, const WorldBox& all) noexcept {
  constexpr double kSteps = (1 << kBitsPerAxis) - 1;
  const auto step = [](double at, double min, double max) {
    const double share = max > min ? (at - min) / (max - min) : 0;
    return spread(static_cast<std::uint64_t>(std::clamp(share, 0.0, 1.0) * kSteps));
  };
  return step(p.x, all.min.x, all.max.x) << 2 | step(p.y, all.min.y, all.max.y) << 1 |
         step(p.z, all.min.z, all.max.z);
}

/// Digit by digit from the lowest: count, then fill.
void sort_along_curve(std::vector<CurveKey>& keys, int left_out_bits) {
  constexpr int kDigitBits = 11;
  constexpr std::uint64_t kDigits = std::uint64_t{1} << kDigitBits;
  std::vector<CurveKey> sorted(keys.size());
  for (int shift = left_out_bits; shift < 3 * kBitsPerAxis; shift += kDigitBits) {
    const auto digit = [&](const CurveKey& key) { return key.code >> shift & (kDigits - 1); };
    std::array<std::uint64_t, kDigits> next{};
    for (const CurveKey& key : keys) ++next[digit(key)];
    std::uint64_t first = 0;
    for (std::uint64_t& count : next) first += std::exchange(count, first);
    for (const CurveKey& key : keys) sorted[next[digit(key)]++] = key;
    keys.swap(sorted);
  }
}

std::vector<std::uint32_t> order_along_curve(std::span<const WorldPoint> points) {
  if (points.empty()) return {};
  WorldBox all{points.front(), points.front()};
  for (const auto& [x, y, z] : points) {
    all.min = {std::min(all.min.x, x), std::min(all.min.y, y), std::min(all.min.z, z)};
    all.max = {std::max(all.max.x, x), std::max(all.max.y, y), std::max(all.max.z, z)};
  }
  constexpr int kBits = 33;  // three digits of the sort
  return order_along_curve(
      points.size(), all, [&](std::size_t i) { return points[i]; }, 3 * kBitsPerAxis - kBits);
}

}  // namespace tet
