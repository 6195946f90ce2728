#include "client/mesh_report.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "client/exit_code.h"
#include "tests/core/mesh/small_meshes.h"

namespace tet {
namespace {

MadeMesh made_cube() {
  MadeMesh made{
      .mesh = kuhn_mesh(1), .quality = {}, .thin_walls = {}, .stages = {{"planning", 0.5}}};
  made.quality = measure_quality(made.mesh);
  return made;
}

TEST(MeshReport, HasTheKeysThatScriptsReadAndTheirValues) {
  const MadeMesh made = made_cube();
  const auto report =
      nlohmann::json::parse(report_json(made, measure_boundary(made.mesh), 2.5));
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
  const auto walls =
      nlohmann::json::parse(report_json(made, measure_boundary(made.mesh), 1))["thin_walls"];
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

TEST(ExitCode, TellsWhoIsToBlame) {
  EXPECT_EQ(exit_code_of(absl::StatusCode::kOk), ExitCode::kDone);
  EXPECT_EQ(exit_code_of(absl::StatusCode::kNotFound), ExitCode::kRefused);
  EXPECT_EQ(exit_code_of(absl::StatusCode::kResourceExhausted), ExitCode::kRefused);
  EXPECT_EQ(exit_code_of(absl::StatusCode::kUnavailable), ExitCode::kServer);
  EXPECT_EQ(exit_code_of(absl::StatusCode::kDataLoss), ExitCode::kServer);
}

}  // namespace
}  // namespace tet
