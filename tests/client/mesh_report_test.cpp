#include "client/command/mesh/mesh_report.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "client/command/process/exit_code.h"
#include "tests/core/mesh/small_meshes.h"

namespace tet {
namespace {

MadeMesh made_cube() {
  MadeMesh made{.mesh = kuhn_mesh(1),
                .quality = {},
                .boundary = {},
                .improvement = {},
                .thin_walls = {},
                .stages = {{"planning", 0.5}}};
  made.quality = measure_quality(made.mesh);
  return made;
}

nlohmann::json report_of(const MadeMesh& made, const MeshRequest& request = {}) {
  return nlohmann::json::parse(report_json(made, request, 2.5));
}

/// One tet of six inside.
MadeMesh made_both_sides() {
  MadeMesh made = made_cube();
  made.mesh = with_regions(std::move(made.mesh), [](std::uint64_t tet) { return tet == 0; });
  return made;
}

TEST(MeshReport, HasTheKeysThatScriptsReadAndTheirValues) {
  const auto report = report_of(made_cube());
  EXPECT_EQ(report["vertices"], 8);
  EXPECT_EQ(report["tets"], 6);
  EXPECT_NEAR(report["min_dihedral_deg"].get<double>(), 45, 1e-9);
  EXPECT_NEAR(report["max_dihedral_deg"].get<double>(), 90, 1e-9);
  EXPECT_DOUBLE_EQ(report["volume"], 1);
  EXPECT_EQ(report["seconds"], 2.5);
  EXPECT_EQ(report["stages"]["planning"], 0.5);
  EXPECT_EQ(report["boundary"]["components"], 1);
  EXPECT_EQ(report["boundary"]["euler_characteristic"], 2);
  EXPECT_EQ(report["boundary"]["non_manifold_edges"], 0);
  EXPECT_EQ(report["boundary"]["non_manifold_vertices"], 0);
  EXPECT_EQ(report["dihedral_histogram"].size(), 180U);
  EXPECT_FALSE(report.contains("regions"));
  EXPECT_FALSE(report["boundary"].contains("restored_nodes"));
}

TEST(MeshReport, TakesTheBoundaryThatWasCountedWithTheMesh) {
  MadeMesh made = made_cube();
  made.boundary = BoundaryTopology{.triangles = 99};
  EXPECT_EQ(report_of(made)["boundary"]["triangles"], 99);
}

TEST(MeshReport, TellsRestoredNodesWhereAManifoldWasAskedFor) {
  MadeMesh made = made_cube();
  MeshRequest request;
  request.manifold = true;
  EXPECT_FALSE(report_of(made, request)["boundary"].contains("restored_nodes"))
      << "they cannot be measured";
  made.boundary = BoundaryTopology{};
  EXPECT_EQ(report_of(made, request)["boundary"]["restored_nodes"], 0);
  made.boundary->restored_nodes = 3;
  EXPECT_EQ(report_of(made, request)["boundary"]["restored_nodes"], 3);
}

TEST(MeshReport, TellsBothSidesApart) {
  const auto report = report_of(made_both_sides());
  EXPECT_EQ(report["tets"], 6);
  EXPECT_EQ(report["regions"]["inside"]["tets"], 1);
  EXPECT_EQ(report["regions"]["outside"]["tets"], 5);
  EXPECT_DOUBLE_EQ(report["regions"]["inside"]["volume"], 1.0 / 6);
  EXPECT_DOUBLE_EQ(report["regions"]["outside"]["volume"], 5.0 / 6);
  EXPECT_EQ(report["boundary"]["triangles"], 4) << "of the inside";
}

TEST(MeshReport, TellsTheGridsOfSeveralApart) {
  MadeMesh made = made_cube();
  EXPECT_FALSE(report_of(made).contains("parts"));
  made.mesh.header.parts = {{"femur", 0, 3, 0, 2, 0.5, 1}, {"tibia", 3, 5, 2, 4, 1, 0}};
  const auto parts = report_of(made)["parts"];
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0]["name"], "femur");
  EXPECT_EQ(parts[0]["spacing"], 0.5);
  EXPECT_EQ(parts[1]["tets"], 4);
  EXPECT_EQ(parts[1]["vertices"], 5);
  EXPECT_NEAR(parts[1]["volume"].get<double>(), 4.0 / 6, 1e-6);
  EXPECT_THAT(summary_line("leg.vtu", made, 1),
              testing::HasSubstr("6 tets (2 femur, 4 tibia), dihedral"));
  made.mesh.header.parts.resize(12, {"more", 8, 0, 6, 0, 1, 0});
  EXPECT_THAT(summary_line("leg.vtu", made, 1), testing::HasSubstr("and of 4 more grids)"));
}

