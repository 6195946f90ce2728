// Quality of a mesh in memory.
#pragma once

#include "core/base/quality.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Measures every tet of a mesh in memory, in parallel; one value for any number of threads.
QualityStats measure_quality(const TetMesh& mesh);

/// Measures the tets of a view, whose edges are about as long as `spacing`, one after another.
QualityStats measure_tets(const MeshView& view, double spacing) noexcept;

}  // namespace tet
