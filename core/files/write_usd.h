// Universal Scene Description as text (.usda): a TetMesh with subsets.
#pragma once

#include "core/files/block_writer.h"
#include "core/files/file_names.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Names of prims and of primvars.
inline constexpr NameRule kUsdNames{.most_bytes = 80};

/// Writes points (float32, relative to a translation in doubles, so that a mesh far from zero
/// keeps its digits), tets, the boundary's faces, a GeomSubset of tets for each region or part
/// and one of faces for each of their labels, and fields as primvars. `file` is left for the
/// caller to commit. Errors: kFailedPrecondition (more vertices or tets than int32 counts).
absl::Status write_usd(AtomicFile& file, const TetMesh& mesh, const WriteControl& control);

}  // namespace tet
