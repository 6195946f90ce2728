#include "client/mesh_report.h"

#include <absl/strings/str_format.h>
#include <nlohmann/json.hpp>

namespace tet {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const BoundaryTopology& boundary) {
  return {
      {            "triangles",             boundary.triangles},
      {             "vertices",              boundary.vertices},
      {           "components",            boundary.components},
      { "euler_characteristic",  boundary.euler_characteristic},
      {   "non_manifold_edges",    boundary.non_manifold_edges},
      {"non_manifold_vertices", boundary.non_manifold_vertices}
  };
}

Json json_of(const std::vector<Stage>& stages) {
  Json seconds_of = Json::object();
  for (const Stage& stage : stages) seconds_of[stage.name] = stage.seconds;
  return seconds_of;
}

Json json_of(const Improvement& improvement, const QualityStats& after) {
  return {
      {"min_before_deg", improvement.min_dihedral_before_deg},
      {"max_before_deg", improvement.max_dihedral_before_deg},
      { "min_after_deg",              after.min_dihedral_deg},
      { "max_after_deg",              after.max_dihedral_deg},
      {"moved_vertices",          improvement.moved_vertices},
      {       "seconds",                 improvement.seconds}
  };
}

}  // namespace

std::string summary_line(const std::string& output, const MadeMesh& made, double seconds) {
  return absl::StrFormat(
      "%s: %d vertices, %d tets, dihedral angles %.2f to %.2f degrees, %.2f s", output,
      made.mesh.header.vertex_count, made.mesh.header.tet_count, made.quality.min_dihedral_deg,
      made.quality.max_dihedral_deg, seconds);
}

std::string report_json(const MadeMesh& made,
                        const BoundaryTopology& boundary,
                        double seconds) {
  Json report{
      {          "vertices", made.mesh.header.vertex_count},
      {              "tets",    made.mesh.header.tet_count},
      {  "min_dihedral_deg", made.quality.min_dihedral_deg},
      {  "max_dihedral_deg", made.quality.max_dihedral_deg},
      {            "volume",           made.quality.volume},
      {           "spacing",      made.mesh.header.spacing},
      {            "levels",       made.mesh.header.levels},
      {           "seconds",                       seconds},
      {            "stages",          json_of(made.stages)},
      {          "boundary",             json_of(boundary)},
      {"dihedral_histogram",        made.quality.histogram}
  };
  if (made.improvement) report["improvement"] = json_of(*made.improvement, made.quality);
  return report.dump(2) + "\n";
}

}  // namespace tet
