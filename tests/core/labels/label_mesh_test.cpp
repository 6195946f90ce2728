// What a mesh of labels promises, on labels as hostile as there are.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/mesh/quality.h"
#include "core/plan/mesh_request.h"
#include "tests/core/labels/label_meshing.h"
#include "tests/core/plan/meshing.h"
#include "tests/support/conformity.h"
#include "tests/support/reference_labels.h"
#include "tests/support/sanitized.h"

namespace tet {
namespace {

using test::label_cases;
using test::LabelCase;
using test::LabelMeshing;
using test::mesh_of;
using test::parts_of;

const AngleBounds kBounds = angle_bounds(Preset::kBothSides, CoordinateType::kFloat64);
constexpr BrickBox kBox{{-1, 0, -1}, {0, 1, 0}};

double volume_of(const TetMesh& mesh) {
  double volume = 0;
  for (const auto& [label, part] : parts_of(mesh)) volume += part.volume;
  return volume;
}

/// All cases. A sanitizer sees the random ones of three labels, with which up to three of them
/// meet in a tet in every way, and of a thousand, with which four do in nearly all.
std::vector<LabelCase> cases(std::uint32_t seed) {
  std::vector<LabelCase> all = label_cases(kBox, seed);
  if (!test::kSanitized) return all;
  std::erase_if(all, [](const LabelCase& labels) {
    const bool is_random = labels.name.find("random") != std::string::npos;
    return is_random && labels.labels != 3 && labels.labels != 1000;
  });
  return all;
}

void expect_conforming(const TetMesh& mesh) {
  const ConformityReport report = check_conformity(mesh);
  EXPECT_TRUE(report.conforming()) << report.describe();
}

void expect_within_bounds(const FilledMesh& filled) {
  expect_conforming(filled.mesh);
  const QualityStats measured = measure_quality(filled.mesh);
  EXPECT_GT(measured.min_dihedral_deg, kBounds.min_deg);
  EXPECT_LT(measured.max_dihedral_deg, kBounds.max_deg);
  EXPECT_NEAR(filled.quality.min_dihedral_deg, measured.min_dihedral_deg, 1e-3);
  EXPECT_NEAR(filled.quality.max_dihedral_deg, measured.max_dihedral_deg, 1e-3);
}

/// `without` is `whole` but for label 0.
void expect_without_0(const TetMesh& without, const TetMesh& whole) {
  expect_conforming(without);
  auto expected = parts_of(whole);
  expected.erase(0);
  const auto parts = parts_of(without);
  ASSERT_EQ(parts.size(), expected.size());
  for (const auto& [label, part] : parts) {
    EXPECT_EQ(part.tets, expected.at(label).tets);
    EXPECT_NEAR(part.volume, expected.at(label).volume, 1e-9);
  }
}

/// Whether some cell has nodes of one label alone. Without, meshes of any levels are the same.
bool may_coarsen(const LabelCase& labels) {
  const bool is_all_cut = labels.name.find("random") != std::string::npos ||
                          labels.name.starts_with("checkerboard");
  return !is_all_cut || labels.name.ends_with("surrounded");
}

/// Each mesh is made once for all that is said of it.
TEST(LabelMesh, KeepsItsPromisesOnAnyLabels) {
  for (const LabelCase& labels : test::few_of(cases(1), 4)) {
    for (const int levels : {0, kMaxLevels}) {
      if (levels == 0 && !may_coarsen(labels)) continue;
      SCOPED_TRACE(labels.name + ", levels " + std::to_string(levels));
      LabelMeshing how{.domain = kBox, .levels = levels, .threads = 1};
      how.labels = labels.labels;
      how.chunk_bytes = 1 << 24;
      const FilledMesh whole = mesh_of(labels.functions, how);
      expect_within_bounds(whole);
      LabelMeshing without = how;
      without.kept.left_out = 0;
      expect_without_0(mesh_of(labels.functions, without).mesh, whole.mesh);
      if (levels == 0) continue;
      // Its bytes are the same for any threads and chunks.
      how.threads = 3;
      how.chunk_bytes = 1 << 14;
      const FilledMesh again = mesh_of(labels.functions, how);
      EXPECT_TRUE(test::same_bytes(whole.mesh, again.mesh));
      EXPECT_GT(again.mesh.header.chunk_count, whole.mesh.header.chunk_count);
    }
  }
}

TEST(LabelMesh, FillsTheBoxWhereNothingMeetsItsFaces) {
  for (const LabelCase& labels : label_cases(kBox, 2)) {
    if (!labels.name.ends_with("surrounded")) continue;
    for (const int levels : {0, kMaxLevels}) {
      SCOPED_TRACE(labels.name + ", levels " + std::to_string(levels));
      const TetMesh mesh = mesh_of(labels.functions, {.domain = kBox, .levels = levels}).mesh;
      EXPECT_NEAR(volume_of(mesh), 16.0 * 16 * 16, 1e-7);
    }
  }
}

TEST(LabelMesh, FillsABoxOfOneLabelOnAnyLevels) {
  const test::LabelFunctions one{[](LatticeCoord) { return Label{3}; },
                                 [](LatticeCoord, int) { return 0.5F; }};
  for (const BrickBox& box : {BrickBox{{2, 1, -2}, {2, 2, -1}}, BrickBox{{0, 0, 0}, {0, 0, 0}},
                              BrickBox{{-1, -1, -1}, {0, 0, 0}}}) {
    const double volume = 512.0 * (box.max.x - box.min.x + 1) * (box.max.y - box.min.y + 1) *
                          (box.max.z - box.min.z + 1);
    for (const int levels : {0, 1, 2, 3, 4, kMaxLevels}) {
      SCOPED_TRACE(levels);
      const TetMesh mesh = mesh_of(one, {.domain = box, .levels = levels}).mesh;
      EXPECT_EQ(mesh.header.levels, std::min(levels, 3));
      const ConformityReport report = check_conformity(mesh);
      EXPECT_TRUE(report.conforming()) << report.describe();
      EXPECT_NEAR(volume_of(mesh), volume, 1e-7);
    }
  }
}

/// The lattice node at a place, if one is there.
std::optional<LatticeCoord> node_at(const WorldPoint& p) {
  const auto round = [](double v) { return static_cast<std::int32_t>(std::lround(2 * v)); };
  const LatticeCoord node{round(p.x), round(p.y), round(p.z)};
  if (0.5 * node.x != p.x || 0.5 * node.y != p.y || 0.5 * node.z != p.z) return std::nullopt;
  const bool even = (node.x & 1) == 0;
  if (((node.y & 1) == 0) != even || ((node.z & 1) == 0) != even) return std::nullopt;
  return node;
}

/// Every node that stays is in tets of its own label alone.
void expect_staying(const TetMesh& mesh, const test::LabelReference& expected) {
  std::map<LatticeCoord, std::uint64_t> tets_at;
  std::uint64_t others = 0;
  for (std::uint64_t t = 0; t < mesh.header.tet_count; ++t) {
    for (const std::uint64_t v : mesh.tet(t)) {
      const auto node = node_at(mesh.vertex(v));
      if (!node || !expected.staying.contains(*node)) continue;
      ++tets_at[*node];
      others += mesh.label(t) != expected.staying.at(*node) ? 1 : 0;
    }
  }
  EXPECT_EQ(others, 0U);
  EXPECT_EQ(tets_at.size(), expected.staying.size());
}

/// In counts, volumes, and the labels around nodes.
TEST(LabelMesh, IsWhatAnIndependentReadingOfTheRulesMakes) {
  constexpr BrickBox kSmall{{0, -1, 3}, {0, -1, 4}};
  const std::vector<Label> all_left_out{kJoker, 0, 1};
  for (const LabelCase& labels : label_cases(kSmall, 3)) {
    const auto references = test::reference_labels(labels.functions, kSmall, all_left_out);
    for (std::size_t i = 0; i < all_left_out.size(); ++i) {
      const Label left_out = all_left_out[i];
      SCOPED_TRACE(labels.name + ", without " + std::to_string(left_out));
      const TetMesh mesh =
          mesh_of(labels.functions, {.domain = kSmall, .kept = {left_out}}).mesh;
      const test::LabelReference& expected = references[i];
      EXPECT_EQ(mesh.header.vertex_count, expected.vertices);
      EXPECT_EQ(mesh.header.tet_count, expected.tets);
      const auto parts = parts_of(mesh);
      EXPECT_EQ(parts.size(), expected.tets_of.size());
      for (const auto& [label, tets] : expected.tets_of) {
        EXPECT_EQ(parts.at(label).tets, tets) << label;
      }
      expect_staying(mesh, expected);
      if (left_out != kJoker) continue;
      EXPECT_NEAR(volume_of(mesh), expected.volume, 1e-7);
    }
  }
}

TEST(LabelMesh, HasTheSamePartsGradedAndUniform) {
  const auto functions = test::surrounded(label_cases(kBox, 5).back().functions, kBox);
  constexpr BrickBox kLarge{{-2, -2, -2}, {1, 1, 1}};
  const TetMesh uniform = mesh_of(functions, {.domain = kLarge}).mesh;
  const TetMesh graded = mesh_of(functions, {.domain = kLarge, .levels = kMaxLevels}).mesh;
  EXPECT_LT(graded.header.tet_count, uniform.header.tet_count * 2 / 3);
  EXPECT_GE(graded.header.levels, 2);
  const auto parts = parts_of(uniform);
  for (const auto& [label, part] : parts_of(graded)) {
    EXPECT_NEAR(part.volume, parts.at(label).volume, 1e-10 * part.volume + 1e-9) << label;
  }
}

TEST(LabelMesh, IsRefusedWhereNothingIsLeftOfIt) {
  const test::LabelFunctions zero{[](LatticeCoord) { return Label{0}; },
                                  [](LatticeCoord, int) { return 0.5F; }};
  const auto source = std::make_shared<const test::FunctionLabels>(zero);
  LabelMeshing how{.kept = {0}};
  auto job = test::label_job(source, how);
  const auto plan = plan_labels(job);
  EXPECT_EQ(plan.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(plan.status().message()), testing::HasSubstr("background"));
}

TEST(LabelMesh, IsRefusedOverTheLimits) {
  const auto labels = label_cases(kBox, 8).front();
  auto job = test::label_job(std::make_shared<const test::FunctionLabels>(labels.functions),
                             {.domain = kBox});
  job.limits.max_plan_bytes = 20'000;
  EXPECT_EQ(plan_labels(job).status().code(), absl::StatusCode::kResourceExhausted);
  job.limits = {};
  job.limits.max_tets = 1'000;
  EXPECT_EQ(plan_labels(job).status().code(), absl::StatusCode::kResourceExhausted);
}

}  // namespace
}  // namespace tet
