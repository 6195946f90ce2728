#include "client/command/report/report_page.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "client/command/mesh/mesh_report.h"
#include "client/command/report/report_charts.h"
#include "tests/core/mesh/small_meshes.h"

namespace tet {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string cube_report() {
  MadeMesh made{.mesh = kuhn_mesh(1),
                .quality = {},
                .boundary = {},
                .improvement = {},
                .thin_walls = {},
                .stages = {}};
  made.quality = measure_quality(made.mesh);
  made.fidelity.push_back(
      {.spacing = 0.5,
       .to_surface = {.max = 0.25, .rms = 0.125, .at = {1, 1, 1}, .samples = 7},
       .from_surface = {.max = 0.5, .rms = 0.0625, .at = {}, .samples = 9},
       .mesh_area = 6,
       .surface_area = 6,
       .mesh_volume = 1,
       .enclosed_volume = 1.25});
  return report_json(made, {}, 1);
}

TEST(MeshReport, TellsShapesAndFidelity) {
  const auto report = nlohmann::json::parse(cube_report());
  const auto& shapes = report["shapes"];
  EXPECT_EQ(shapes["not_positive"], 0);
  EXPECT_EQ(shapes["scaled_jacobian"]["histogram"].size(), 50U);
  EXPECT_EQ(shapes["edge_lengths"]["histogram"].size(), 64U);
  EXPECT_EQ(shapes["worst"].size(), 6U);
  const auto& fidelity = report["fidelity"];
  EXPECT_EQ(fidelity["mesh_to_surface"]["max"], 0.25);
  EXPECT_EQ(fidelity["mesh_to_surface"]["rms_spacings"], 0.25);
  EXPECT_EQ(fidelity["surface_to_mesh"]["samples"], 9);
  EXPECT_EQ(fidelity["hausdorff"], 0.5);
  EXPECT_EQ(fidelity["hausdorff_spacings"], 1);
  EXPECT_EQ(fidelity["volume_error"], -0.2);
}

TEST(ReportPage, DrawsWhatTheReportHas) {
  const auto page = report_page(cube_report(), "a cube");
  ASSERT_TRUE(page.ok()) << page.status();
  for (const char* part : {"<h1>a cube</h1>", "Dihedral angles", "Scaled Jacobian",
                           "Radius ratio", "Edge ratio", "Sizes", "How true the surface is",
                           "Where the worst tets are", "0.5 (1 spacings)", "-20 %"}) {
    EXPECT_THAT(*page, HasSubstr(part));
  }
  EXPECT_THAT(*page, Not(HasSubstr("http"))) << "it needs nothing else";
  EXPECT_THAT(*page, Not(HasSubstr("<script")));
}

TEST(ReportPage, LeavesOutWhatAnOlderReportLacks) {
  const auto page = report_page(R"({"vertices": 4, "tets": 1})", "old");
  ASSERT_TRUE(page.ok()) << page.status();
  EXPECT_THAT(*page, Not(HasSubstr("Radius ratio")));
}

TEST(ReportPage, RefusesWhatIsNoReport) {
  for (const char* text : {"", "{", "[]", "3", R"({"vertices": 4})",
                           R"({"vertices": "4", "tets": 1})", "\xff\xfe"}) {
    EXPECT_EQ(report_page(text, "no").status().code(), absl::StatusCode::kInvalidArgument)
        << text;
  }
}

TEST(ReportPage, TakesNoValueForAnotherKind) {
  const char* const text = R"({"vertices": 4, "tets": 1, "dihedral_histogram": [1, "x"],
      "bounds": {"min": [0, 0], "max": 7}, "parts": [3, {"name": 5, "fidelity": []}],
      "shapes": {"scaled_jacobian": {"histogram": {}, "min": []}, "worst": [1, {"at": "x"}],
      "edge_lengths": {"histogram": [0, 0], "first_bin_spacings": -1, "bins_per_octave": 0}},
      "fidelity": {"hausdorff": "<b>"}, "fidelity_missing": 9})";
  const auto page = report_page(text, "odd");
  ASSERT_TRUE(page.ok()) << page.status();
  EXPECT_THAT(*page, Not(HasSubstr("<b>")));
}

TEST(ReportPage, EscapesForeignText) {
  const char* const text = R"({"vertices": 4, "tets": 1, "fidelity_missing": "<script>&\"",
      "parts": [{"name": "<i>", "fidelity": {"mesh_area": 2}}]})";
  const auto page = report_page(text, "</title><script>");
  ASSERT_TRUE(page.ok()) << page.status();
  EXPECT_THAT(*page, Not(HasSubstr("<script")));
  EXPECT_THAT(*page, Not(HasSubstr("<i>")));
  EXPECT_THAT(*page, HasSubstr("&lt;script&gt;&amp;&quot;"));
}

TEST(BarChart, DrawsAFewThatNobodyWouldSeeBesideMany) {
  const std::string bars = draw_bars({.counts = {1, 0, 1e9}});
  EXPECT_THAT(bars, HasSubstr("height=\"2.00\""));
  EXPECT_EQ(draw_bars({.counts = {}}), "");
}

}  // namespace
}  // namespace tet
