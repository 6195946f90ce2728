// Values of other grids at the vertices of a mesh.
#include <array>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/plan/make/mesher.h"
#include "core/volume/label_volume.h"
#include "core/volume/volume_builder.h"
#include "tests/core/plan/mesh_by_chunks.h"
#include "tests/core/plan/meshing.h"
#include "tests/support/solids.h"
#include "tests/support/volume_fixtures.h"

namespace tet::vertex_fields_test {
namespace {

using test::mesh;
using test::same_bytes;

using WorldFunction = std::function<double(const WorldPoint&)>;

constexpr float kBackground = -7;
constexpr int kEdge = 14;  // of what fields cover around the origin, their voxels

/// Voxels that are no whole part of the ball's, turned, and off its lattice.
VoxelTransform other_voxels() {
  constexpr double kVoxel = 1.75;
  VoxelTransform transform;
  transform.linear = {
      {{0.8 * kVoxel, 0.6 * kVoxel, 0}, {-0.6 * kVoxel, 0.8 * kVoxel, 0}, {0, 0, kVoxel}}};
  transform.translation = {0.5, 0.25, -0.5};
  transform.voxel_size = kVoxel;
  return transform;
}

std::shared_ptr<const Volume> values_of(const WorldFunction& function, int edge = kEdge) {
  const VoxelTransform transform = other_voxels();
  const VoxelBox box{{-edge, -edge, -edge}, {edge, edge, edge}};
  Volume volume = test::dense_volume(
      box, kBackground,
      [&](VoxelCoord v) {
        return static_cast<float>(
            function(transform.to_world({double(v.x), double(v.y), double(v.z)})));
      },
      transform);
  volume.kind = VolumeKind::kField;
  volume.name = "values";
  return std::make_shared<const Volume>(std::move(volume));
}

VertexField scalar(const std::string& name, const WorldFunction& function, int edge = kEdge) {
  return {name, "", "", {values_of(function, edge)}};
}

VertexField vector(const std::string& name, const std::array<WorldFunction, 3>& functions) {
  VertexField field{name, "", "", {}};
  for (const WorldFunction& function : functions) {
    Volume component = *values_of(function);
    component.kind = VolumeKind::kVectorField;
    field.components.push_back(std::make_shared<const Volume>(std::move(component)));
  }
  return field;
}

double heat(const WorldPoint& p) { return 1 + 2 * p.x - 3 * p.y + 0.5 * p.z; }
double along_x(const WorldPoint& p) { return p.y - p.z; }
double along_y(const WorldPoint& p) { return 4 * p.x; }
double along_z(const WorldPoint&) { return 0.125; }

MeshRequest with_fields(MeshRequest request = {}) {
  request.fields = {scalar("heat", heat), vector("flow", {along_x, along_y, along_z})};
  return request;
}

float value_of(const TetMesh& mesh, std::uint64_t vertex, std::size_t column) {
  float value = 0;
  const std::size_t row = mesh.header.field_values();
  std::memcpy(&value, mesh.fields.bytes().data() + 4 * (vertex * row + column), 4);
  return value;
}

void expect_linear_values(const TetMesh& mesh) {
  const std::vector<FieldArray> arrays{{"heat", 1}, {"flow", 3}};
  ASSERT_EQ(mesh.header.fields, arrays);
  const std::array<WorldFunction, 4> functions{heat, along_x, along_y, along_z};
  // Two roundings add up: that of the largest voxel when it was stored, and that of the result.
  const double rounding = 100 * std::numeric_limits<float>::epsilon();
  for (std::uint64_t i = 0; i < mesh.header.vertex_count; ++i) {
    for (std::size_t column = 0; column < functions.size(); ++column) {
      ASSERT_NEAR(value_of(mesh, i, column), functions[column](mesh.vertex(i)), rounding)
          << "vertex " << i << ", column " << column;
    }
  }
}

TEST(VertexFields, ReproduceLinearFunctionsAtEveryVertex) {
  expect_linear_values(mesh(test::ball(12), with_fields()).mesh);
}

TEST(VertexFields, AreThoseOfWhereVerticesLieInTheEnd) {
  MeshRequest request = with_fields();
  request.improve = true;
  expect_linear_values(mesh(test::ball(9), request).mesh);
  request = with_fields();
  request.preset = Preset::kBothSides;
  request.box = {{-10, -10, -10}, {10, 10, 10}};
  request.coordinates = CoordinateType::kFloat64;
  const MeshResult both = mesh(test::ball(8), request);
  expect_linear_values(both.mesh);
  EXPECT_TRUE(both.mesh.header.has_regions);
}

/// Four labels that meet along curves, in 14 x 14 x 14 voxels around the origin.
Shape quarters() {
  constexpr int kSide = 14;
  std::vector<std::int64_t> values;
  for (int z = 0; z < kSide; ++z) {
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x)
        values.push_back(1 + (x + z > 13 ? 1 : 0) + (y > 6 ? 2 : 0));
    }
  }
  auto volume = make_label_volume({.name = "quarters",
                                   .transform = {},
                                   .size = {kSide, kSide, kSide},
                                   .min = {-7, -7, -7},
                                   .values = values});
  EXPECT_TRUE(volume.ok()) << volume.status();
  return std::make_shared<const LabelVolume>(*std::move(volume));
}

