#include "client/mesh_report.h"

#include <utility>

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

Json json_of(const WorldPoint& p) { return {p.x, p.y, p.z}; }

Json json_of(const ThinWalls& walls) {
  Json regions = Json::array();
  for (const ThinWalls::Region& region : walls.regions) {
    regions.push_back({
        {          "min", json_of(region.box.min)},
        {          "max", json_of(region.box.max)},
        { "inside_spots",           region.inside},
        {"outside_spots",          region.outside}
    });
  }
  return {
      {     "inside_spots",            walls.inside},
      {    "outside_spots",           walls.outside},
      {     "region_count",      walls.region_count},
      {          "regions",      std::move(regions)},
      {        "thickness",         walls.thickness},
      {"suggested_spacing", walls.suggested_spacing}
  };
}

Json json_of(const std::vector<Stage>& stages) {
  Json seconds_of = Json::object();
  for (const Stage& stage : stages) seconds_of[stage.name] = stage.seconds;
  return seconds_of;
}

}  // namespace

std::string summary_line(const std::string& output, const MadeMesh& made, double seconds) {
  return absl::StrFormat(
      "%s: %d vertices, %d tets, dihedral angles %.2f to %.2f degrees, %.2f s", output,
      made.mesh.header.vertex_count, made.mesh.header.tet_count, made.quality.min_dihedral_deg,
      made.quality.max_dihedral_deg, seconds);
}

std::string thin_walls_warning(const ThinWalls& walls) {
  if (!walls.any()) return "";
  return absl::StrFormat(
      "warning: the lattice does not resolve %d spots of thin walls and %d of narrow gaps, "
      "in %d region%s; a grid sampled and meshed at about %.3g would",
      walls.inside, walls.outside, walls.region_count, walls.region_count == 1 ? "" : "s",
      walls.suggested_spacing);
}

std::string report_json(const MadeMesh& made,
                        const BoundaryTopology& boundary,
                        double seconds) {
  const Json report{
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
      {        "thin_walls",      json_of(made.thin_walls)},
      {"dihedral_histogram",        made.quality.histogram}
  };
  return report.dump(2) + "\n";
}

}  // namespace tet
