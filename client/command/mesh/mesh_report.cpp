#include "client/command/mesh/mesh_report.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_join.h>
#include <absl/strings/str_replace.h>
#include <nlohmann/json.hpp>

#include "client/command/mesh/label_report.h"
#include "client/command/mesh/shape_json.h"
#include "core/mesh/boundary.h"
#include "core/mesh/face_counts.h"
#include "core/mesh/quality.h"
#include "core/mesh/regions.h"
#include "core/mesh/tet_shapes.h"

namespace tet {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const BoundaryTopology& boundary) {
  return {{"triangles", boundary.triangles},
          {"vertices", boundary.vertices},
          {"components", boundary.components},
          {"euler_characteristic", boundary.euler_characteristic},
          {"non_manifold_edges", boundary.non_manifold_edges},
          {"non_manifold_vertices", boundary.non_manifold_vertices}};
}

Json boundary_json(const MadeMesh& made, const MeshRequest& request) {
  Json boundary = json_of(made.boundary ? *made.boundary : measure_inside_boundary(made.mesh));
  if (request.manifold && made.boundary) {
    boundary["restored_nodes"] = made.boundary->restored_nodes;
  }
  return boundary;
}

/// How many faces have each label.
Json faces_json(const TetMesh& mesh) {
  const MeshHeader& header = mesh.header;
  const std::vector<std::uint64_t> counts = count_faces(mesh);
  Json faces = Json::object();
  for (std::size_t i = 0; i < counts.size(); ++i) faces[header.face_labels[i].name] = counts[i];
  return faces;
}

Json region_json(const TetMesh& mesh, MeshRegion region) {
  return {{"tets", count_tets(mesh, region)}, {"volume", measure_volume(mesh, region)}};
}

Json json_of(const WorldPoint& p) { return {p.x, p.y, p.z}; }

Json json_of(const ThinWalls& walls) {
  Json regions = Json::array();
  for (const ThinWalls::Region& region : walls.regions) {
    regions.push_back({{"min", json_of(region.box.min)},
                       {"max", json_of(region.box.max)},
                       {"inside_spots", region.inside},
                       {"outside_spots", region.outside}});
  }
  return {{"inside_spots", walls.inside},       {"outside_spots", walls.outside},
          {"region_count", walls.region_count}, {"regions", std::move(regions)},
          {"thickness", walls.thickness},       {"suggested_spacing", walls.suggested_spacing}};
}

/// What may be wrong with a mesh of a converted surface.
std::vector<std::string> surface_warnings(const MadeMesh& made) {
  std::vector<std::string> warnings = made.surface->warnings();
  if (std::string own = volume_warning(made); !own.empty()) warnings.push_back(std::move(own));
  return warnings;
}

Json surface_json(const MadeMesh& made) {
  const ConversionReport& surface = *made.surface;
  Json json{{"converted_to", name_of(surface.kind)},
            {"voxel", surface.voxel_size},
            {"area", surface.area},
            {"converted_volume", surface.volume},
            {"open_edges", surface.open_edges},
            {"holes", surface.holes},
            {"hole_area", surface.hole_area},
            {"doubled_triangles", surface.doubled_triangles},
            {"turned_triangles", surface.turned_triangles},
            {"turned_bodies", surface.turned_bodies},
            {"overlaps", surface.overlaps},
            {"lost_bodies", surface.lost_bodies},
            {"hidden_walls", surface.hidden_walls},
            {"hidden_gaps", surface.hidden_gaps},
            {"text", surface.text()},
            {"warnings", surface_warnings(made)}};
  if (surface.surface_volume) json["volume"] = *surface.surface_volume;
  return json;
}

Json json_of(const std::vector<Stage>& stages) {
  Json seconds_of = Json::object();
  for (const Stage& stage : stages) seconds_of[stage.name] = stage.seconds;
  return seconds_of;
}

Json json_of(const Improvement& improvement, const QualityStats& after) {
  return {{"min_before_deg", improvement.min_dihedral_before_deg},
          {"max_before_deg", improvement.max_dihedral_before_deg},
          {"min_after_deg", after.min_dihedral_deg},
          {"max_after_deg", after.max_dihedral_deg},
          {"moved_vertices", improvement.moved_vertices},
          {"seconds", improvement.seconds}};
}

