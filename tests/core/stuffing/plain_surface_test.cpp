// What is told of all nodes of a brick at once, beside what they tell one by one.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "core/lattice/background.h"
#include "core/stuffing/count_tets.h"
#include "core/stuffing/topology/climb.h"
#include "core/stuffing/topology/count_triangles.h"
#include "core/stuffing/topology/node_link.h"
#include "core/stuffing/topology/plain_zeros.h"
#include "core/stuffing/topology/surface_regions.h"
#include "core/stuffing/topology/surface_sheet.h"
#include "tests/core/stuffing/waves.h"
#include "tests/support/sanitized.h"

namespace tet {
namespace {

using test::lattice_of, test::Waves;

const std::array<BoxCorner, 8> kBoxCorners{{{1, 1, 1},
                                            {1, 1, -1},
                                            {1, -1, 1},
                                            {1, -1, -1},
                                            {-1, 1, 1},
                                            {-1, 1, -1},
                                            {-1, -1, 1},
                                            {-1, -1, -1}}};

/// A plane through the brick: nodes on one side are `+`, those very close to it zero.
class Plane {
 public:
  explicit Plane(std::mt19937& random) {
    std::normal_distribution<double> normal;
    for (double& n : normal_) n = normal(random);
    const double length = std::hypot(normal_[0], normal_[1], normal_[2]);
    for (double& n : normal_) n /= length;
    offset_ = std::uniform_real_distribution(-4.0, 4.0)(random);
  }
  int operator()(LatticeCoord at) const {
    const double phi = offset_ + 0.5 * (normal_[0] * (at.x - 8) + normal_[1] * (at.y - 8) +
                                        normal_[2] * (at.z - 8));
    return std::abs(phi) < 0.2 ? 0 : (phi > 0 ? 1 : -1);
  }

