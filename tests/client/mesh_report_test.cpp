#include "client/mesh_report.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "client/exit_code.h"
#include "tests/core/mesh/small_meshes.h"

namespace tet {
namespace {

MadeMesh made_cube() {
  MadeMesh made{
      .mesh = kuhn_mesh(1), .quality = {}, .improvement = {}, .stages = {{"planning", 0.5}}};
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

TEST(MeshReport, TellsWhatAnImprovementDid) {
  MadeMesh made = made_cube();
  const auto parsed = [&] {
    return nlohmann::json::parse(report_json(made, measure_boundary(made.mesh), 1));
  };
  EXPECT_FALSE(parsed().contains("improvement"));
  made.improvement = {.min_dihedral_before_deg = 30,
                      .max_dihedral_before_deg = 100,
                      .moved_vertices = 4,
                      .seconds = 0.25};
  const auto improvement = parsed()["improvement"];
  EXPECT_EQ(improvement["min_before_deg"], 30);
  EXPECT_EQ(improvement["max_before_deg"], 100);
  EXPECT_EQ(improvement["min_after_deg"], made.quality.min_dihedral_deg);
  EXPECT_EQ(improvement["max_after_deg"], made.quality.max_dihedral_deg);
  EXPECT_EQ(improvement["moved_vertices"], 4);
  EXPECT_EQ(improvement["seconds"], 0.25);
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