std::string tets_of_each_side(const MadeMesh& made) {
  const TetMesh& mesh = made.mesh;
  if (!mesh.header.labels.empty()) {
    const std::size_t labels = mesh.header.labels.size();
    return absl::StrFormat(" of %d label%s", labels, labels == 1 ? "" : "s");
  }
  if (!mesh.header.has_regions) return "";
  const std::uint64_t inside =
      made.is_written ? made.tets_inside : count_tets(mesh, MeshRegion::kInside);
  const bool one_side = inside == 0 || inside == mesh.header.tet_count;
  return absl::StrFormat(" (%d inside, %d outside%s)", inside, mesh.header.tet_count - inside,
                         one_side ? ": the surface does not reach into the box" : "");
}

/// Reports on one part as if there were no other tets.
Json json_of(const MeshPart& part, const TetMesh& mesh) {
  MeshView view = mesh.view();
  view.tets = view.tets.subspan(ChunkSizes(mesh.header, 0, part.first_tet).tets,
                                ChunkSizes(mesh.header, 0, part.tet_count).tets);
  const QualityStats quality = measure_tets(view, part.spacing);
  return {{"name", part.name},
          {"vertices", part.vertex_count},
          {"tets", part.tet_count},
          {"spacing", part.spacing},
          {"levels", part.levels},
          {"volume", quality.volume},
          {"min_dihedral_deg", quality.min_dihedral_deg},
          {"max_dihedral_deg", quality.max_dihedral_deg}};
}

/// The first few.
std::string tets_of_each_part(const TetMesh& mesh) {
  constexpr std::size_t kMost = 8;
  std::vector<std::string> parts;
  for (const MeshPart& part : mesh.header.parts) {
    parts.push_back(absl::StrFormat("%d %s", part.tet_count, part.name));
  }
  if (parts.empty()) return "";
  if (parts.size() > kMost) {
    const std::size_t more = parts.size() - kMost;
    parts.resize(kMost);
    parts.push_back(absl::StrFormat("and of %d more grids", more));
  }
  return absl::StrCat(" (", absl::StrJoin(parts, ", "), ")");
}

/// The first few of the regions that the request names.
std::string faces_of_each_region(const TetMesh& mesh) {
  constexpr std::size_t kMost = 8;
  const std::vector<std::uint64_t> counts = count_faces(mesh);
  std::vector<std::string> regions;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const FaceLabel& label = mesh.header.face_labels[i];
    if (label.kind != FaceKind::kRegion) continue;
    regions.push_back(absl::StrFormat("%d %s", counts[i], label.name));
  }
  if (regions.empty()) return "";
  if (regions.size() > kMost) {
    const std::size_t more = regions.size() - kMost;
    regions.resize(kMost);
    regions.push_back(absl::StrFormat("and of %d more regions", more));
  }
  return absl::StrCat(", faces: ", absl::StrJoin(regions, ", "));
}

/// Tells the angles; empty where they were not measured.
std::string angles_of(const QualityStats& quality) {
  if (quality.empty()) return "";
  return absl::StrFormat(", dihedral angles %.2f to %.2f degrees", quality.min_dihedral_deg,
                         quality.max_dihedral_deg);
}

std::string restored_nodes(const std::optional<BoundaryTopology>& boundary) {
  const std::uint64_t nodes = boundary ? boundary->restored_nodes : 0;
  if (nodes == 0) return "";
  return absl::StrFormat(", %d %s restored", nodes, nodes == 1 ? "node" : "nodes");
}

/// Adds what there is; each part of several grids has its own.
void add_fidelity(const MadeMesh& made, Json& report) {
  if (!made.fidelity_missing.empty()) report["fidelity_missing"] = made.fidelity_missing;
  if (made.fidelity.empty() || !made.mesh.header.parts.empty()) return;
  report["fidelity"] = fidelity_json(made.fidelity.front());
}

}  // namespace

std::string summary_line(const std::string& output, const MadeMesh& made, double seconds) {
  return absl::StrFormat("%s: %d vertices, %d tets%s%s%s%s%s, %.2f s", output,
                         made.mesh.header.vertex_count, made.mesh.header.tet_count,
                         tets_of_each_side(made), tets_of_each_part(made.mesh),
                         angles_of(made.quality), restored_nodes(made.boundary),
                         faces_of_each_region(made.mesh), seconds);
}

std::vector<std::string> face_warnings(const TetMesh& mesh) {
  const auto& [min, max] = mesh.header.bounds;
  std::vector<std::string> warnings;
  for (const std::string& name : empty_face_regions(mesh.header, count_faces(mesh))) {
    warnings.push_back(absl::StrFormat(
        "no face is in region '%s': none meets all its conditions, or earlier regions took "
        "them; the mesh lies between (%g, %g, %g) and (%g, %g, %g)",
        name, min.x, min.y, min.z, max.x, max.y, max.z));
  }
  return warnings;
}