 private:
  std::array<double, 3> normal_{};
  double offset_ = 0;
};

TEST(AllClimbToOne, HoldsOfTheWholeStarTowardsEachCorner) {
  for (const BoxCorner& corner : kBoxCorners) {
    EXPECT_TRUE(all_climb_to_one(NodePlanes(kBrickStar), corner));
  }
}

TEST(AllClimbToOne, HoldsOnlyOfNodesThatHangTogether) {
  int climbs = 0, others = 0;
  for (std::uint32_t seed = 0; seed < test::sanitized_or(60U, 300U); ++seed) {
    const auto lattice = lattice_of(Waves(seed));
    const NodePlanes plus = NodePlanes::in_star(lattice->plus);
    for (const BoxCorner& corner : kBoxCorners) {
      if (!all_climb_to_one(plus, corner)) {
        ++others;
        continue;
      }
      ++climbs;
      EXPECT_EQ(first_region(plus, {}), plus);
    }
  }
  EXPECT_GT(climbs, test::sanitized_or(10, 50));
  EXPECT_GT(others, test::sanitized_or(10, 50));
  EXPECT_FALSE(all_climb_to_one({}, {}));
}

TEST(AllClimbToOne, HoldsOfNearlyAllSidesOfPlanes) {
  std::mt19937 random(7);
  int planes = 0, seen = 0;
  while (planes < test::sanitized_or(50, 400)) {
    const auto lattice = lattice_of(Plane(random));
    const StarSigns star(lattice->plus, lattice->zero);
    if (!star.plus.any() || !star.minus.any()) continue;
    ++planes;
    const BoxCorner corner = corner_with_most(star.plus);
    seen +=
        all_climb_to_one(star.plus, corner) && all_climb_to_one(star.minus, corner.opposite())
            ? 1
            : 0;
  }
  EXPECT_GT(seen, planes * 9 / 10);
}

TEST(CornerWithMost, IsOnTheSideOfTheNodes) {
  for (const BoxCorner& corner : kBoxCorners) {
    BrickMask mask;
    const auto at = [](int sign) { return sign > 0 ? 6 : 1; };
    mask.set(at(corner.x), at(corner.y), at(corner.z));
    const BoxCorner found = corner_with_most(mask);
    EXPECT_EQ(found.x, corner.x);
    EXPECT_EQ(found.y, corner.y);
    EXPECT_EQ(found.z, corner.z);
  }
}

/// What the zeros of a lattice that are `plain` tell one by one; returns how many there are.
std::uint32_t expect_plain(const WarpedLattice& lattice, const NodeMasks& plain) {
  std::uint32_t count = 0;
  for (const NodeKind kind : {kCorner, kCentre}) {
    count += plain[kind].count();
    for_each_bit(plain[kind], [&](int x, int y, int z) {
      const int node = halo_index(x, y, z);
      EXPECT_TRUE(lattice.zero[kind].test(node));
      const NodeLink link = link_of(lattice.plus, lattice.zero, kind, node);
      EXPECT_TRUE(is_plainly_manifold(link));
      EXPECT_NE(link.plus, 0);
      EXPECT_NE(link.plus | link.zero, kAllDirections);
    });
  }
  return count;
}

TEST(PlainZeros, ArePlainlyManifold) {
  std::uint32_t plain = 0;
  for (std::uint32_t seed = 0; seed < test::sanitized_or(60U, 300U); ++seed) {
    const auto lattice = lattice_of(Waves(seed));
    const NodesNear nodes(lattice->plus, lattice->zero);
    for (const BoxCorner& corner : kBoxCorners) {
      plain += expect_plain(*lattice, plain_zeros(nodes, corner));
    }
  }
  EXPECT_GT(plain, test::sanitized_or(100U, 1000U));
}

TEST(PlainZeros, AreNearlyAllAtPlanes) {
  std::mt19937 random(8);
  std::uint32_t zeros = 0, plain = 0;
  for (int i = 0; i < test::sanitized_or(50, 400); ++i) {
    const auto lattice = lattice_of(Plane(random));
    const BrickMask plus = brick_part(lattice->plus[kCorner]);
    if (!plus.any() || plus == BrickMask::all()) continue;
    const NodesNear nodes(lattice->plus, lattice->zero);
    plain += expect_plain(*lattice, plain_zeros(nodes, corner_with_most(plus)));
    for (const NodeKind kind : {kCorner, kCentre}) {
      zeros += brick_part(lattice->zero[kind]).count();
    }
  }
  EXPECT_GT(plain, zeros * 9 / 10);
}

/// Triangles in the tets of a brick's own cells, one tet after another.
std::uint64_t triangles_of(const WarpedLattice& lattice) {
  std::uint64_t count = 0;
  for (std::size_t s = 0; s < kTetShapes; ++s) {
    const TetShape& shape = kTetShape[s];
    for_each_bit(kOwnCells, [&](int cell) {
      std::size_t plus = 0, zeros = 0, last_plus = 0;
      for (std::size_t i = 0; i < 4; ++i) {
        const int node = cell + shape.offset[i];
        if (lattice.plus[shape.kind[i]].test(node)) {
          ++plus;
          last_plus = i;
        }
        zeros += lattice.zero[shape.kind[i]].test(node) ? 1 : 0;
      }
      const std::size_t minus = 4 - plus - zeros;
      if (plus > 0 && minus > 0) count += plus == 2 && minus == 2 ? 2 : 1;
      if (plus == 1 && zeros == 3 &&
          !lattice.plus[shape.kind[last_plus]].test(cell + kMirrored[s][last_plus])) {
        ++count;
      }
    });
  }
  return count;
}

TEST(CountTriangles, IsTheSumOverTets) {
  for (std::uint32_t seed = 0; seed < test::sanitized_or(20U, 100U); ++seed) {
    SCOPED_TRACE(seed);
    const auto lattice = lattice_of(Waves(seed));
    EXPECT_EQ(count_triangles({lattice->plus, lattice->zero}), triangles_of(*lattice));
  }
}

TEST(CountTriangles, HasRoomForTheMostInACell) {
  // Each tet of the corners' and the centres' planes in turn has two of either sign.
  const auto lattice =
      lattice_of([](LatticeCoord at) { return kind_of(at) == kCorner ? 1 : -1; });
  EXPECT_EQ(count_triangles({lattice->plus, lattice->zero}), 512U * 12 * 2);
}

TEST(FindInnerZeros, LeavesOneRegionOnEitherSide) {
  int told = 0, plain = 0, with_inner = 0;
  const auto compare = [&](const WarpedLattice& lattice) {
    const SignedNodes signs{lattice.plus, lattice.zero};
    if (!surface_sheet(signs).has_plain_sides) return;
    ++plain;
    const StarSigns star(lattice.plus, lattice.zero);
    const auto inner = find_inner_zeros(star, lone_zeros(star), signs);
    if (!inner) return;
    ++told;
    with_inner += inner->any() ? 1 : 0;
    const SurfaceRegions quick(star, *inner), regions(signs);
    EXPECT_EQ(quick.inner, regions.inner);
    EXPECT_EQ(quick.zero, regions.zero);
    ASSERT_EQ(regions.inside.size(), 1U);
    ASSERT_EQ(regions.others.size(), 1U);
    EXPECT_EQ(quick.inside[0].nodes, regions.inside[0].nodes);
    EXPECT_EQ(quick.inside[0].beside, regions.inside[0].beside);
    EXPECT_EQ(quick.others[0].nodes, regions.others[0].nodes);
    EXPECT_EQ(quick.others[0].beside, regions.others[0].beside);
  };
  std::mt19937 random(9);
  for (int i = 0; i < 1000; ++i) compare(*lattice_of(Plane(random)));
  for (std::uint32_t seed = 0; seed < 600; ++seed) {
    SCOPED_TRACE(seed);
    compare(*lattice_of(Waves(seed)));
  }
  EXPECT_GT(plain, 10);
  EXPECT_GT(told, plain / 2);
  EXPECT_GT(with_inner, 0);
}

/// Whether a node lies where the brick and one some steps away meet, and is in both stars.
bool is_shared(NodeKind kind, const Cell& at, const LatticeCoord& step) {
  const auto lies_between = [](int i, int to) {
    return to == 0 ? i >= 0 && i < 8 : (to > 0 ? i >= 7 && i <= 8 : i >= -1 && i <= 0);
  };
  const std::array<int, 3> other{at.x - 8 * step.x, at.y - 8 * step.y, at.z - 8 * step.z};
  for (const int i : other) {
    if (i < -1 || i > 8) return false;
  }
  return lies_between(at.x, step.x) && lies_between(at.y, step.y) &&
         lies_between(at.z, step.z) && kBrickStar[kind].test(halo_index(at.x, at.y, at.z)) &&
         kBrickStar[kind].test(halo_index(other[0], other[1], other[2]));
}

TEST(SurfaceSheet, GoesOnInLaterBricksThatShareBothSides) {
  std::mt19937 random(10);
  int sheets = 0;
  for (int i = 0; i < test::sanitized_or(30, 150); ++i) {
    const auto lattice = lattice_of(Plane(random));
    const SurfaceSheet sheet = surface_sheet({lattice->plus, lattice->zero});
    if (!sheet.one) continue;
    ++sheets;
    for (int place = 14; place < 27; ++place) {
      const LatticeCoord step{place / 9 - 1, place / 3 % 3 - 1, place % 3 - 1};
      bool plus = false, other = false;
      for (const NodeKind kind : {kCorner, kCentre}) {
        for_each_bit(halo_cube(-1, 8), [&](int index) {
          if (!is_shared(kind, Cell(index), step)) return;
          (lattice->plus[kind].test(index) ? plus : other) = true;
        });
      }
      EXPECT_EQ((sheet.later >> (place - 14) & 1) != 0, plus && other) << place;
    }
  }
  EXPECT_GT(sheets, test::sanitized_or(5, 50));
}

}  // namespace
}  // namespace tet
