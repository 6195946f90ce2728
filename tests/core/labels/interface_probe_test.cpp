// Where labels meet between the nodes: of voxels, level sets and scenes.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/base/cancel.h"
#include "core/labels/field_labels.h"
#include "core/labels/indicators.h"
#include "core/scene/scene.h"
#include "tests/support/scenes.h"
#include "tests/support/volume_fixtures.h"
#include "tests/support/voxel_arrays.h"

namespace tet::interface_probe_test {
namespace {

using test::VoxelArray;

using Functions = std::array<ValueSlope, kMostMeeting - 1>;

Functions functions_at(InterfaceProbe& probe,
                       std::span<const Label> labels,
                       const WorldPoint& near,
                       const WorldPoint& p) {
  Functions functions{};
  EXPECT_TRUE(probe.choose(labels, near));
  probe.at(p, std::span(functions).first(labels.size() - 1));
  return functions;
}

/// Slopes are what differences over a small step say.
void expect_true_slopes(InterfaceProbe& probe,
                        std::span<const Label> labels,
                        const WorldPoint& p,
                        double tolerance) {
  constexpr double kStep = 1e-3;
  const Functions here = functions_at(probe, labels, p, p);
  for (std::size_t f = 0; f + 1 < labels.size(); ++f) {
    const auto slope = [&](const Vector& way) {
      const auto at = [&](double sign) {
        const double s = sign * kStep;
        return functions_at(probe, labels, p,
                            {p.x + s * way.x, p.y + s * way.y, p.z + s * way.z})[f]
            .value;
      };
      return (at(1) - at(-1)) / (2 * kStep);
    };
    EXPECT_NEAR(here[f].slope.x, slope({1, 0, 0}), tolerance);
    EXPECT_NEAR(here[f].slope.y, slope({0, 1, 0}), tolerance);
    EXPECT_NEAR(here[f].slope.z, slope({0, 0, 1}), tolerance);
  }
}

/// Three labels that meet along a slanted line.
Label three(VoxelCoord v) {
  const double x = v.x - 10.2 - 0.2 * v.z, y = v.y - 11.7;
  return static_cast<Label>(x < 0 ? 1 : y < 0.3 * x ? 2 : 5);
}

std::vector<IndicatorRules> all_rules() {
  std::vector<IndicatorRules> rules;
  for (const LabelKernel kernel :
       {LabelKernel::kTrilinear, LabelKernel::kQuadratic, LabelKernel::kGauss}) {
    for (const std::array<double, 3>& spacing :
         {std::array{1.0, 1.0, 1.0}, {0.6, 1.3, 1.0}, {2.0, 2.0, 1.5}}) {
      rules.push_back({.spacing_voxels = spacing, .kernel = kernel});
    }
  }
  rules.push_back({.smooth = 1.5});
  return rules;
}

TEST(IndicatorProbe, SaysWhatTheNodesSay) {
  const auto voxels = std::make_shared<const VoxelArray>(24, Label{0}, three);
  for (const IndicatorRules& rules : all_rules()) {
    const IndicatorLabels source(voxels, rules);
    const auto probe = source.probe();
    const auto sampler = source.sampler();
    const auto samples = std::make_unique<LabelSamples>();
    sampler->one_label({0, 0, 0});
    sampler->sample_labels({0, 0, 0}, *samples);
    for (const NodeKind kind : {kCorner, kCentre}) {
      for (int x = 4; x < 8; ++x) {
        for (int y = 4; y < 8; ++y) {
          for (int z = 0; z < 8; ++z) {
            const double half = kind == kCentre ? 0.5 : 0;
            const WorldPoint p{x + half, y + half, z + half};
            const Functions functions =
                functions_at(*probe, std::array<Label, 4>{0, 1, 2, 5}, p, p);
            // The largest indicator is that whose difference from the first is the least.
            std::array<double, 4> lead{0, -functions[0].value, -functions[1].value,
                                       -functions[2].value};
            const auto best = std::ranges::max_element(lead);
            std::array<double, 4> sorted = lead;
            std::ranges::sort(sorted);
            if (sorted[3] - sorted[2] < 0.02) continue;  // nearly a tie
            constexpr std::array<Label, 4> kLabels{0, 1, 2, 5};
            EXPECT_EQ(samples->label[kind][static_cast<std::size_t>(halo_index(x, y, z))],
                      kLabels[static_cast<std::size_t>(best - lead.begin())]);
          }
        }
      }
    }
  }
}

TEST(IndicatorProbe, HasTheSlopesOfItsValues) {
  const auto voxels = std::make_shared<const VoxelArray>(24, Label{0}, three);
  for (const IndicatorRules& rules : all_rules()) {
    const auto probe = IndicatorLabels(voxels, rules).probe();
    const auto& [sx, sy, sz] = rules.spacing_voxels;
    // Away from where a trilinear function has its edges.
    for (const WorldPoint& voxel :
         {WorldPoint{11.3, 11.4, 7.2}, {12.6, 12.2, 8.3}, {10.4, 10.3, 4.6}}) {
      expect_true_slopes(*probe, std::array<Label, 3>{1, 2, 5},
                         {voxel.x / sx, voxel.y / sy, voxel.z / sz}, 2e-3);
    }
  }
}

TEST(IndicatorProbe, HasNoJumpsWhereVoxelsComeIntoSight) {
  const auto voxels = std::make_shared<const VoxelArray>(24, Label{0}, three);
  for (const IndicatorRules& rules : all_rules()) {
    const auto probe = IndicatorLabels(voxels, rules).probe();
    constexpr std::array<Label, 2> kLabels{1, 2};
    const WorldPoint from{9 / rules.spacing_voxels[0], 8 / rules.spacing_voxels[1],
                          7 / rules.spacing_voxels[2]};
    ASSERT_TRUE(probe->choose(kLabels, from));
    double last = 0;
    constexpr int kSteps = 4000;
    for (int i = 0; i < kSteps; ++i) {
      std::array<ValueSlope, 1> out;
      probe->at({from.x + 1.0 * i / kSteps, from.y, from.z}, out);
      if (i > 0) {
        EXPECT_NEAR(out[0].value, last, 2e-3);
      }
      last = out[0].value;
    }
  }
}

TEST(IndicatorProbe, IsTheSameWhereverItWasChosenFor) {
  const auto voxels = std::make_shared<const VoxelArray>(24, Label{0}, three);
  for (const IndicatorRules& rules : all_rules()) {
    const auto probe = IndicatorLabels(voxels, rules).probe();
    constexpr std::array<Label, 3> kLabels{1, 2, 5};
    const WorldPoint p{5.1, 5.2, 4.3};
    const Functions here = functions_at(*probe, kLabels, p, p);
    const Functions there = functions_at(*probe, kLabels, {5.7, 4.6, 5.1}, p);
    for (std::size_t f = 0; f < 2; ++f) {
      EXPECT_EQ(here[f].value, there[f].value);
      EXPECT_EQ(here[f].slope.x, there[f].slope.x);
    }
  }
}

TEST(IndicatorProbe, KnowsNothingFarFromWhereItWasChosenFor) {
  const auto voxels = std::make_shared<const VoxelArray>(24, Label{0}, three);
  const auto probe = IndicatorLabels(voxels, {}).probe();
  constexpr std::array<Label, 2> kLabels{1, 2};
  EXPECT_TRUE(std::isnan(functions_at(*probe, kLabels, {9, 9, 9}, {19, 9, 9})[0].value));
}

/// A plane at x = 8.5 seen by a kernel that reaches over hundreds of voxels, some of which
/// stand for others.
TEST(IndicatorProbe, FindsAPlaneByFewOfManyVoxels) {
  const auto voxels = std::make_shared<const VoxelArray>(
      160, Label{0}, [](VoxelCoord v) { return static_cast<Label>(v.x < 85 ? 1 : 2); });
  const auto probe = IndicatorLabels(voxels, {.spacing_voxels = {16, 16, 16}}).probe();
  constexpr std::array<Label, 2> kLabels{1, 2};
  const WorldPoint p{84.5 / 16, 5, 5};
  const auto [value, slope] = functions_at(*probe, kLabels, p, p)[0];
  EXPECT_NEAR(value / slope.x, 0, 0.02);
}

// --- Solids ---

std::shared_ptr<const Volume> ball_of_voxels(double x) {
  const auto value = [&](VoxelCoord v) {
    return static_cast<float>(
        std::clamp(std::hypot(0.1 * v.x - x, 0.1 * v.y, 0.1 * v.z) - 1, -0.3, 0.3));
  };
  return std::make_shared<const Volume>(
      test::dense_volume({{-32, -32, -32}, {31, 31, 31}}, 0.3F, value, test::scaled(0.1)));
}

TEST(FieldProbe, OfTheDeepestVanishesWhereTwoAreEquallyDeep) {
  const auto a = ball_of_voxels(-0.5), b = ball_of_voxels(0.5);
  PhiField of_a, of_b;
  of_a.volume = a.get();
  of_b.volume = b.get();
  const FieldLabels labels({{of_a, 1}, {of_b, 2}}, 0, Overlap::kDeepest);
  const auto probe = labels.probe();
  // The lattice has spacings of 0.1; the two meet at x = 0, and with nobody on a circle.
  constexpr std::array<Label, 2> kTwo{1, 2};
  EXPECT_NEAR(functions_at(*probe, kTwo, {0, 7, 1}, {0, 7.3, 1.2})[0].value, 0, 1e-6);
  constexpr std::array<Label, 3> kAll{0, 1, 2};
  const double y = 10 * std::sqrt(0.75);
  const Functions functions = functions_at(*probe, kAll, {0, y, 0}, {0, y, 0});
  EXPECT_NEAR(functions[0].value, 0, 5e-3);
  EXPECT_NEAR(functions[1].value, 0, 5e-3);
  expect_true_slopes(*probe, kAll, {0.3, 8.4, 0.6}, 1e-4);
}

TEST(FieldProbe, OfTheFirstVanishesOnTheEarlierOnesSurface) {
  test::SceneWriter first, second;
  first.add(scene::Sphere{1});
  second.add_moved({1, 0, 0}, second.add(scene::Sphere{1}));
  const Scene one = first.scene(), two = second.scene();
  PhiField of_one, of_two;
  of_one.scene = &one;
  of_two.scene = &two;
  of_one.spacing_voxels = of_two.spacing_voxels = 0.1;
  const FieldLabels labels({{of_one, 2}, {of_two, 1}}, 0, Overlap::kFirst);
  const auto probe = labels.probe();
  constexpr std::array<Label, 2> kTwo{1, 2};
  // Within the second, on the first one's surface.
  EXPECT_NEAR(functions_at(*probe, kTwo, {10, 0, 0}, {10, 0, 0})[0].value, 0, 1e-9);
  constexpr std::array<Label, 3> kAll{0, 1, 2};
  const double y = 10 * std::sqrt(0.75);
  const Functions functions = functions_at(*probe, kAll, {5, y, 0}, {5, y, 0});
  EXPECT_NEAR(functions[0].value, 0, 1e-9);
  EXPECT_NEAR(functions[1].value, 0, 1e-9);
  expect_true_slopes(*probe, kAll, {5.3, 8.4, 0.6}, 1e-4);
}

TEST(FieldProbe, LooksAtTheSolidOfALabelThatIsThere) {
  const auto a = ball_of_voxels(-1.4), b = ball_of_voxels(0), c = ball_of_voxels(1.4);
  std::vector<LabelledField> fields;
  for (const auto& [volume, label] : {std::pair(a, Label{1}), {b, Label{2}}, {c, Label{1}}}) {
    PhiField field;
    field.volume = volume.get();
    fields.push_back({field, label});
  }
  for (const Overlap overlap : {Overlap::kDeepest, Overlap::kFirst}) {
    const FieldLabels labels(fields, 0, overlap);
    const auto probe = labels.probe();
    constexpr std::array<Label, 2> kTwo{1, 2};
    const double right = overlap == Overlap::kDeepest ? 7 : 10,
                 left = overlap == Overlap::kDeepest ? -7 : -4;
    EXPECT_NEAR(functions_at(*probe, kTwo, {right, 0, 0}, {right, 0.4, 0.2})[0].value, 0, 0.02);
    EXPECT_NEAR(functions_at(*probe, kTwo, {left, 0, 0}, {left, 0.4, 0.2})[0].value, 0, 0.02);
  }
}

TEST(FieldProbe, RefusesLabelsThatAreOneSolid) {
  const auto a = ball_of_voxels(0);
  PhiField field;
  field.volume = a.get();
  const FieldLabels labels({{field, 1}}, 0, Overlap::kDeepest);
  // Nobody has either of them.
  constexpr std::array<Label, 2> kUnknown{7, 8};
  EXPECT_FALSE(labels.probe()->choose(kUnknown, {0, 0, 0}));
}

}  // namespace
}  // namespace tet::interface_probe_test
