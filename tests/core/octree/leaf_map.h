// An octree's leaves cell by cell, for tests that look at all of them.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>

#include "core/field/phi_field.h"
#include "core/octree/octree.h"
#include "core/volume/volume_builder.h"

namespace tet::test {

/// A field whose every lattice corner is inside: only the finest cells shape the tree.
struct Everywhere {
  Volume volume = *VolumeBuilder(VolumeKind::kLevelSet, 1.0F).build();
  PhiField field;
  InsideTest inside;

  explicit Everywhere(std::int64_t half) {
    field.volume = &volume;
    inside = [half](PhiSampler&, std::int64_t x, std::int64_t y, std::int64_t z) {
      return std::abs(x) < half && std::abs(y) < half && std::abs(z) < half;
    };
  }
};

inline CellSet one_cell(BrickCoord brick, int x, int y, int z) {
  BrickMask mask;
  mask.set(x, y, z);
  return {{brick}, {with_siblings(mask)}};
}

/// The level of the leaf over each finest cell from -64 to 63 along every axis.
class LeafMap {
 public:
  static constexpr int kHalf = 64, kNone = -1;

  /// kNone where there is no leaf, and beyond the map.
  int at(int x, int y, int z) const {
    return is_within(x, y, z) ? levels_[index(x, y, z)] : kNone;
  }

  /// Covers the leaf's `edge`^3 cells.
  void add(std::array<int, 3> min, int level) {
    const int edge = 1 << level;
    for (int x = min[0]; x < min[0] + edge; ++x) {
      for (int y = min[1]; y < min[1] + edge; ++y) {
        for (int z = min[2]; z < min[2] + edge; ++z) {
          ASSERT_TRUE(is_within(x, y, z));
          ASSERT_EQ(levels_[index(x, y, z)], kNone) << "two leaves cover one cell";
          levels_[index(x, y, z)] = static_cast<std::int8_t>(level);
        }
      }
    }
  }

  /// Calls `visit(x, y, z, level)` for every covered cell.
  template <class Visit>
  void for_each_cell(const Visit& visit) const {
    for (int x = -kHalf; x < kHalf; ++x) {
      for (int y = -kHalf; y < kHalf; ++y) {
        for (int z = -kHalf; z < kHalf; ++z) {
          if (const int level = at(x, y, z); level != kNone) visit(x, y, z, level);
        }
      }
    }
  }

 private:
  static bool is_within(int x, int y, int z) {
    const auto one = [](int c) { return -kHalf <= c && c < kHalf; };
    return one(x) && one(y) && one(z);
  }
  static std::size_t index(int x, int y, int z) {
    return static_cast<std::size_t>(((x + kHalf) * 2 * kHalf + y + kHalf) * 2 * kHalf + z +
                                    kHalf);
  }

  std::vector<std::int8_t> levels_ = std::vector<std::int8_t>(8 * kHalf * kHalf * kHalf, kNone);
};

inline LeafMap leaves_of(const Octree& tree) {
  LeafMap leaves;
  for (int level = 0; level < static_cast<int>(tree.levels.size()); ++level) {
    const OctreeLevel& l = tree.levels[static_cast<std::size_t>(level)];
    for (std::size_t i = 0; i < l.bricks.size(); ++i) {
      for_each_bit(l.leaf[i], [&](int x, int y, int z) {
        const int edge = 1 << level;
        leaves.add({(8 * l.bricks[i].x + x) * edge, (8 * l.bricks[i].y + y) * edge,
                    (8 * l.bricks[i].z + z) * edge},
                   level);
      });
    }
  }
  return leaves;
}

/// Over faces and edges levels differ by one at most; over corners they may by more.
inline bool is_balanced_at(const LeafMap& leaves, int x, int y, int z) {
  for (int dx = -1; dx <= 1; ++dx) {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dz = -1; dz <= 1; ++dz) {
        if (dx != 0 && dy != 0 && dz != 0) continue;
        const int other = leaves.at(x + dx, y + dy, z + dz);
        if (other != LeafMap::kNone && std::abs(other - leaves.at(x, y, z)) > 1) return false;
      }
    }
  }
  return true;
}

inline void expect_balanced(const LeafMap& leaves) {
  leaves.for_each_cell([&](int x, int y, int z, int /*level*/) {
    ASSERT_TRUE(is_balanced_at(leaves, x, y, z)) << x << ' ' << y << ' ' << z;
  });
}

}  // namespace tet::test
