#include "core/fidelity/tet_sums.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/base/tet_geometry.h"

namespace tet {
namespace {

/// Bits of a sum: some are left for what lies a little outside the header's bounds.
constexpr int kBits = 56;

double six_volumes_of(const WorldBox& box) noexcept {
  const Vector size = from_to(box.min, box.max);
  return 6 * size.x * size.y * size.z;
}

}  // namespace

WholeSum::WholeSum(double most) noexcept {
  int exponent = 0;
  std::frexp(most, &exponent);
  unit_ = std::ldexp(1.0, std::isfinite(most) ? exponent - kBits : 0);
}

void WholeSum::add(double value) noexcept {
  constexpr double kMost = 0x1p62;
  const double units = std::clamp(value / unit_, -kMost, kMost);
  if (std::isnan(units)) return;
  units_ += static_cast<std::uint64_t>(std::llrint(units));
}

double WholeSum::value() const noexcept {
  return unit_ * static_cast<double>(static_cast<std::int64_t>(units_));
}

TetSums::TetSums(const MeshHeader& header)
    : header_(&header),
      six_volumes_(std::max<std::size_t>(1, header.parts.size()),
                   WholeSum(six_volumes_of(header.bounds))) {}

void TetSums::add(std::uint64_t tet,
                  const std::array<WorldPoint, 4>& place,
                  MeshRegion region) {
  shapes_.add(tet, place, *header_);
  if (region != MeshRegion::kInside) return;
  const auto& [a, b, c, d] = place;
  six_volumes_[part_of(tet)].add(dot(cross(from_to(a, b), from_to(a, c)), from_to(a, d)));
}

void TetSums::add(const TetSums& other) {
  for (std::size_t i = 0; i < six_volumes_.size(); ++i) {
    six_volumes_[i].add(other.six_volumes_[i]);
  }
  shapes_.add(other.shapes_);
}

std::vector<double> TetSums::volumes() const {
  std::vector<double> volumes;
  for (const WholeSum& sum : six_volumes_) volumes.push_back(sum.value() / 6);
  return volumes;
}

/// Nearly always that of the tet before.
std::size_t TetSums::part_of(std::uint64_t tet) noexcept {
  const auto& parts = header_->parts;
  const auto has = [&](std::size_t i) {
    return tet >= parts[i].first_tet && tet - parts[i].first_tet < parts[i].tet_count;
  };
  if (parts.empty() || has(part_)) return part_;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (has(i)) part_ = i;
  }
  return part_;
}

}  // namespace tet
