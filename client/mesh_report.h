// What a finished mesh is like: a line for people, JSON for programs.
#pragma once

#include <string>
#include <vector>

#include "client/mesh_maker.h"
#include "core/mesh/boundary.h"

namespace tet {

/// "out.vtu: 1234 vertices, 5678 tets, dihedral angles 11.4 to 154.2 degrees, 0.5 s".
std::string summary_line(const std::string& output, const MadeMesh& made, double seconds);

/// The text of `--report`. Stable keys: vertices, tets, min_dihedral_deg, max_dihedral_deg,
/// dihedral_histogram (180 counts, one a degree), volume, seconds, stages, boundary; and
/// improvement (min_before_deg, max_before_deg, min_after_deg, max_after_deg, moved_vertices,
/// seconds) of a mesh that was improved.
std::string report_json(const MadeMesh& made, const BoundaryTopology& boundary, double seconds);

}  // namespace tet
