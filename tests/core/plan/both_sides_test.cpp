// What a mesh of both sides promises: one conforming mesh of the whole box, labelled.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/mesh/boundary.h"
#include "core/mesh/quality.h"
#include "core/mesh/regions.h"
#include "core/plan/make/mesher.h"
#include "tests/core/plan/meshing.h"
#include "tests/support/conformity.h"
#include "tests/support/sanitized.h"
#include "tests/support/solids.h"
#include "tests/support/volume_fixtures.h"

namespace tet::both_sides_test {
namespace {

using test::mesh;
using test::same_bytes;

using test::Solid;

/// What tests/certificate proves of the preset.
const AngleBounds kBounds = angle_bounds(Preset::kBothSides, CoordinateType::kFloat64);

MeshRequest both_sides(int levels = kMaxLevels) {
  MeshRequest request;
  request.preset = Preset::kBothSides;
  request.levels = levels;
  return request;
}

std::vector<std::pair<std::string, Volume>> fields() {
  std::vector<std::pair<std::string, Volume>> all;
  all.emplace_back("ball", test::ball(11));
  all.emplace_back("gyroid", test::gyroid_ball(32));
  all.emplace_back("random signs", test::random_signs(14, 1));
  all.emplace_back("random signs and zeros", test::random_signs(14, 2, 3));
  all.emplace_back("flipped tiles", test::ball_with_flipped_tiles(27));
  all.emplace_back("fog", test::fog_ball(12.2));
  return all;
}

/// The tets of one region, as a mesh with all the vertices of the whole.
TetMesh part(const TetMesh& whole, MeshRegion region) {
  MeshHeader header = whole.header;
  header.has_regions = false;
  header.tet_count = 0;
  for (std::uint64_t t = 0; t < whole.header.tet_count; ++t) {
    header.tet_count += whole.region(t) == region;
  }
  TetMesh mesh(header);
  std::ranges::copy(whole.positions.bytes(), mesh.positions.bytes().begin());
  const std::size_t row = 4 * size_of(header.index_type);
  std::size_t next = 0;
  for (std::uint64_t t = 0; t < whole.header.tet_count; ++t) {
    if (whole.region(t) != region) continue;
    std::memcpy(mesh.tets.bytes().data() + next, whole.tets.bytes().data() + t * row, row);
    next += row;
  }
  return mesh;
}

/// Looks whether the mesh conforms and keeps the preset's bounds, and returns what it measured.
QualityStats expect_sound(const TetMesh& mesh) {
  const ConformityReport report = check_conformity(mesh);
  EXPECT_TRUE(report.conforming()) << report.describe();
  const QualityStats measured = measure_quality(mesh);
  EXPECT_GT(measured.min_dihedral_deg, kBounds.min_deg);
  EXPECT_LT(measured.max_dihedral_deg, kBounds.max_deg);
  return measured;
}

TEST(BothSides, ConformWithBoundedAnglesOnEveryField) {
  for (const auto& [name, volume] : test::few_of(fields(), 3)) {
    const bool harsh = name.starts_with("random") && !test::kSanitized;
    for (const int levels :
         harsh ? std::vector{0, 1, 2, kMaxLevels} : std::vector{0, kMaxLevels}) {
      SCOPED_TRACE(name + ", levels " + std::to_string(levels));
      const MeshResult result = mesh(volume, both_sides(levels));
      const QualityStats measured = expect_sound(result.mesh);
      EXPECT_NEAR(result.quality.min_dihedral_deg, measured.min_dihedral_deg, 1e-3);
      EXPECT_NEAR(result.quality.max_dihedral_deg, measured.max_dihedral_deg, 1e-3);
      EXPECT_NEAR(result.quality.volume, measured.volume, 1e-5 * measured.volume);
    }
  }
}

double volume_of(const WorldBox& box) {
  return (box.max.x - box.min.x) * (box.max.y - box.min.y) * (box.max.z - box.min.z);
}

TEST(BothSides, FillTheWholeBoxAndMeetOnTheSurface) {
  for (const Solid& solid : test::smooth_solids()) {
    for (const int levels : {1, kMaxLevels}) {
      SCOPED_TRACE(solid.name + ", levels " + std::to_string(levels));
      MeshRequest request = both_sides(levels);
      request.box = {{-48, -48, -48}, {48, 48, 48}};
      const MeshResult result = mesh(solid.volume, request);
      EXPECT_NEAR(result.quality.volume, volume_of(*request.box), 1e-3)
          << "the box is flat where the surface does not reach it";
      const TetMesh inside = part(result.mesh, MeshRegion::kInside);
      EXPECT_NEAR(measure_quality(inside).volume, solid.enclosed_volume,
                  0.01 * solid.enclosed_volume);
      const BoundaryTopology surface = measure_inside_boundary(result.mesh);
      EXPECT_EQ(surface, measure_boundary(inside));
      EXPECT_EQ(surface.components, solid.components);
      EXPECT_EQ(surface.euler_characteristic, solid.euler_characteristic);
      const BoundaryTopology box = measure_boundary(result.mesh);
      EXPECT_EQ(box.components, 1U);
      EXPECT_EQ(box.euler_characteristic, 2);
    }
  }
}

TEST(BothSides, LeaveNoVoidWhereManySamplesAreZero) {
  // Zero from plane to plane, and in a ball beyond them: tets of zeros and `-` alone.
  const Volume volume = test::dense_volume({{0, 0, 0}, {47, 31, 31}}, 1, [](VoxelCoord v) {
    if (v.x < 7) return -1.0F;
    const bool in_ball = std::hypot(v.x - 31, v.y - 15, v.z - 15) < 7;
    return v.x < 14 || in_ball ? 0.0F : 1.0F;
  });
  const MeshResult uniform = mesh(volume, both_sides(0)), graded = mesh(volume, both_sides());
  EXPECT_TRUE(check_conformity(graded.mesh).conforming());
  EXPECT_EQ(measure_boundary(graded.mesh).components, 1U) << "the box, and nothing within";
  EXPECT_NEAR(graded.quality.volume, uniform.quality.volume, 1e-6);
}

TEST(BothSides, CutTheSurfaceWhereTheBoxDoes) {
  const std::vector<WorldBox> boxes{{{-8, -24, -3}, {8, 0, 30}},
                                    {{-100, -100, -100}, {4.2, 3.1, 2.6}},
                                    {{-1000, -20, -20}, {3000, 20, 20}},
                                    {{-20, 6, 6}, {20, 6.5, 6.5}}};
  std::vector<Volume> volumes;
  volumes.push_back(test::gyroid_ball(32));
  volumes.push_back(test::random_signs(20, 9));
  for (const Volume& volume : volumes) {
    for (const WorldBox& box : test::few_of(boxes, 2)) {
      for (const int levels : {0, kMaxLevels}) {
        if (levels == 0 && volume_of(box) > 1e6) continue;
        SCOPED_TRACE(std::to_string(box.max.x) + ", levels " + std::to_string(levels));
        MeshRequest request = both_sides(levels);
        request.box = box;
        expect_sound(mesh(volume, request).mesh);
      }
    }
  }
}

TEST(BothSides, MeshABoxThatTheSurfaceDoesNotReachWithAnyNumberOfLevels) {
  // Numbers of bricks of which only the smallest leaves, or several sizes, fill a box.
  const std::vector<WorldBox> boxes{{{96, 96, 96}, {128, 128, 128}},
                                    {{96, -8, 40}, {104, 80, 136}},
                                    {{-8, -16, -8}, {8, 8, 16}}};
  const Volume ball = test::ball(60);
  for (const WorldBox& box : boxes) {
    const bool inside = box.min.x < 0;
    for (const int levels : {0, 1, 2, 3, kMaxLevels}) {
      SCOPED_TRACE(std::to_string(box.min.y) + ", levels " + std::to_string(levels));
      MeshRequest request = both_sides(levels);
      request.box = box;
      const MeshResult result = mesh(ball, request);
      EXPECT_NEAR(expect_sound(result.mesh).volume, volume_of(box), 1e-6 * volume_of(box));
      const MeshRegion side = inside ? MeshRegion::kInside : MeshRegion::kOutside;
      EXPECT_EQ(count_tets(result.mesh, side), result.mesh.header.tet_count);
    }
  }
}

TEST(BothSides, ConformWhereAllOfTheOutsideIsExactlyZero) {
  const VoxelCoord first{-24, -24, -24}, last{23, 23, 23};
  const Volume flat = test::dense_volume(VoxelBox{first, last}, 0, [](VoxelCoord v) {
    const double from_centre = std::hypot(v.x - 7.3, v.y + 6.1, v.z - 0.2);
    return static_cast<float>(std::min(0.0, from_centre - 9));
  });
  for (const int levels : test::few_of(std::vector{0, 1, kMaxLevels}, 2)) {
    SCOPED_TRACE(levels);
    MeshRequest request = both_sides(levels);
    request.box = {{-24, -24, -24}, {24, 24, 24}};
    const MeshResult result = mesh(flat, request);
    const ConformityReport report = check_conformity(result.mesh);
    EXPECT_TRUE(report.conforming()) << report.describe();
    EXPECT_NEAR(result.quality.volume, volume_of(*request.box), 1e-6)
        << "no half pyramid is missing";
  }
}

TEST(BothSides, AreTheSameForOneThreadAndForSixteen) {
  const Volume volume = test::random_signs(24, 6);
  const MeshResult one = mesh(volume, both_sides(), 1), many = mesh(volume, both_sides(), 16);
  EXPECT_TRUE(same_bytes(one.mesh, many.mesh));
}

TEST(BothSides, RefuseABoxThatIsNone) {
  const auto volume = std::make_shared<const Volume>(test::ball(9));
  const auto refusal = [&](const MeshRequest& request) {
    return plan_mesh({.shape = volume, .request = request}).status();
  };
  MeshRequest request = both_sides();
  request.box = {{0, 0, 0}, {1, -1, 1}};
  EXPECT_EQ(refusal(request).code(), absl::StatusCode::kInvalidArgument);
  request.box = {{0, 0, 0}, {1, 1, 1e12}};
  EXPECT_EQ(refusal(request).code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace tet::both_sides_test