TEST(MeshReport, TellsWhatAnImprovementDid) {
  MadeMesh made = made_cube();
  EXPECT_FALSE(report_of(made).contains("improvement"));
  made.improvement = {.min_dihedral_before_deg = 30,
                      .max_dihedral_before_deg = 100,
                      .moved_vertices = 4,
                      .seconds = 0.25};
  const auto improvement = report_of(made)["improvement"];
  EXPECT_EQ(improvement["min_before_deg"], 30);
  EXPECT_EQ(improvement["max_before_deg"], 100);
  EXPECT_EQ(improvement["min_after_deg"], made.quality.min_dihedral_deg);
  EXPECT_EQ(improvement["max_after_deg"], made.quality.max_dihedral_deg);
  EXPECT_EQ(improvement["moved_vertices"], 4);
  EXPECT_EQ(improvement["seconds"], 0.25);
}

TEST(MeshReport, TellsOfWallsThatTheLatticeCannotResolve) {
  MadeMesh made = made_cube();
  EXPECT_EQ(thin_walls_warning(made.thin_walls), "");
  made.thin_walls.inside = 30;
  made.thin_walls.outside = 4;
  made.thin_walls.region_count = 17;
  made.thin_walls.suggested_spacing = 0.25;
  ThinWalls::Region& region = made.thin_walls.regions.emplace_back();
  region.box.max = {3, 4, 5.5};
  EXPECT_EQ(
      thin_walls_warning(made.thin_walls),
      "warning: the lattice does not resolve 30 spots of thin walls and 4 of narrow gaps, "
      "in 17 regions; a grid sampled and meshed at about 0.25 would");
  const auto walls = report_of(made)["thin_walls"];
  EXPECT_EQ(walls["inside_spots"], 30);
  EXPECT_EQ(walls["outside_spots"], 4);
  EXPECT_EQ(walls["region_count"], 17);
  EXPECT_EQ(walls["suggested_spacing"], 0.25);
  EXPECT_EQ(walls["regions"][0]["max"], nlohmann::json({3, 4, 5.5}));
}

TEST(MeshReport, SumsUpInOneLine) {
  EXPECT_EQ(summary_line("cube.vtu", made_cube(), 0.25),
            "cube.vtu: 8 vertices, 6 tets, dihedral angles 45.00 to 90.00 degrees, 0.25 s");
}

TEST(MeshReport, SumsUpBothSidesAndWhatWasRestoredInOneLine) {
  MadeMesh made = made_both_sides();
  made.boundary = BoundaryTopology{.restored_nodes = 1};
  EXPECT_EQ(
      summary_line("cube.vtu", made, 0.25),
      "cube.vtu: 8 vertices, 6 tets (1 inside, 5 outside), dihedral angles 45.00 to 90.00 "
      "degrees, 1 node restored, 0.25 s");
}

TEST(MeshReport, SaysInOneLineThatAllTetsLieOnOneSide) {
  MadeMesh made = made_both_sides();
  made.is_written = true;  // and counted while it was
  made.tets_inside = 0;
  EXPECT_THAT(summary_line("cube.vtu", made, 0.25),
              testing::HasSubstr(
                  "6 tets (0 inside, 6 outside: the surface does not reach into the box), "));
  made.tets_inside = 6;
  EXPECT_THAT(summary_line("cube.vtu", made, 0.25),
              testing::HasSubstr(
                  "6 tets (6 inside, 0 outside: the surface does not reach into the box), "));
}

TEST(ExitCode, TellsWhoIsToBlame) {
  EXPECT_EQ(exit_code_of(absl::StatusCode::kOk), ExitCode::kDone);
  EXPECT_EQ(exit_code_of(absl::StatusCode::kNotFound), ExitCode::kRefused);
  EXPECT_EQ(exit_code_of(absl::StatusCode::kResourceExhausted), ExitCode::kRefused);
  EXPECT_EQ(exit_code_of(absl::StatusCode::kUnavailable), ExitCode::kServer);
  EXPECT_EQ(exit_code_of(absl::StatusCode::kDataLoss), ExitCode::kServer);
}

TEST(MeshReport, SuggestsNoSpacingWhereNoneIsKnown) {
  MadeMesh made = made_cube();
  made.thin_walls.inside = 30;
  made.thin_walls.region_count = 1;
  EXPECT_THAT(thin_walls_warning(made.thin_walls),
              testing::HasSubstr("no spacing is known that would"));
}

TEST(MeshReport, ComparesTheMeshWithTheSurfaceThatWasConverted) {
  MadeMesh made = made_cube();
  EXPECT_EQ(volume_warning(made), "");
  ConversionReport surface;
  surface.area = 6;
  surface.voxel_size = 0.125;
  surface.volume = made.quality.volume;
  surface.surface_volume = made.quality.volume + 0.03;
  made.surface = surface;
  EXPECT_EQ(volume_warning(made), "") << "within a twentieth of spacing times area";
  made.surface->surface_volume = made.quality.volume + 8;
  EXPECT_THAT(volume_warning(made), testing::HasSubstr("does not resolve it"));
  const auto told = report_of(made)["surface"];
  EXPECT_EQ(told["converted_to"], "solid");
  EXPECT_EQ(told["volume"], made.quality.volume + 8);
  EXPECT_EQ(told["warnings"].size(), 2U) << "of the level set, and of the mesh";
  made.cuts_inside = true;
  EXPECT_EQ(volume_warning(made), "") << "a part of it has another volume";
}

}  // namespace
}  // namespace tet
