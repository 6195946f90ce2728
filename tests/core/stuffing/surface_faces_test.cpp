#include "core/stuffing/surface_faces.h"

#include <gtest/gtest.h>

#include "core/stuffing/stencil.h"

namespace tet {
namespace {

unsigned zeros_of(std::size_t number) {
  const auto& nodes = internal::kSortedNodes[number];
  unsigned zeros = 0;
  for (std::size_t i = 0; i < nodes.zero_count; ++i) zeros |= 1U << nodes.zero[i];
  return zeros;
}

std::size_t faces_on_surface(StencilTets tets, unsigned zeros) {
  std::size_t faces = 0;
  for (const auto& tet : tets) faces += opposite_surface(tet, zeros) < 4 ? 1U : 0U;
  return faces;
}

/// Faces of the tets that lie on the lattice tet's face opposite node `k`.
std::size_t faces_on(std::size_t k, StencilTets tets) {
  std::size_t faces = 0;
  for (const auto& tet : tets) {
    std::size_t on = 0;
    for (const StencilVertex vertex : tet) on += kVerticesOnFace[k] >> vertex & 1;
    faces += on == 3 ? 1U : 0U;
  }
  return faces;
}

/// What is counted from signs is what every stencil, whatever its columns, has.
TEST(SurfaceFaces, AreAsManyAsCountedInEveryStencil) {
  for (std::size_t number = 0; number < kStencilCases; ++number) {
    const auto& nodes = internal::kSortedNodes[number];
    if (nodes.plus_count == 0 || nodes.minus_count == 0) continue;
    const bool has_quad = nodes.plus_count == 2 && nodes.minus_count == 2;
    for (std::size_t choice = 0; choice < kStencilChoices; ++choice) {
      EXPECT_EQ(faces_on_surface(kStencils[number][choice].tets(), zeros_of(number)),
                has_quad ? 2U : 1U)
          << number << " " << choice;
    }
    for (std::size_t choice = 0; choice < kFanChoices && has_quad; ++choice) {
      EXPECT_EQ(faces_on_surface(kFans[number][choice].tets(), 0), 4U) << number;
    }
  }
}

TEST(SurfaceFaces, OnAFaceOfTheLatticeDependOnItsOwnSignsAlone) {
  for (std::size_t number = 0; number < kStencilCases; ++number) {
    const auto& nodes = internal::kSortedNodes[number];
    if (nodes.plus_count == 0 || nodes.minus_count == 0) continue;
    for (std::uint8_t k = 0; k < 4; ++k) {
      const auto left = [k](const auto& list, std::size_t count) {
        std::size_t others = 0;
        for (std::size_t i = 0; i < count; ++i) others += list[i] != k ? 1U : 0U;
        return others;
      };
      const std::size_t plus = left(nodes.plus, nodes.plus_count);
      const std::size_t minus = left(nodes.minus, nodes.minus_count);
      for (std::size_t choice = 0; choice < kStencilChoices; ++choice) {
        EXPECT_EQ(faces_on(k, kStencils[number][choice].tets()),
                  tet::triangles_on_face(plus, minus))
            << number << " " << choice << " " << int{k};
      }
      const bool has_quad = nodes.plus_count == 2 && nodes.minus_count == 2;
      for (std::size_t choice = 0; choice < kFanChoices && has_quad; ++choice) {
        EXPECT_EQ(faces_on(k, kFans[number][choice].tets()),
                  tet::triangles_on_face(plus, minus));
      }
    }
  }
}

TEST(SurfaceFaces, TellWhichCellsLieAtTheDomainsEnd) {
  CellBox domain;
  domain.add({-1, 0, 0}, 0, BrickMask::all());
  domain.add({0, 0, 0}, 1, BrickMask::all());
  EXPECT_EQ(domain.min, (std::array<std::int64_t, 3>{-8, 0, 0}));
  EXPECT_EQ(domain.max, (std::array<std::int64_t, 3>{16, 16, 16}));
  const OuterCells finest = outer_cells(domain, {-1, 0, 0}, 0);
  EXPECT_FALSE(finest[0].any());
  EXPECT_EQ(finest[3].count(), 64U);
  EXPECT_TRUE(finest[3].test(0, 3, 5));
  EXPECT_TRUE(finest[5].test(3, 5, 0));
  EXPECT_FALSE(finest[1].any());
  const OuterCells coarse = outer_cells(domain, {0, 0, 0}, 1);
  EXPECT_TRUE(coarse[0].test(7, 1, 2));
  EXPECT_TRUE(coarse[1].test(1, 7, 2));
  EXPECT_FALSE(any(outer_cells(domain, {5, 5, 5}, 0)));
}

}  // namespace
}  // namespace tet
