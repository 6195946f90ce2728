// Indicators: labels and cut points from voxels, the same in every brick that sees them.
#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "core/labels/kernel_taps.h"
#include "core/labels/lattice_faces.h"
#include "core/mesh/quality.h"
#include "core/plan/mesh_request.h"
#include "tests/core/labels/label_meshing.h"
#include "tests/support/conformity.h"
#include "tests/support/counted_looks.h"
#include "tests/support/voxel_arrays.h"

namespace tet {
namespace {

using test::VoxelArray;

constexpr std::array kKernels{LabelKernel::kTrilinear, LabelKernel::kQuadratic,
                              LabelKernel::kGauss};

/// What a kernel's weights are at nodes of both kinds: as many as docs/labels.md says.
TEST(Kernels, SumToOneAndReachAsFarAsTheySay) {
  const std::map<LabelKernel, std::pair<std::size_t, std::size_t>> taps{
      {LabelKernel::kTrilinear, {1, 2}},
      {LabelKernel::kQuadratic, {3, 2}},
      {LabelKernel::kGauss, {5, 4}}};
  for (const LabelKernel kernel : kKernels) {
    for (const double half : {0.0, 0.5}) {
      TapRow row;
      find_taps({.kernel = kernel}, 1, 16 + half, row);
      for (int i = 0; i < TapRow::kNodes; ++i) {
        const auto weights = row.weights_of(i);
        EXPECT_EQ(weights.size(), half == 0 ? taps.at(kernel).first : taps.at(kernel).second);
        float sum = 0;
        for (const float weight : weights) sum += weight;
        EXPECT_NEAR(sum, 1, 1e-6);
      }
    }
  }
}

TEST(Kernels, GrowWithALatticeCoarserThanTheVoxels) {
  TapRow row;
  find_taps({.kernel = LabelKernel::kTrilinear}, 3, 0, row);
  EXPECT_EQ(row.weights_of(0).size(), 5U);  // from 2 voxels below to 2 above
}

/// The Gaussian's width at a node, from two of its weights.
double width_at(double smooth, double spacing) {
  TapRow row;
  find_taps({.smooth = smooth}, spacing, 0, row);
  const Taps& taps = row.node[0];
  const auto weights = row.weights_of(0);
  const auto middle = static_cast<std::size_t>(-taps.first);
  return std::sqrt(-0.5 / std::log(double{weights[middle + 1]} / weights[middle]));
}

TEST(Kernels, GaussiansGrowByHalfASpacingAsVariancesAdd) {
  for (const double smooth : {0.5, 0.7, 2.0}) {
    for (const double fine : {0.25, 1.0}) EXPECT_NEAR(width_at(smooth, fine), smooth, 1e-5);
    EXPECT_NEAR(width_at(smooth, 2), std::hypot(smooth, std::sqrt(0.75)), 1e-5);
    EXPECT_NEAR(width_at(smooth, 20) / std::hypot(smooth, 10.0), 1, 2e-3);
  }
}

std::shared_ptr<const LabelSource> source(std::shared_ptr<const LabelVoxels> voxels,
                                          IndicatorRules rules = {}) {
  return std::make_shared<const IndicatorLabels>(std::move(voxels), rules);
}

/// Eight octants with a label each, or as many labels as there are voxels.
Label octant(VoxelCoord v) {
  return static_cast<Label>(1 + (v.x >= 8) * 4 + (v.y >= 8) * 2 + (v.z >= 8));
}
Label anything(VoxelCoord v) {
  return static_cast<Label>(1 + (v.x * 7919 + v.y * 104729 + v.z * 1299709) % 997);
}

/// All faces of a brick and its halo with three labels, those of their edges' fractions.
std::vector<TripleFace> faces_of_three(const LabelSamples& samples) {
  constexpr HaloSet kSeen = halo_cube(-1, 8);
  std::vector<TripleFace> faces;
  for (std::size_t f = 0; f < kFaceFamilies; ++f) {
    const FaceFamily& family = kFaceFamily[f];
    for_each_bit(kSeen, [&](int low) {
      std::array<Label, 3> label;
      for (std::size_t n = 0; n < 3; ++n) {
        if (!kSeen.test(low + family.to_node[n])) return;
        label[n] =
            samples.label[family.kind[n]][static_cast<std::size_t>(low + family.to_node[n])];
      }
      if (label[0] == label[1] || label[1] == label[2] || label[0] == label[2]) return;
      faces.push_back({static_cast<std::uint8_t>(f), static_cast<std::uint16_t>(low)});
    });
  }
  return faces;
}

/// The bits of a place on a face, which may be nowhere.
std::uint64_t bits_of(const FacePoint& point) {
  return std::uint64_t{std::bit_cast<std::uint32_t>(point.second)} << 32 |
         std::bit_cast<std::uint32_t>(point.third);
}

/// Checks that all bricks of a box see the same labels, fractions and faces; returns how many
/// nodes were seen again.
std::size_t check_what_bricks_see(const IndicatorRules& rules, const BrickBox& box) {
  // A quarter has a few labels, the rest too many to convolve: the sums must be the same bits.
  const auto voxels = std::make_shared<const VoxelArray>(
      16, Label{0}, [](VoxelCoord v) { return v.x < 6 && v.y < 12 ? octant(v) : anything(v); });
  const auto sampler = source(voxels, rules)->sampler();
  std::map<std::tuple<int, int, int, int>, Label> label_of;
  std::map<std::tuple<int, int, int, int>, float> fraction_of;
  std::map<std::tuple<int, int, int, int>, std::uint64_t> point_of;
  const auto samples = std::make_unique<LabelSamples>();
  EdgeSets changes;
  std::size_t again = 0, faces_again = 0;
  for_each_brick(box, [&](BrickCoord brick) {
    if (sampler->one_label(brick)) return;
    sampler->sample_labels(brick, *samples);
    find_label_changes(samples->label, changes);
    sampler->sample_fractions(brick, changes, *samples);
    const auto at = [&](int halo, int more) {
      return std::tuple(8 * brick.x + (halo >> 8), 8 * brick.y + (halo >> 4 & 15),
                        8 * brick.z + (halo & 15), more);
    };
    for (int kind = 0; kind < kNodeKinds; ++kind) {
      for_each_bit(halo_cube(-2, 9), [&](int node) {
        const Label label =
            samples->label[static_cast<std::size_t>(kind)][static_cast<std::size_t>(node)];
        const auto [known, is_new] = label_of.try_emplace(at(node, kind), label);
        again += is_new ? 0 : 1;
        EXPECT_EQ(known->second, label);
      });
    }
    for (std::size_t f = 0; f < kEdgeFamilies; ++f) {
      for_each_bit(changes[f], [&](int low) {
        const float fraction = samples->fraction[f][static_cast<std::size_t>(low)];
        EXPECT_GE(fraction, 0);
        EXPECT_LE(fraction, 1);
        EXPECT_EQ(fraction_of.try_emplace(at(low, static_cast<int>(f)), fraction).first->second,
                  fraction);
      });
    }
    const std::vector<TripleFace> faces = faces_of_three(*samples);
    std::vector<FacePoint> points(faces.size());
    sampler->sample_triples(brick, faces, *samples, points);
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const auto [known, is_new] =
          point_of.try_emplace(at(faces[i].low, faces[i].family), bits_of(points[i]));
      faces_again += is_new ? 0 : 1;
      EXPECT_EQ(known->second, bits_of(points[i]));
    }
  });
  EXPECT_GT(faces_again, 10U);
  return again;
}

TEST(Indicators, AreTheSameWhicheverBrickSeesThem) {
  EXPECT_GT(check_what_bricks_see({}, {{-1, -1, -1}, {1, 1, 1}}), 10'000U);
}

TEST(Indicators, AreTheSameForEveryKernelAndSpacing) {
  // The lower brick has few labels, the upper one too many.
  constexpr BrickBox kTwo{{-1, 0, 0}, {0, 0, 0}};
  for (const IndicatorRules& rules : {IndicatorRules{.kernel = LabelKernel::kTrilinear},
                                      {.kernel = LabelKernel::kQuadratic},
                                      {.smooth = 1},
                                      {.spacing_voxels = {0.7, 1, 1}},
                                      {.spacing_voxels = {1, 1.3, 1}},
                                      {.spacing_voxels = {1, 1, 0.6}},
                                      {.spacing_voxels = {1, 1, 2}}}) {
    SCOPED_TRACE(testing::Message()
                 << "kernel " << static_cast<int>(rules.kernel) << ", smooth " << rules.smooth
                 << ", spacing " << rules.spacing_voxels[0] << " " << rules.spacing_voxels[1]
                 << " " << rules.spacing_voxels[2]);
    EXPECT_EQ(check_what_bricks_see(rules, kTwo), 2U * 4 * 12 * 12);
  }
}

TEST(Indicators, GiveANodeTheLabelOfItsVoxelsAndOfEqualOnesTheLower) {
  const auto voxels = std::make_shared<const VoxelArray>(16, Label{0}, octant);
  for (const LabelKernel kernel : kKernels) {
    const auto sampler = source(voxels, {.kernel = kernel})->sampler();
    ASSERT_FALSE(sampler->one_label({0, 0, 0}));
    const auto samples = std::make_unique<LabelSamples>();
    sampler->sample_labels({0, 0, 0}, *samples);
    const auto label = [&](NodeKind kind, int x, int y, int z) {
      return samples->label[kind][static_cast<std::size_t>(halo_index(x, y, z))];
    };
    EXPECT_EQ(label(kCorner, 4, 4, 4), 1);
    EXPECT_EQ(label(kCorner, 8, 4, 4), 5);
    EXPECT_EQ(label(kCorner, 8, 8, 8), 8);
    // Centre 7 lies just between voxels 7 and 8.
    EXPECT_EQ(label(kCentre, 7, 4, 4), 1);
    EXPECT_EQ(label(kCentre, 7, 7, 7), 1);
    EXPECT_EQ(label(kCorner, -2, 4, 4), 0);
  }
}

/// How often a sampler looks at whether it is cancelled while it samples a brick.
std::size_t looks_in_a_brick(const std::function<Label(VoxelCoord)>& label,
                             const IndicatorRules& rules) {
  const auto voxels = std::make_shared<const VoxelArray>(64, Label{0}, label);
  test::CountedLooks counted;
  const auto sampler = source(voxels, rules)->sampler();
  sampler->stop_when(counted.cancellation);
  EXPECT_FALSE(sampler->one_label({0, 0, 0}));
  const auto samples = std::make_unique<LabelSamples>();
  sampler->sample_labels({0, 0, 0}, *samples);
  return counted.looks;
}

TEST(Indicators, LookAtTheirCancellationWithinABrick) {
  // It looks between two labels where they are few, else between two rows of nodes.
  const IndicatorRules coarse{.spacing_voxels = {3, 3, 3}};
  EXPECT_GE(looks_in_a_brick(octant, coarse), 2U * 8);
  EXPECT_GE(looks_in_a_brick(anything, coarse), 2U * 12 * 12);
}

TEST(Indicators, StopWithinABrickWhenTheyAreCancelled) {
  const auto voxels = std::make_shared<const VoxelArray>(16, Label{0}, anything);
  for (const std::size_t most : {0U, 1U, 100U, 300U, 400U}) {
    test::CountedLooks counted{.most = most};
    const auto sampler = source(voxels)->sampler();
    sampler->stop_when(counted.cancellation);
    ASSERT_FALSE(sampler->one_label({0, 0, 0}));
    const auto samples = std::make_unique<LabelSamples>();
    EdgeSets changes;
    sampler->sample_labels({0, 0, 0}, *samples);
    // What it leaves is made up, but it is of labels that there are.
    find_label_changes(samples->label, changes);
    sampler->sample_fractions({0, 0, 0}, changes, *samples);
    EXPECT_LE(counted.looks, most + 1);
  }
}

TEST(Indicators, TakeNoLongerForMoreLabels) {
  // Nodes see 14,000 voxels each, and thousands of labels: one after the other took minutes.
  const auto voxels = std::make_shared<const VoxelArray>(40, Label{0}, [](VoxelCoord v) {
    return static_cast<Label>(1600 * v.x + 40 * v.y + v.z);
  });
  const auto sampler = source(voxels, {.smooth = kMostSmooth})->sampler();
  ASSERT_FALSE(sampler->one_label({2, 2, 2}));
  const auto samples = std::make_unique<LabelSamples>();
  sampler->sample_labels({2, 2, 2}, *samples);
  for (const int at : {-2, 3, 9}) {
    EXPECT_EQ(samples->label[kCorner][static_cast<std::size_t>(halo_index(at, at, at))],
              (1600 + 40 + 1) * (16 + at));
  }
}

TEST(Indicators, TellBricksOfOneLabel) {
  const auto voxels = std::make_shared<const VoxelArray>(
      64, Label{0}, [](VoxelCoord v) { return static_cast<Label>(v.x < 32 ? 1 : 2); });
  const auto sampler = source(voxels)->sampler();
  EXPECT_EQ(sampler->one_label({1, 4, 4}), Label{1});
  EXPECT_EQ(sampler->one_label({6, 4, 4}), Label{2});
  EXPECT_EQ(sampler->one_label({3, 4, 4}), std::nullopt);
  EXPECT_EQ(sampler->one_label({12, 4, 4}), Label{0});
}

/// A nest of three balls, cut in two by a plane: five labels, of which up to four meet.
Label nest(VoxelCoord v) {
  const double x = v.x - 19.3, y = v.y - 20.1, z = v.z - 19.7;
  const double r = std::sqrt(x * x + y * y + z * z);
  if (r > 16) return 0;
  if (r > 12) return 1;
  if (r > 8) return static_cast<Label>(x + 0.4 * y < 0.3 ? 2 : 3);
  return 4;
}

TEST(Indicators, MakeSoundMeshesWithTheVolumesOfTheirLabels) {
  const auto voxels = std::make_shared<const VoxelArray>(40, Label{0}, nest);
  std::map<Label, double> count;
  for (std::int32_t i = 0; i < 40 * 40 * 40; ++i) {
    ++count[voxels->at({i / 1600, i / 40 % 40, i % 40})];
  }
  test::LabelMeshing how{.domain = {{-1, -1, -1}, {5, 5, 5}}, .levels = kMaxLevels};
  how.kept.left_out = 0;
  how.labels = 5;
  for (const LabelKernel kernel : kKernels) {
    const FilledMesh filled = test::mesh_of(source(voxels, {.kernel = kernel}), how);
    const ConformityReport report = check_conformity(filled.mesh);
    EXPECT_TRUE(report.conforming()) << report.describe();
    const AngleBounds bounds = angle_bounds(Preset::kBothSides, CoordinateType::kFloat64);
    EXPECT_GT(filled.quality.min_dihedral_deg, bounds.min_deg);
    EXPECT_LT(filled.quality.max_dihedral_deg, bounds.max_deg);
    const auto parts = test::parts_of(filled.mesh);
    EXPECT_EQ(parts.size(), 4U);
    for (const auto& [label, part] : parts) {
      EXPECT_NEAR(part.volume, count.at(label), 0.05 * count.at(label)) << label;
    }
  }
}

TEST(Kernels, TooNarrowToReachAVoxelTakeTheNearest) {
  for (const double smooth : {1e-300, 0.01, kLeastSmooth}) {
    TapRow row;
    find_taps({.smooth = smooth}, 1, 0.5, row);  // amid two
    ASSERT_EQ(row.weights_of(0).size(), 2U);
    EXPECT_EQ(row.weights_of(0)[0], 0.5F);
    find_taps({.smooth = smooth}, 1, 0, row);
    EXPECT_EQ(row.weights_of(0)[static_cast<std::size_t>(-row.node[0].first)], 1.0F);
  }
}

/// What is lost is what a kernel as wide as the lattice's cells cannot do without: a wider one
/// draws in what bulges, and a narrower one leaves steps between nodes.
TEST(Indicators, LieWhereTheyBelongOnALatticeCoarserThanTheVoxels) {
  constexpr std::int32_t kEdge = 64;
  constexpr double kMiddle = 31.5, kRadius = 28;
  const auto voxels =
      std::make_shared<const VoxelArray>(kEdge, Label{0}, [](VoxelCoord v) -> Label {
        return std::hypot(v.x - kMiddle, v.y - kMiddle, v.z - kMiddle) < kRadius ? 1 : 0;
      });
  for (const double spacing : {2.0, 4.0}) {
    test::LabelMeshing how{.domain = {{-1, -1, -1}, {5, 5, 5}}};
    how.kept.left_out = 0;
    const FilledMesh filled =
        test::mesh_of(source(voxels, {.spacing_voxels = {spacing, spacing, spacing}}), how);
    const double volume = 4.0 / 3 * std::numbers::pi * kRadius * kRadius * kRadius;
    const double wanted = volume / (spacing * spacing * spacing);
    EXPECT_NEAR(test::parts_of(filled.mesh).at(1).volume / wanted, 1, 0.02) << spacing;
  }
}

TEST(Indicators, KeepASheetOneVoxelThinByTheQuadraticKernel) {
  const auto voxels = std::make_shared<const VoxelArray>(24, Label{0}, [](VoxelCoord v) {
    const std::int32_t side = 2 * v.x + v.y;
    return static_cast<Label>(side < 30 ? 1 : side < 33 ? 2 : 3);
  });
  test::LabelMeshing how{.domain = {{-1, -1, -1}, {3, 3, 3}}};
  how.kept.left_out = 0;
  double voxel_count = 0;
  for (std::int32_t i = 0; i < 24 * 24 * 24; ++i) {
    voxel_count += voxels->at({i / 576, i / 24 % 24, i % 24}) == 2 ? 1 : 0;
  }
  const auto parts = test::parts_of(
      test::mesh_of(source(voxels, {.kernel = LabelKernel::kQuadratic}), how).mesh);
  EXPECT_GT(parts.at(2).volume, 0.8 * voxel_count);
}

}  // namespace
}  // namespace tet