std::string inside_note(const std::string& guess) {
  return "note: " + absl::StrReplaceAll(guess, {{"\n", "\nnote: "}});
}

std::string box_note(const WorldBox& box) {
  const auto& [min, max] = box;
  return absl::StrFormat(
      "note: the box was rounded outward to %g %g %g %g %g %g, whole bricks of 8 spacings",
      min.x, min.y, min.z, max.x, max.y, max.z);
}

std::string thin_walls_warning(const ThinWalls& walls) {
  if (!walls.any()) return "";
  const std::string advice =
      walls.suggested_spacing > 0
          ? absl::StrFormat("a grid sampled and meshed at about %.3g would",
                            walls.suggested_spacing)
          : "no spacing is known that would: they are few, or come down to nothing, as at "
            "sharp "
            "edges and where surfaces touch";
  return absl::StrFormat(
      "warning: the lattice does not resolve %d spots of thin walls and %d of narrow gaps, "
      "in %d region%s; %s",
      walls.inside, walls.outside, walls.region_count, walls.region_count == 1 ? "" : "s",
      advice);
}

std::string volume_warning(const MadeMesh& made) {
  const auto& surface = made.surface;
  if (!surface || !surface->surface_volume || made.quality.empty()) return "";
  if (made.mesh.header.has_regions || made.cuts_inside) return "";
  const double spacing = std::max(surface->voxel_size, made.mesh.header.spacing);
  const double off = std::abs(made.quality.volume - *surface->surface_volume);
  if (off <= surface->volume_tolerance(spacing)) return "";
  return absl::StrFormat(
      "the mesh has a volume of %.6g, and the surface of %.6g: a spacing of %g does not "
      "resolve "
      "it",
      made.quality.volume, *surface->surface_volume, spacing);
}

std::string report_json(const MadeMesh& made, const MeshRequest& request, double seconds) {
  Json report{{"vertices", made.mesh.header.vertex_count},
              {"tets", made.mesh.header.tet_count},
              {"min_dihedral_deg", made.quality.min_dihedral_deg},
              {"max_dihedral_deg", made.quality.max_dihedral_deg},
              {"volume", made.quality.volume},
              {"spacing", made.mesh.header.spacing},
              {"levels", made.mesh.header.levels},
              {"seconds", seconds},
              {"stages", json_of(made.stages)},
              {"boundary", boundary_json(made, request)},
              {"thin_walls", json_of(made.thin_walls)},
              {"dihedral_histogram", made.quality.histogram},
              {"bounds",
               {{"min", json_of(made.mesh.header.bounds.min)},
                {"max", json_of(made.mesh.header.bounds.max)}}},
              {"shapes", shapes_json(measure_shapes(made.mesh))}};
  add_fidelity(made, report);
  if (!made.transport.empty()) report["transport"] = made.transport;
  const std::string& guess = made.mesh.header.inside_guess;
  if (!guess.empty()) report["inside_guess"] = guess;
  if (const auto& box = made.mesh.header.box) {
    report["box"] = {{"min", json_of(box->min)}, {"max", json_of(box->max)}};
  }
  if (!made.mesh.header.labels.empty()) report["labels"] = labels_json(made);
  if (made.mesh.header.has_faces()) report["faces"] = faces_json(made.mesh);
  const std::vector<std::string> warnings = face_warnings(made.mesh);
  if (!warnings.empty()) report["face_warnings"] = warnings;
  if (made.mesh.header.has_regions) {
    report["regions"] = {{"inside", region_json(made.mesh, MeshRegion::kInside)},
                         {"outside", region_json(made.mesh, MeshRegion::kOutside)}};
  }
  for (std::size_t i = 0; i < made.mesh.header.parts.size(); ++i) {
    report["parts"].push_back(json_of(made.mesh.header.parts[i], made.mesh));
    if (i < made.fidelity.size()) {
      report["parts"].back()["fidelity"] = fidelity_json(made.fidelity[i]);
    }
  }
  if (made.surface) report["surface"] = surface_json(made);
  if (made.middles) report["second_order"] = second_order_json(made.mesh, *made.middles);
  if (made.improvement) report["improvement"] = json_of(*made.improvement, made.quality);
  // Names come from files and need not be UTF-8; a terminal may be where it goes.
  return report.dump(2, ' ', true, Json::error_handler_t::replace) + "\n";
}

}  // namespace tet
