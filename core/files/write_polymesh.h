// OpenFOAM's polyMesh: a folder of files.
#pragma once

#include <array>
#include <string_view>

#include "core/base/posix/atomic_folder.h"
#include "core/files/block_writer.h"
#include "core/files/file_names.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Words of OpenFOAM's dictionaries.
inline constexpr NameRule kFoamNames{.most_bytes = 80};

/// What a folder may hold that is written, or replaced by one.
inline constexpr std::array<std::string_view, 8> kPolyMeshFiles{
    "points",   "faces",     "owner",     "neighbour",
    "boundary", "cellZones", "faceZones", "pointZones"};

/// Writes points, faces (those between two tets first, by owner and then neighbour), and who
/// they are of, in binary; a patch for each label of faces; zones of cells for regions and
/// parts, and of faces for the interface of both sides, which is within the mesh. Cells are
/// numbered as the mesh's tets. `folder` is left for the caller to commit.
///
/// Errors: kFailedPrecondition (more corners of faces than a label of 32 bits counts).
absl::Status write_polymesh(const AtomicFolder& folder,
                            const TetMesh& mesh,
                            const WriteControl& control);

}  // namespace tet
