#include "core/mesh/quality.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include <gmock/gmock.h>

#include "core/base/parallel.h"
#include "tests/core/mesh/small_meshes.h"

namespace tet {
namespace {

std::uint64_t angles_in(const QualityStats& stats) {
  return std::accumulate(stats.histogram.begin(), stats.histogram.end(), std::uint64_t{0});
}

TEST(Quality, KnowsTheRegularTet) {
  const std::vector<WorldPoint> points{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  const TetMesh mesh = make_mesh(points, {{0, 2, 1, 3}});
  const QualityStats stats = measure_quality(mesh);
  const double angle = std::acos(1.0 / 3) * 180 / std::numbers::pi;
  EXPECT_NEAR(std::abs(stats.volume), 8.0 / 3, 1e-12);
  EXPECT_NEAR(stats.min_dihedral_deg, angle, 1e-9);
  EXPECT_NEAR(stats.max_dihedral_deg, angle, 1e-9);
  EXPECT_EQ(stats.histogram[70], 6U);
}

TEST(Quality, KnowsTheBccTet) {
  // Two corners along x, two centres along y: four angles of 60 degrees and two of 90.
  const std::vector<WorldPoint> points{{-1, 0, 0}, {1, 0, 0}, {0, -1, 1}, {0, 1, 1}};
  const TetMesh mesh = make_mesh(points, {{0, 1, 3, 2}});
  const QualityStats stats = measure_quality(mesh);
  EXPECT_NEAR(stats.min_dihedral_deg, 60, 1e-9);
  EXPECT_NEAR(stats.max_dihedral_deg, 90, 1e-9);
  EXPECT_EQ(stats.histogram[60], 4U);
  EXPECT_EQ(stats.histogram[90], 2U);
}

TEST(Quality, GivesAnInvertedTetANegativeVolumeAndTheSameAngles) {
  const QualityStats upright = measure_quality(one_tet());
  const QualityStats inverted = measure_quality(make_mesh(unit_corner(), {{0, 2, 1, 3}}));
  EXPECT_DOUBLE_EQ(upright.volume, 1.0 / 6);
  EXPECT_DOUBLE_EQ(inverted.volume, -1.0 / 6);
  EXPECT_EQ(upright.histogram, inverted.histogram);
}

TEST(Quality, CountsAnglesWithoutAFaceAsFlat) {
  const std::vector<WorldPoint> points{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}};
  const TetMesh mesh = make_mesh(points, {{0, 1, 2, 3}});
  const QualityStats stats = measure_quality(mesh);
  EXPECT_EQ(stats.volume, 0);
  EXPECT_EQ(stats.max_dihedral_deg, 180);
  EXPECT_EQ(angles_in(stats), 6U);
}

/// A few tets of several shapes whose edges are about `size` long.
TetMesh tets_of_size(double size, CoordinateType type) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> any(0, 1);
  std::vector<WorldPoint> points;
  std::vector<Corners> tets;
  for (std::uint64_t i = 0; i < 400; i += 4) {
    for (int k = 0; k < 4; ++k) {
      const auto along = [&] { return size * static_cast<double>(any(random)); };
      points.push_back({along(), along(), along()});
    }
    tets.push_back({i, i + 1, i + 2, i + 3});
  }
  TetMesh mesh = make_mesh(points, tets, {.coordinates = type});
  mesh.header.spacing = size;
  return mesh;
}

// Products of four lengths of 1e-10, or of 1e10, are no floats.
TEST(Quality, IsTheSameAtEverySize) {
  for (const CoordinateType type : {CoordinateType::kFloat32, CoordinateType::kFloat64}) {
    const QualityStats here = measure_quality(tets_of_size(1, type));
    EXPECT_EQ(angles_in(here), 600U);
    for (const int power : {-90, -40, -30, -3, 3, 30, 40, 90}) {
      const double size = std::ldexp(1.0, power);
      const QualityStats there = measure_quality(tets_of_size(size, type));
      EXPECT_EQ(there.min_dihedral_deg, here.min_dihedral_deg) << size;
      EXPECT_EQ(there.max_dihedral_deg, here.max_dihedral_deg) << size;
      EXPECT_EQ(there.histogram, here.histogram) << size;
      EXPECT_EQ(there.volume, std::ldexp(here.volume, 3 * power)) << size;
    }
  }
}

TEST(Quality, OfEachPartIsMeasuredByItsOwnSpacing) {
  TetMesh small = tets_of_size(std::ldexp(1.0, -40), CoordinateType::kFloat32);
  const QualityStats alone = measure_quality(small);
  small.header.spacing = std::ldexp(1.0, -90);
  small.header.parts = {{"none", 0, 0, 0, 0, small.header.spacing, 0},
                        {"all", 0, small.header.vertex_count, 0, small.header.tet_count,
                         std::ldexp(1.0, -40), 0}};
  const QualityStats joined = measure_quality(small);
  EXPECT_EQ(joined.histogram, alone.histogram);
  EXPECT_EQ(joined.volume, alone.volume);
}

TEST(Quality, OfNoTetIsTheNeutralElement) {
  const QualityStats nothing = measure_quality(make_mesh({}, {}));
  QualityStats stats = measure_quality(one_tet());
  stats.add(nothing);
  EXPECT_EQ(stats.min_dihedral_deg, measure_quality(one_tet()).min_dihedral_deg);
  EXPECT_EQ(stats.max_dihedral_deg, measure_quality(one_tet()).max_dihedral_deg);
  EXPECT_EQ(angles_in(nothing), 0U);
}

/// A wedge whose dihedral angle at its first edge is `degrees`.
TetMesh wedge(double degrees) {
  const double angle = degrees * std::numbers::pi / 180;
  const std::vector<WorldPoint> points{
      {0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {std::cos(angle), std::sin(angle), 0}};
  return make_mesh(points, {{0, 2, 3, 1}}, {.coordinates = CoordinateType::kFloat64});
}

TEST(Quality, PutsEveryAngleIntoTheBinOfItsWholeDegrees) {
  for (std::size_t d = 0; d < 180; ++d) {
    for (const double fraction : {0.001, 0.5, 0.999}) {
      const QualityStats stats = measure_quality(wedge(static_cast<double>(d) + fraction));
      EXPECT_GE(stats.histogram[d], 1U) << d << " + " << fraction;
    }
  }
}

TEST(Quality, FindsExtremesThatAnArcCosineFinds) {
  for (const double degrees : {0.01, 0.05, 0.3, 1.7, 9.0, 20.0, 33.0, 44.9}) {
    EXPECT_NEAR(measure_quality(wedge(degrees)).min_dihedral_deg, degrees, 1e-6);
    EXPECT_NEAR(measure_quality(wedge(180 - degrees)).max_dihedral_deg, 180 - degrees, 1e-6);
  }
}

/// A Kuhn mesh with every vertex moved a little, so that no two tets are alike.
TetMesh shaken_mesh(int n) {
  TetMesh mesh = kuhn_mesh(n);
  std::mt19937 random(7);
  std::uniform_real_distribution<float> step(-0.1F, 0.1F);
  const auto bytes = mesh.positions.bytes();
  for (std::size_t i = 0; i < bytes.size(); i += sizeof(float)) {
    float x = 0;
    std::memcpy(&x, bytes.data() + i, sizeof(x));
    x += step(random);
    std::memcpy(bytes.data() + i, &x, sizeof(x));
  }
  return mesh;
}

TEST(Quality, IsTheSameForOneThreadAndForFour) {
  const TetMesh mesh = shaken_mesh(24);
  QualityStats one, four;
  TaskPool(1).run([&] { one = measure_quality(mesh); });
  TaskPool(4).run([&] { four = measure_quality(mesh); });
  EXPECT_EQ(one.volume, four.volume);
  EXPECT_EQ(one.min_dihedral_deg, four.min_dihedral_deg);
  EXPECT_EQ(one.max_dihedral_deg, four.max_dihedral_deg);
  EXPECT_EQ(one.histogram, four.histogram);
  EXPECT_EQ(angles_in(one), 6 * mesh.header.tet_count);
}

TEST(Quality, KeepsAnglesFarFromTheOrigin) {
  const TetMesh mesh = one_tet({.origin = {1e12, -1e12, 1e12}});
  EXPECT_DOUBLE_EQ(measure_quality(mesh).volume, 1.0 / 6);
}

}  // namespace
}  // namespace tet
