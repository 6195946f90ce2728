// What a finished mesh is like: a line for people, JSON for programs.
#pragma once

#include <string>
#include <vector>

#include "client/command/mesh/mesh_maker.h"
#include "core/plan/mesh_request.h"

namespace tet {

/// "out.vtu: 1234 vertices, 5678 tets, dihedral angles 11.4 to 154.2 degrees, 0.5 s"; with the
/// tets of each side where both are meshed (and, where one has none, why), or of each grid of
/// several, the nodes restored for a manifold if there are any, and the faces of each region
/// that the request names. No angles where none were measured.
std::string summary_line(const std::string& output, const MadeMesh& made, double seconds);

/// What to tell of walls that the lattice cannot resolve, in one line; empty without any.
/// Notes of a header's guess of the inside.
std::string inside_note(const std::string& guess);

/// Says where a request's box was rounded to.
std::string box_note(const WorldBox& box);

std::string thin_walls_warning(const ThinWalls& walls);

/// Says of each region of the request that no face is in it.
std::vector<std::string> face_warnings(const TetMesh& mesh);

/// What to tell of a mesh whose volume is not that of the surface which was converted for it,
/// beyond what the spacing explains; empty where it is, or where they cannot be compared.
std::string volume_warning(const MadeMesh& made);

/// The text of `--report`. Stable keys: vertices, tets, min_dihedral_deg, max_dihedral_deg,
/// dihedral_histogram (180 counts, one a degree), volume, seconds, stages, transport (of a
/// server's meshes: how chunks came, as messages or in shared_memory), boundary (of the
/// inside; restored_nodes where a manifold was asked for and the box cuts no surface), of
/// meshes of both sides regions (inside and outside: tets, volume), of several
/// grids parts (of each name, vertices, tets, spacing, levels, volume, min_dihedral_deg and
/// max_dihedral_deg), and of improved ones
/// improvement (min_before_deg, max_before_deg, min_after_deg, max_after_deg, moved_vertices,
/// seconds), and thin_walls (inside_spots, outside_spots, region_count, regions, thickness,
/// suggested_spacing), bounds (min, max), shapes, fidelity and second_order (see shape_json.h;
/// of several grids each part's, and fidelity_missing where it could not be measured), and of
/// converted surfaces surface (converted_to, voxel, area, volume of the surface where it has
/// one, converted_volume, text, warnings, and counts of all that was found); and of meshes with
/// faces faces (how many have each name), and face_warnings where a region has none.
///
/// Measures what was not counted with the mesh.
std::string report_json(const MadeMesh& made, const MeshRequest& request, double seconds);

}  // namespace tet
