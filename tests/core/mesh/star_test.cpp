#include "core/mesh/improve/star.h"

#include <gtest/gtest.h>

#include "core/mesh/quality.h"
#include "tests/core/mesh/small_meshes.h"

namespace tet {
namespace {

AngleGoal goal(double min_deg, double max_deg) {
  return {{signed_square_of_cosine(min_deg), signed_square_of_cosine(max_deg)}};
}

/// Eight tets around the origin, at the corners of an octahedron; the origin is vertex 0.
TetMesh octahedron() {
  std::vector<Corners> tets;
  for (std::uint64_t x : {1, 2}) {
    for (std::uint64_t y : {3, 4}) {
      for (std::uint64_t z : {5, 6}) {
        const bool odd = (x + y + z) % 2 != 0;
        tets.push_back(odd ? Corners{0, x, y, z} : Corners{0, y, x, z});
      }
    }
  }
  return make_mesh(
      {{0, 0, 0}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}, tets);
}

VertexStars star_of_origin(const TetMesh& mesh) {
  return {mesh, std::vector<std::uint64_t>{0}};
}

/// This bound refuses no angles.
constexpr StarBound kNoBound{{2, -2}, 2};

TEST(Star, HasTheAnglesOfTheMeshWhereverItsMiddleIs) {
  TetMesh mesh = octahedron();
  const VertexStars stars = star_of_origin(mesh);
  Star star(goal(20, 145));
  star.gather(mesh, stars.star(stars.number(0)));
  for (const WorldPoint middle : {WorldPoint{0, 0, 0}, WorldPoint{0.25, 0.125, -0.375}}) {
    mesh.store_position(0, middle);
    const AngleRange angles = star.angles(middle);
    const QualityStats measured = measure_quality(mesh);
    EXPECT_NEAR(degrees_of(angles.largest_cosine), measured.min_dihedral_deg, 1e-9);
    EXPECT_NEAR(degrees_of(angles.smallest_cosine), measured.max_dihedral_deg, 1e-9);
    const auto cost = star.cost_below(kNoBound, middle);
    ASSERT_TRUE(cost.has_value());
    EXPECT_EQ(*cost, goal(20, 145).cost(angles));
  }
}

TEST(Star, RefusesPlacesThatTurnATetInsideOut) {
  const TetMesh mesh = octahedron();
  const VertexStars stars = star_of_origin(mesh);
  Star star(goal(20, 145));
  star.gather(mesh, stars.star(stars.number(0)));
  EXPECT_TRUE(star.cost_below(kNoBound, {0.3, 0.3, 0.3}).has_value());
  EXPECT_FALSE(star.cost_below({{1, -1}, 1}, {0.4, 0.4, 0.4}).has_value());
}

TEST(Star, RefusesWhatPassesTheBoundInOneTet) {
  const TetMesh mesh = octahedron();
  const VertexStars stars = star_of_origin(mesh);
  Star star(goal(20, 145));
  star.gather(mesh, stars.star(stars.number(0)));
  const WorldPoint middle{0.1, 0, 0};
  const AngleRange angles = star.angles(middle);
  const double cost = goal(20, 145).cost(angles);
  StarBound bound{{angles.largest_cosine + 1e-6, angles.smallest_cosine - 1e-6}, cost + 1e-6};
  EXPECT_TRUE(star.cost_below(bound, middle).has_value());
  for (double* end : {&bound.range.largest_cosine, &bound.range.smallest_cosine, &bound.cost}) {
    const double kept = *end;
    *end += end == &bound.range.smallest_cosine ? 2e-6 : -2e-6;
    EXPECT_FALSE(star.cost_below(bound, middle).has_value());
    *end = kept;
  }
}

TEST(Star, DescendsTowardsTheMiddleOfAnOctahedron) {
  const TetMesh mesh = octahedron();
  const VertexStars stars = star_of_origin(mesh);
  Star star(goal(20, 145));
  star.gather(mesh, stars.star(stars.number(0)));
  const WorldPoint middle{0.3, 0, 0};
  star.angles(middle);
  EXPECT_LT(star.descent(middle, 1e-4).x, 0);
}

TEST(AngleGoal, CostsTheSameAtBothEnds) {
  const AngleGoal both = goal(20, 145);
  EXPECT_DOUBLE_EQ(both.cost({signed_square_of_cosine(20), 0}), both.good_cost());
  EXPECT_DOUBLE_EQ(both.cost({0, signed_square_of_cosine(145)}), both.good_cost());
  EXPECT_LT(both.cost({signed_square_of_cosine(21), signed_square_of_cosine(144)}),
            both.good_cost());
}

}  // namespace
}  // namespace tet
