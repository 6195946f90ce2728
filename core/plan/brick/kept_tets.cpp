#include "core/plan/brick/kept_tets.h"

#include <cstddef>
#include <cstdint>

#include "core/lattice/background.h"
#include "core/lattice/bcc.h"
#include "core/stuffing/count_tets.h"

namespace tet {
namespace {

std::uint64_t fans_of(const TetsOfBrick& brick, std::size_t shape, std::size_t x) noexcept {
  return brick.fans == nullptr ? 0 : (*brick.fans)[shape].slice[x];
}

void pass_shape(const TetsOfBrick& before,
                const TetsOfBrick& now,
                const BrickMask& kept,
                std::size_t shape,
                RunWalk& walk) {
  const NumberedShape had = number_shape(before.nodes, shape);
  const NumberedShape has = number_shape(now.nodes, shape);
  walk.pass(had.whole, has.whole, kept);
  for (std::size_t x = 0; x < kept.slice.size(); ++x) {
    const auto count = [&](const NumberedShape& counted, const TetsOfBrick& brick) {
      return [&, x](std::uint64_t cells) {
        return counted.count_cut(x, cells, fans_of(brick, shape, x));
      };
    };
    walk.pass(had.cut.slice[x], has.cut.slice[x], kept.slice[x], count(had, before),
              count(has, now));
  }
}

}  // namespace

void pass_tets(TetsOfBrick& before,
               TetsOfBrick& now,
               const BrickMask& kept,
               std::span<const MeshRegion> regions,
               RunWalk& walk) {
  for (const MeshRegion region : regions) {
    if (region == MeshRegion::kOutside) {
      see_from_outside(before.nodes);
      see_from_outside(now.nodes);
    }
    for (std::size_t shape = 0; shape < kTetShapes; ++shape) {
      pass_shape(before, now, kept, shape, walk);
    }
    for (int direction = 0; direction < kFaceDirections; ++direction) {
      walk.pass(half_pyramids_of_finest(before.nodes, direction),
                half_pyramids_of_finest(now.nodes, direction), kept, 2);
    }
  }
}

void leave_tets_of(const BrickMask& cells, CellNodes& nodes) noexcept {
  for (BrickMask& pairs : nodes.pairs) pairs &= cells;
  for (BrickMask& ends : nodes.ends) ends &= cells;
}

}  // namespace tet
