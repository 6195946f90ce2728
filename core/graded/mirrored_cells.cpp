#include "core/graded/mirrored_cells.h"

#include <array>
#include <cstddef>
#include <cstdint>

namespace tet {
namespace {

/// Along the three axes.
using Place = std::array<std::int32_t, 3>;

/// Moves cells by one step along an axis, those at the end of a brick into the next.
class Step {
 public:
  Step(std::size_t axis, bool up) : axis_(axis), step_(up ? 1 : -1) {}

  /// Cells of one brick in one layer across the axis; all go into the same brick.
  void add(BrickCoord brick, const BrickMask& layer, CellSetBuilder& builder) const {
    BrickCoord to = brick;
    BrickMask moved;
    for_each_bit(layer, [&](int x, int y, int z) {
      Place cell{x, y, z};
      cell[axis_] += step_;
      Place at{brick.x, brick.y, brick.z};
      at[axis_] += cell[axis_] >> 3;
      to = {at[0], at[1], at[2]};
      moved.set(cell[0] & 7, cell[1] & 7, cell[2] & 7);
    });
    builder.add(to, moved);
  }

 private:
  std::size_t axis_;
  std::int32_t step_;
};

/// The cells of a brick whose coordinate along an axis is `at`.
BrickMask layer_of(const BrickMask& cells, std::size_t axis, std::int32_t at) {
  BrickMask layer;
  for_each_bit(cells, [&](int x, int y, int z) {
    if (Place{x, y, z}[axis] == at) layer.set(x, y, z);
  });
  return layer;
}

}  // namespace

void add_mirrored(const BrickBox& box, int level, CellSet& cells) {
  const Place min{box.min.x, box.min.y, box.min.z}, max{box.max.x, box.max.y, box.max.z};
  CellSetBuilder images;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const bool up : {false, true}) {
      const std::int64_t face = std::int64_t{kBrickEdge} * (up ? max[axis] + 1 : min[axis]);
      if ((face >> level << level) != face) continue;
      const std::int64_t cell = (face >> level) - (up ? 1 : 0);
      const Step step(axis, up);
      for (std::size_t i = 0; i < cells.bricks.size(); ++i) {
        const BrickCoord b = cells.bricks[i];
        if (Place{b.x, b.y, b.z}[axis] != cell >> 3) continue;
        const BrickMask layer =
            layer_of(cells.cells[i], axis, static_cast<std::int32_t>(cell & 7));
        if (layer.any()) step.add(b, layer, images);
      }
    }
  }
  unite(cells, images.take());
}

}  // namespace tet