TEST(VertexFields, GoWithSegmentations) {
  MeshRequest request;
  request.labels.emplace();
  request.faces = true;
  TaskPool pool(2);
  const auto plain = mesh_volume(pool, {.shape = quarters(), .request = request});
  const auto rich = mesh_volume(pool, {.shape = quarters(), .request = with_fields(request)});
  ASSERT_TRUE(plain.ok() && rich.ok()) << plain.status() << rich.status();
  EXPECT_EQ(rich->mesh.header.labels.size(), 4U);
  expect_linear_values(rich->mesh);
  EXPECT_TRUE(
      same_bytes(test::mesh_by_chunks(quarters(), with_fields(request), 4000), rich->mesh));
  const auto same_columns = [&](auto column) {
    return std::ranges::equal((plain->mesh.*column).bytes(), (rich->mesh.*column).bytes());
  };
  EXPECT_TRUE(same_columns(&TetMesh::positions) && same_columns(&TetMesh::tets));
  EXPECT_TRUE(same_columns(&TetMesh::regions) && same_columns(&TetMesh::faces));
}

TEST(VertexFields, ChangeNothingElse) {
  const MeshResult plain = mesh(test::ball(12)), rich = mesh(test::ball(12), with_fields());
  EXPECT_TRUE(std::ranges::equal(plain.mesh.positions.bytes(), rich.mesh.positions.bytes()));
  EXPECT_TRUE(std::ranges::equal(plain.mesh.tets.bytes(), rich.mesh.tets.bytes()));
}

TEST(VertexFields, AreTheBackgroundBeyondTheirGrid) {
  MeshRequest request;
  request.fields = {scalar("small", heat, 2)};
  const TetMesh made = mesh(test::ball(12), request).mesh;
  std::uint64_t outside = 0;
  for (std::uint64_t i = 0; i < made.header.vertex_count; ++i) {
    const WorldPoint p = made.vertex(i);
    if (p.x * p.x + p.y * p.y + p.z * p.z < 10 * 10) continue;
    EXPECT_EQ(value_of(made, i, 0), kBackground);
    ++outside;
  }
  EXPECT_GT(outside, 100U);
}

std::shared_ptr<const MeshPlan> plan(const Volume& volume,
                                     const MeshRequest& request,
                                     const MeshLimits& limits = {}) {
  return plan_mesh({.shape = std::make_shared<const Volume>(volume),
                    .request = request,
                    .limits = limits})
      .value();
}

TEST(VertexFields, AreTheSameBytesForAnyThreadsAndChunks) {
  MeshRequest improved = with_fields();
  improved.improve = true;
  for (const MeshRequest& request : {with_fields(), improved}) {
    const Volume ball = test::ball(14);
    const TetMesh one = mesh(ball, request, 1).mesh;
    EXPECT_TRUE(same_bytes(one, mesh(ball, request, 4).mesh));
    MeshLimits small;
    small.chunk_bytes = 20'000;
    const auto planned = plan(ball, request, small);
    ASSERT_GT(planned->header().chunk_count, 10U);
    TetMesh joined(planned->header());
    MeshWorkspace workspace;
    for (std::uint64_t i = planned->header().chunk_count; i-- > 0;) {
      planned->fill_chunk(i, workspace, joined.columns_of(planned->chunk(i)));
    }
    EXPECT_TRUE(same_bytes(one, joined));
  }
}

TEST(VertexFields, CountAsBytesOfTheirChunks) {
  const auto planned = plan(test::ball(20), with_fields());
  const MeshHeader& header = planned->header();
  const std::uint64_t vertices = header.vertex_count;
  EXPECT_EQ(ChunkSizes(header, vertices, 0).total(), vertices * (12 + 16));
  for (std::uint64_t i = 0; i < header.chunk_count; ++i) {
    const ChunkExtent chunk = planned->chunk(i);
    EXPECT_LE(chunk.vertex_count * 28 + chunk.tet_count * 16, kChunkBytes);
  }
}

std::string refusal(const std::vector<VertexField>& fields) {
  MeshRequest request;
  request.fields = fields;
  const auto planned =
      plan_mesh({.shape = std::make_shared<const Volume>(test::ball(5)), .request = request});
  EXPECT_EQ(planned.status().code(), absl::StatusCode::kInvalidArgument);
  return std::string(planned.status().message());
}

TEST(VertexFields, AreRefusedWithTheField) {
  const VertexField good = scalar("heat", heat, 1);
  EXPECT_EQ(refusal({good, good}),
            "fields[1].name \"heat\" is that of fields[0], too: give them two names");
  EXPECT_EQ(refusal({good, {"flow"}}), "fields[1].grid is not loaded");
  VertexField by_grid = good;
  by_grid.name = "";
  EXPECT_EQ(refusal({by_grid, {"values", "", "", good.components}}),
            "fields[1].name \"values\" is that of fields[0], too: give them two names");
  EXPECT_EQ(refusal(std::vector(17, good)), "fields has 17 entries; the limit is 16");
  VertexField two = good;
  two.components.push_back(two.components.front());
  EXPECT_EQ(refusal({two}), "fields[0].grid is not loaded") << "a scalar has one component";
  VertexField solid = good;
  solid.name = "a/b";
  EXPECT_EQ(refusal({solid}),
            "fields[0].name \"a/b\" cannot name an array: it takes UTF-8 of 1 to 128 bytes "
            "without control characters, / and quotes");
}

TEST(VertexFields, TakeNamesThatEveryFormatTakes) {
  for (const char* name :
       {"T", "velocity.x", "Temperatur in \u00b0C", "a b", "name[0]", "<&>"}) {
    EXPECT_TRUE(is_array_name(name)) << name;
  }
  for (const std::string& name :
       {std::string(), std::string("."), std::string("a\nb"), std::string("\"a\""),
        std::string("\xff"), std::string("a\0b", 3), std::string(129, 'a')}) {
    EXPECT_FALSE(is_array_name(name)) << name;
  }
}

}  // namespace
}  // namespace tet::vertex_fields_test
