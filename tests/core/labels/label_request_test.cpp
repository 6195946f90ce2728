// A segmentation's labels chosen, merged, numbered and named; and meshed on voxels of any
// shape.
#include "core/plan/labelled/label_request.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <absl/strings/str_cat.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/mesh/face_search.h"
#include "core/mesh/quality.h"
#include "core/plan/labelled/label_numbers.h"
#include "core/plan/make/mesher.h"
#include "core/volume/check_transform.h"
#include "core/volume/label_volume.h"
#include "tests/core/labels/label_meshing.h"
#include "tests/support/conformity.h"

namespace tet {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Shape shape_of(const LabelImage& image) {
  auto volume = make_label_volume(image);
  EXPECT_TRUE(volume.ok()) << volume.status();
  return std::make_shared<const LabelVolume>(*std::move(volume));
}

/// Columns of four voxels along x: 0, 7, 11175, -3 and 7, in a box that ends at odd places.
Shape columns_of_voxels(const VoxelTransform& transform = {}) {
  const std::vector<std::int64_t> columns{0, 7, 11175, -3, 7};
  std::vector<std::int64_t> values;
  for (std::size_t i = 0; i < 19 * 11 * 13; ++i) values.push_back(columns[i % 19 / 4]);
  return shape_of({.name = "columns",
                   .transform = transform,
                   .size = {19, 11, 13},
                   .min = {-5, 2, 30},
                   .values = values});
}

/// Labels at random in blobs of two voxels, as hostile as a segmentation gets.
Shape random_voxels(unsigned seed, int labels, const VoxelTransform& transform = {}) {
  std::mt19937 random(seed);
  constexpr int kEdge = 13;
  std::vector<std::int64_t> blobs(7 * 7 * 7);
  for (auto& blob : blobs)
    blob = static_cast<std::int64_t>(random() % static_cast<unsigned>(labels));
  std::vector<std::int64_t> values;
  for (int z = 0; z < kEdge; ++z) {
    for (int y = 0; y < kEdge; ++y) {
      for (int x = 0; x < kEdge; ++x) {
        values.push_back(blobs[static_cast<std::size_t>((z / 2 * 7 + y / 2) * 7 + x / 2)]);
      }
    }
  }
  return shape_of({.name = "random",
                   .transform = transform,
                   .size = {kEdge, kEdge, kEdge},
                   .min = {3, -9, 0},
                   .values = values});
}

VoxelTransform transform_of(const std::array<std::array<double, 3>, 3>& linear, double size) {
  return {.linear = linear, .translation = {10, -20, 30}, .voxel_size = size};
}

/// Turned about z, with edges of 0.5, 0.5 and 1.5; and the same, left-handed; and sheared.
const VoxelTransform kTurned =
    transform_of({{{0.4, -0.3, 0}, {0.3, 0.4, 0}, {0, 0, 1.5}}}, 0.5);
const VoxelTransform kLeftHanded =
    transform_of({{{-0.4, -0.3, 0}, {-0.3, 0.4, 0}, {0, 0, 1.5}}}, 0.5);
const VoxelTransform kSheared =
    transform_of({{{0.5, 0.2, 0}, {0, 0.5, 0.1}, {0, 0, 0.7}}}, 0.5);

double voxel_volume(const VoxelTransform& t) {
  const auto& [a, b, c] = t.linear;
  return std::abs(a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
                  a[2] * (b[0] * c[1] - b[1] * c[0]));
}

MeshRequest request_for(LabelChoice choice) {
  MeshRequest request;
  request.levels = 1;
  request.labels = std::move(choice);
  return request;
}

absl::StatusOr<MeshResult> mesh_labels(const Shape& shape,
                                       const MeshRequest& request,
                                       int threads = 2) {
  TaskPool pool(threads);
  return mesh_volume(pool, {.shape = shape, .request = request});
}

/// By the labels' values, those that have tets; a failed test where there is no sound mesh.
std::map<std::int64_t, test::LabelPart> parts_of_request(const Shape& shape,
                                                         const MeshRequest& request) {
  std::map<std::int64_t, test::LabelPart> parts;
  const auto made = mesh_labels(shape, request);
  EXPECT_TRUE(made.ok()) << made.status();
  if (!made.ok()) return parts;
  const ConformityReport report = check_conformity(made->mesh);
  EXPECT_TRUE(report.conforming()) << report.describe();
  const AngleBounds bounds = angle_bounds(Preset::kBothSides, CoordinateType::kFloat32);
  EXPECT_GT(made->quality.min_dihedral_deg, bounds.min_deg);
  EXPECT_LT(made->quality.max_dihedral_deg, bounds.max_deg);
  for (const auto& [number, part] : test::parts_of(made->mesh)) {
    parts[made->mesh.header.labels[number].value] = part;
  }
  return parts;
}

std::map<std::int64_t, test::LabelPart> parts_of_choice(const Shape& shape,
                                                        const LabelChoice& choice) {
  return parts_of_request(shape, request_for(choice));
}

std::string refusal_of(const Shape& shape, const MeshRequest& request) {
  const auto made = mesh_labels(shape, request);
  EXPECT_EQ(made.status().code(), absl::StatusCode::kInvalidArgument) << made.status();
  return std::string(made.status().message());
}

TEST(LabelRanges, AreNumbersAndRangesOrAll) {
  const auto ranges = parse_label_ranges("1,4,7:12,-3");
  ASSERT_TRUE(ranges.ok());
  EXPECT_THAT(*ranges, ElementsAre(LabelRange{1, 1}, LabelRange{4, 4}, LabelRange{7, 12},
                                   LabelRange{-3, -3}));
  EXPECT_THAT(*parse_label_ranges("all"), ElementsAre());
}

TEST(LabelRanges, ThatAreNoneAreRefusedWithWhatIsExpected) {
  for (const char* text : {"", "a", "1,", "3:1", "1:2:3", "99999999999999999999"}) {
    const auto ranges = parse_label_ranges(text);
    EXPECT_EQ(ranges.status().code(), absl::StatusCode::kInvalidArgument) << text;
    EXPECT_THAT(std::string(ranges.status().message()), HasSubstr("1,4,7:12"));
  }
}

TEST(LabelRequest, MeshesEveryLabelButTheBackgroundWithItsVolume) {
  const auto parts = parts_of_choice(columns_of_voxels(), {});
  ASSERT_EQ(parts.size(), 3U);
  // A voxel's corners at the image's end are rounded off.
  EXPECT_NEAR(parts.at(11175).volume, 4 * 11 * 13, 0.06 * 4 * 11 * 13);
  EXPECT_NEAR(parts.at(7).volume, 7 * 11 * 13, 0.08 * 7 * 11 * 13);
}

TEST(LabelRequest, MeshesVoxelsOfAnyShapeWithTheirVolumes) {
  for (const VoxelTransform& transform : {kTurned, kLeftHanded, kSheared}) {
    const double voxel = voxel_volume(transform);
    const auto parts = parts_of_choice(columns_of_voxels(transform), {});
    ASSERT_EQ(parts.size(), 3U);
    EXPECT_NEAR(parts.at(11175).volume, voxel * 4 * 11 * 13, voxel * 0.08 * 4 * 11 * 13);
    EXPECT_NEAR(parts.at(-3).volume, voxel * 4 * 11 * 13, voxel * 0.08 * 4 * 11 * 13);
  }
}

TEST(LabelRequest, LaysLabelsWhereTheirVoxelsAre) {
  for (const VoxelTransform& transform : {VoxelTransform{}, kTurned, kLeftHanded, kSheared}) {
    const Shape shape = columns_of_voxels(transform);
    const auto made = mesh_labels(shape, request_for({.only = {{11175, 11175}}}));
    ASSERT_TRUE(made.ok()) << made.status();
    WorldPoint sum;
    const double count = static_cast<double>(made->mesh.header.vertex_count);
    for (std::uint64_t i = 0; i < made->mesh.header.vertex_count; ++i) {
      const WorldPoint p = made->mesh.vertex(i);
      sum = {sum.x + p.x / count, sum.y + p.y / count, sum.z + p.z / count};
    }
    // Columns 8 to 11 of x, from -5 on; 2 to 12 of y; 30 to 42 of z.
    const WorldPoint middle = transform.to_world({4.5, 7, 36});
    EXPECT_NEAR(sum.x, middle.x, 0.35);
    EXPECT_NEAR(sum.y, middle.y, 0.35);
    EXPECT_NEAR(sum.z, middle.z, 0.35);
  }
}

// However far from voxel 0 that is, nodes lie where their labels are taken from.
TEST(LabelRequest, LaysFarLabelsWhereTheirVoxelsAre) {
  constexpr std::int32_t kFar = 1'000'000;
  const Shape shape = shape_of({.name = "far",
                                .transform = {},
                                .size = {16, 16, 16},
                                .min = {kFar, kFar, kFar},
                                .values = std::vector<std::int64_t>(16 * 16 * 16, 1)});
  for (const double spacing : {1.0, 1.0000009, 1.00009, 1.3}) {
    MeshRequest request = request_for({});
    request.spacing = spacing;
    const auto made = mesh_labels(shape, request);
    ASSERT_TRUE(made.ok()) << made.status();
    for (std::uint64_t i = 0; i < made->mesh.header.vertex_count; ++i) {
      const WorldPoint p = made->mesh.vertex(i);
      ASSERT_TRUE(std::abs(p.x - kFar - 7.5) < 10 && std::abs(p.z - kFar - 7.5) < 10)
          << p.x << ", " << p.z << " at spacing " << spacing;
    }
  }
}

TEST(LabelRequest, MeshesTheBackgroundUpToTheBox) {
  const auto request = request_for({.mesh_background = true});
  const auto parts = parts_of_request(columns_of_voxels(), request);
  EXPECT_EQ(parts.size(), 4U);
  double volume = 0;
  for (const auto& [value, part] : parts) volume += part.volume;
  const auto job = make_label_job({.shape = columns_of_voxels(), .request = request});
  ASSERT_TRUE(job.ok()) << job.status();
  EXPECT_NEAR(volume, bricks_in(job->domain) * kBrickCells, 1e-2);
}

TEST(LabelRequest, LeavesOutWhatIsNotNamedAndMergesWhatIs) {
  const auto some = parts_of_choice(columns_of_voxels(), {.only = {{7, 7}}});
  ASSERT_EQ(some.size(), 1U);
  EXPECT_TRUE(some.contains(7));
  const auto merged = parts_of_choice(columns_of_voxels(), {.merges = {{{7, 7}, {-3, -3}}}});
  ASSERT_EQ(merged.size(), 2U);
  EXPECT_FALSE(merged.contains(-3));
}

TEST(LabelRequest, TakesAnyLabelForTheBackground) {
  const auto parts = parts_of_choice(columns_of_voxels(), {.background = 7});
  EXPECT_EQ(parts.size(), 3U);
  EXPECT_TRUE(parts.contains(0));
  EXPECT_FALSE(parts.contains(7));
}

TEST(LabelRequest, NamesTheLabelsOfTheHeader) {
  const auto job =
      make_label_job({.shape = columns_of_voxels(),
                      .request = request_for({.names = {{7, "bone"}, {8, "none"}}})});
  ASSERT_TRUE(job.ok()) << job.status();
  EXPECT_THAT(job->labels,
              ElementsAre(MeshLabel{-3, ""}, MeshLabel{7, "bone"}, MeshLabel{11175, ""}));
  EXPECT_EQ(job->kept.left_out, 3);
}

TEST(LabelNumbers, TellTheVolumesOfTheirVoxels) {
  const Shape shape = columns_of_voxels(kTurned);
  const auto numbers =
      number_labels({labels_of(shape)->labels}, {.merges = {{{7, 7}, {-3, -3}}}});
  ASSERT_TRUE(numbers.ok()) << numbers.status();
  const double voxel = voxel_volume(kTurned);
  const std::vector<double> volumes = voxel_volumes_of(*labels_of(shape), *numbers);
  ASSERT_EQ(volumes.size(), 2U);
  EXPECT_NEAR(volumes[0], 11 * 11 * 13 * voxel, 1e-9);
  EXPECT_NEAR(volumes[1], 4 * 11 * 13 * voxel, 1e-9);
}

TEST(LabelRequest, EndsAtABox) {
  MeshRequest request = request_for({.mesh_background = true});
  request.box = WorldBox{{-3, 4, 33}, {4, 11, 40}};
  const auto made = mesh_labels(columns_of_voxels(), request);
  ASSERT_TRUE(made.ok()) << made.status();
  ASSERT_TRUE(made->mesh.header.box);
  const auto [min, max] = *made->mesh.header.box;
  EXPECT_NEAR(made->quality.volume, (max.x - min.x) * (max.y - min.y) * (max.z - min.z), 20);
  EXPECT_LE(min.x, -3);
  EXPECT_GE(max.z, 40);
}

TEST(LabelRequest, IsRefusedWithWhatThereIs) {
  const Shape shape = columns_of_voxels();
  EXPECT_THAT(refusal_of(shape, request_for({.only = {{5, 6}}})), HasSubstr("-3, 0, 7, 11175"));
  EXPECT_THAT(refusal_of(shape, request_for({.only = {{0, 0}}})), HasSubstr("background"));
  EXPECT_THAT(refusal_of(shape, request_for({.merges = {{{7, 7}, {8, 9}}}})), HasSubstr("8:9"));
  EXPECT_THAT(refusal_of(shape, request_for({.merges = {{{7, 7}}, {{0, 9}}}})),
              HasSubstr("twice"));
  EXPECT_THAT(refusal_of(shape, request_for({.smooth = 9})), HasSubstr("smooth"));
  MeshRequest request = request_for({});
  request.spacing = 40;
  EXPECT_THAT(refusal_of(shape, request), HasSubstr("40 voxels"));
  request.spacing = -1;
  EXPECT_THAT(refusal_of(shape, request), HasSubstr("spacing"));
  request = request_for({});
  request.labels->mesh_background = true;
  request.spacing = 10;
  request.box = WorldBox{{2e9, 0, 0}, {2e9 + 10, 10, 10}};
  EXPECT_THAT(refusal_of(shape, request), HasSubstr("nearer box"));
  request = request_for({});
  request.box = WorldBox{{1000, 0, 0}, {1010, 10, 10}};
  EXPECT_THAT(refusal_of(shape, request), HasSubstr("nothing of the image"));
  EXPECT_THAT(refusal_of(shape, MeshRequest{}), HasSubstr("labels must be set"));
}

TEST(LabelRequest, LooksUpVoxelsThatAreShearedNearlyFlat) {
  const VoxelTransform flat =
      transform_of({{{1, 0.99, 0}, {0, 0.02, 0.99}, {0, 0, 0.2}}}, 0.99);
  VoxelTransform exact = flat;
  exact.voxel_size = voxel_edge(flat);
  // Cubes of a whole edge may miss sheets of a hundredth.
  const auto made = mesh_labels(columns_of_voxels(exact), request_for({}));
  EXPECT_TRUE(made.ok() || absl::IsFailedPrecondition(made.status())) << made.status();
}

TEST(LabelRequest, IsRefusedBeforeMemoryIsTakenForIt) {
  MeshRequest request = request_for({});
  request.levels = kMaxLevels;
  request.spacing = 1e-4;
  EXPECT_EQ(mesh_labels(columns_of_voxels(), request).status().code(),
            absl::StatusCode::kResourceExhausted);
  request.spacing = 1e-300;
  EXPECT_EQ(mesh_labels(columns_of_voxels(), request).status().code(),
            absl::StatusCode::kInvalidArgument);
}

/// Between labels that meet everywhere there are more faces than tets, and what may be one is
/// kept until it is known.
TEST(LabelRequest, IsRefusedWhereTheSearchForItsFacesTakesMoreMemoryThanThereIs) {
  const Shape shape = random_voxels(3, 40);
  MeshRequest request = request_for({.mesh_background = true});
  request.levels = 0;
  request.spacing = 0.5;
  const auto plain = mesh_labels(shape, request);
  ASSERT_TRUE(plain.ok()) << plain.status();
  request.faces = true;
  const MeshHeader& header = plain->mesh.header;
  const std::uint64_t mesh_bytes = ChunkSizes(header, whole_of(header)).total();
  TaskPool pool(2);
  const auto with_limit = [&](std::uint64_t bytes) {
    return mesh_volume(
               pool, {.shape = shape, .request = request, .limits = {.max_plan_bytes = bytes}})
        .status();
  };
  const absl::Status refused =
      with_limit(mesh_bytes + FaceSearch::bytes_of(header.vertex_count, 0));
  EXPECT_EQ(refused.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(refused.message()), HasSubstr("finding the faces between labels"));
  EXPECT_TRUE(
      with_limit(mesh_bytes + FaceSearch::bytes_of(header.vertex_count, 4 * header.tet_count))
          .ok());
}

/// Each transform with each kernel and with each number of labels, and each kernel with each of
/// these: none of the three looks at both others.
TEST(LabelRequest, MeshesRandomImagesSoundlyWhateverIsAsked) {
  const std::array transforms{VoxelTransform{}, kTurned, kSheared};
  const std::array kernels{LabelKernel::kTrilinear, LabelKernel::kQuadratic,
                           LabelKernel::kGauss};
  constexpr std::array kLabels{2, 5, 40};
  unsigned seed = 1;
  for (std::size_t t = 0; t < transforms.size(); ++t) {
    for (std::size_t k = 0; k < kernels.size(); ++k) {
      const int labels = kLabels[(t + k) % kLabels.size()];
      SCOPED_TRACE(absl::StrCat("seed ", seed, ", ", labels, " labels"));
      const Shape shape = random_voxels(seed++, labels, transforms[t]);
      MeshRequest all = request_for({.mesh_background = true, .kernel = kernels[k]});
      all.coordinates = CoordinateType::kFloat64;
      const auto with = parts_of_request(shape, all);
      MeshRequest some = all;
      some.labels->mesh_background = false;
      auto without = parts_of_request(shape, some);
      // What is left out is missing, and nothing else is different.
      ASSERT_EQ(without.size() + 1, with.size());
      for (const auto& [value, part] : without) {
        EXPECT_EQ(part.tets, with.at(value).tets) << value;
        EXPECT_NEAR(part.volume, with.at(value).volume, 1e-6) << value;
      }
    }
  }
}

TEST(LabelRequest, GivesTheSameBytesForAnyThreads) {
  const Shape shape = random_voxels(77, 12, kTurned);
  const auto one = mesh_labels(shape, request_for({}), 1);
  const auto three = mesh_labels(shape, request_for({}), 3);
  ASSERT_TRUE(one.ok() && three.ok());
  const ConstColumns a = one->mesh.columns(), b = three->mesh.columns();
  EXPECT_TRUE(std::ranges::equal(a.positions, b.positions));
  EXPECT_TRUE(std::ranges::equal(a.tets, b.tets));
  EXPECT_TRUE(std::ranges::equal(a.regions, b.regions));
}

}  // namespace
}  // namespace tet
