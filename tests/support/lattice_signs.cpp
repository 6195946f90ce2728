#include "tests/support/lattice_signs.h"

#include <algorithm>
#include <cstddef>

#include "core/field/find_bricks.h"

namespace tet::test {

LatticeSigns::LatticeSigns(const PhiField& field, BrickCoord min, BrickCoord max)
    : min_(min),
      cells_{(max.x - min.x + 1) * kBrickEdge, (max.y - min.y + 1) * kBrickEdge,
             (max.z - min.z + 1) * kBrickEdge} {
  sign_.resize(std::size_t{2} * static_cast<std::size_t>(cells_[0]) *
               static_cast<std::size_t>(cells_[1]) * static_cast<std::size_t>(cells_[2]));
  PhiSampler sampler(field);
  const auto samples = std::make_unique_for_overwrite<BrickSamples>();
  for_each_brick({min, max}, [&](BrickCoord brick) {
    sampler.sample(brick, *samples);
    for_each_bit(halo_cube(0, 7), [&](int i) {
      for (const NodeKind kind : {kCorner, kCentre}) {
        const float phi =
            (kind == kCorner ? samples->corner : samples->centre)[static_cast<std::size_t>(i)];
        const LatticeCoord local = node_coord(kind, i);
        sign_[index_of(
            {16 * brick.x + local.x, 16 * brick.y + local.y, 16 * brick.z + local.z})] =
            static_cast<std::int8_t>((phi > 0) - (phi < 0));
      }
    });
  });
}

std::size_t LatticeSigns::index_of(LatticeCoord node) const noexcept {
  const auto along = [](std::int32_t doubled, std::int32_t brick) {
    return static_cast<std::size_t>((doubled >> 1) - brick * kBrickEdge);
  };
  const auto ny = static_cast<std::size_t>(cells_[1]), nz = static_cast<std::size_t>(cells_[2]);
  const std::size_t cell =
      (along(node.x, min_.x) * ny + along(node.y, min_.y)) * nz + along(node.z, min_.z);
  return 2 * cell + kind_of(node);
}

LatticeCoord LatticeSigns::node_of(std::size_t index) const noexcept {
  const auto kind = static_cast<std::int32_t>(index & 1);
  const auto ny = static_cast<std::size_t>(cells_[1]), nz = static_cast<std::size_t>(cells_[2]);
  const std::size_t cell = index / 2;
  const auto doubled = [&](std::size_t along, std::int32_t brick) {
    return 2 * (static_cast<std::int32_t>(along) + brick * kBrickEdge) + kind;
  };
  return {doubled(cell / (ny * nz), min_.x), doubled(cell / nz % ny, min_.y),
          doubled(cell % nz, min_.z)};
}

bool LatticeSigns::holds(LatticeCoord node, std::int32_t margin) const noexcept {
  const auto within = [&](std::int32_t doubled, std::int32_t brick, std::int32_t cells) {
    const std::int32_t at = (doubled >> 1) - brick * kBrickEdge;
    return at >= margin && at < cells - margin;
  };
  return within(node.x, min_.x, cells_[0]) && within(node.y, min_.y, cells_[1]) &&
         within(node.z, min_.z, cells_[2]);
}

bool LatticeSigns::holds(LatticeCoord node) const noexcept { return holds(node, 0); }

bool LatticeSigns::in_margin(LatticeCoord node) const noexcept {
  return !holds(node, kBrickEdge);
}

int LatticeSigns::at(LatticeCoord node) const noexcept {
  return holds(node) ? sign_[index_of(node)] : 1;
}

bool LatticeSigns::has_opposite_neighbour(LatticeCoord node) const noexcept {
  return std::ranges::any_of(kDirection,
                             [&](LatticeCoord d) { return opposite(node, node + d); });
}

bool LatticeSigns::deep(LatticeCoord node, int sign) const noexcept {
  return at(node) == sign &&
         std::ranges::all_of(kDirection, [&](LatticeCoord d) { return at(node + d) == sign; });
}

}  // namespace tet::test
