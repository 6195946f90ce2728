#include "tests/support/conformity.h"

#include <gmock/gmock.h>

#include "tests/core/mesh/small_meshes.h"

namespace tet {
namespace {

using ::testing::HasSubstr;

template <class... Points>
std::vector<WorldPoint> unit_corner_and(Points... more) {
  std::vector<WorldPoint> points = unit_corner();
  (points.push_back(more), ...);
  return points;
}

TEST(Conformity, AcceptsOneTet) {
  const ConformityReport report = check_conformity(one_tet());
  EXPECT_TRUE(report.conforming()) << report.describe();
  EXPECT_EQ(report.boundary_faces, 4U);
  EXPECT_EQ(report.inner_faces, 0U);
}

TEST(Conformity, AcceptsTwoTetsAtAFace) {
  const std::vector<Corners> tets{{0, 1, 2, 3}, {4, 1, 3, 2}};
  const WorldPoint apex{1, 1, 1};
  const TetMesh mesh = make_mesh(unit_corner_and(apex), tets);
  const ConformityReport report = check_conformity(mesh);
  EXPECT_TRUE(report.conforming()) << report.describe();
  EXPECT_EQ(report.inner_faces, 1U);
  EXPECT_EQ(report.boundary_faces, 6U);
}

TEST(Conformity, AcceptsACubeOfFiveTets) {
  const std::vector<Corners> tets{
      {0, 5, 6, 3}, {1, 5, 0, 3}, {2, 3, 0, 6}, {4, 6, 0, 5}, {7, 5, 3, 6}};
  const TetMesh mesh = make_mesh(lattice_points(1), tets);
  const ConformityReport report = check_conformity(mesh);
  EXPECT_TRUE(report.conforming()) << report.describe();
  EXPECT_EQ(report.inner_faces, 4U);
}

TEST(Conformity, AcceptsManyCubes) {
  const ConformityReport report = check_conformity(kuhn_mesh(8));
  EXPECT_TRUE(report.conforming()) << report.describe();
  EXPECT_EQ(report.boundary_faces, 12U * 64);
  EXPECT_EQ(report.inner_faces, (4U * 6 * 512 - 12U * 64) / 2);
}

TEST(Conformity, NoticesAnInvertedTet) {
  const std::vector<Corners> tets{{0, 2, 1, 3}};
  const ConformityReport report = check_conformity(make_mesh(unit_corner(), tets));
  EXPECT_EQ(report.non_positive_tets.count, 1U);
  EXPECT_EQ(report.non_positive_tets.first, 0U);
  EXPECT_THAT(report.describe(), HasSubstr("1 tets that are not positive, first 0"));
}

TEST(Conformity, NoticesAFlatTet) {
  const std::vector<Corners> tets{{0, 1, 2, 3}};
  const std::vector<WorldPoint> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  const TetMesh mesh = make_mesh(points, tets);
  EXPECT_EQ(check_conformity(mesh).non_positive_tets.count, 1U);
}

TEST(Conformity, NoticesAPositionThatIsNotANumber) {
  const std::vector<Corners> tets{{0, 1, 2, 3}};
  const std::vector<WorldPoint> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, std::nan("")}};
  const TetMesh mesh = make_mesh(points, tets);
  EXPECT_EQ(check_conformity(mesh).non_positive_tets.count, 1U);
}

TEST(Conformity, NoticesTwoTetsOnOneSideOfAFace) {
  const std::vector<Corners> tets{{0, 1, 2, 3}, {4, 1, 2, 3}};
  const WorldPoint apex{0.1, 0.1, 0.1};
  const TetMesh mesh = make_mesh(unit_corner_and(apex), tets);
  const ConformityReport report = check_conformity(mesh);
  EXPECT_EQ(report.non_positive_tets.count, 0U);
  EXPECT_EQ(report.folded_faces.count, 1U);
  EXPECT_EQ(report.inner_faces, 0U);
}

TEST(Conformity, NoticesAFaceOfThreeTets) {
  const std::vector<Corners> tets{{0, 1, 2, 3}, {4, 1, 3, 2}, {5, 1, 3, 2}};
  const WorldPoint p4{1, 1, 1};
  const WorldPoint p5{2, 2, 2};
  const TetMesh mesh = make_mesh(unit_corner_and(p4, p5), tets);
  const ConformityReport report = check_conformity(mesh);
  EXPECT_EQ(report.crowded_faces.count, 1U);
  EXPECT_FALSE(report.conforming());
}

TEST(Conformity, NoticesATetThatIsThereTwice) {
  const std::vector<Corners> tets{{0, 1, 2, 3}, {0, 1, 2, 3}};
  const ConformityReport report = check_conformity(make_mesh(unit_corner(), tets));
  EXPECT_EQ(report.folded_faces.count, 4U);
}

TEST(Conformity, NoticesAVertexThatNoTetUses) {
  const std::vector<Corners> tets{{0, 1, 2, 3}};
  const WorldPoint apex{5, 5, 5};
  const ConformityReport report = check_conformity(make_mesh(unit_corner_and(apex), tets));
  EXPECT_EQ(report.unreferenced_vertices.count, 1U);
  EXPECT_EQ(report.unreferenced_vertices.first, 4U);
}

TEST(Conformity, NoticesTwoVerticesAtOnePlaceWhateverTheSignOfZero) {
  const std::vector<Corners> tets{{0, 1, 2, 3}, {4, 5, 7, 6}};
  const WorldPoint p4{-0.0, 0, 0};
  const WorldPoint p5{-1, 0, 0};
  const WorldPoint p6{0, -1, 0};
  const WorldPoint p7{0, 0, -1};
  const TetMesh mesh = make_mesh(unit_corner_and(p4, p5, p6, p7), tets);
  const ConformityReport report = check_conformity(mesh);
  EXPECT_EQ(report.non_positive_tets.count, 0U);
  EXPECT_EQ(report.duplicate_vertices.count, 1U);
  EXPECT_EQ(report.duplicate_vertices.first, 4U);
}

TEST(Conformity, NoticesIdsOutOfRangeAndRepeated) {
  const std::vector<Corners> tets{{0, 1, 2, 3}, {0, 1, 2, 4}, {0, 1, 1, 3}};
  const TetMesh mesh = make_mesh(unit_corner(), tets, {.ids = IndexType::kUint64});
  const ConformityReport report = check_conformity(mesh);
  EXPECT_EQ(report.bad_ids.count, 2U);
  EXPECT_EQ(report.bad_ids.first, 1U);
  EXPECT_FALSE(report.conforming());
}

}  // namespace
}  // namespace tet
