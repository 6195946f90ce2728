// The boundary of a mesh as triangles: STL, PLY and OBJ.
#pragma once

#include <array>
#include <string_view>

#include "core/files/block_writer.h"
#include "core/files/file_names.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// What PLY calls properties and OBJ groups has no spaces.
inline constexpr std::array<std::string_view, 3> kPlyOwnNames{"x", "y", "z"};
inline constexpr NameRule kPlyNames{.most_bytes = 80, .taken = kPlyOwnNames};  ///< of fields
inline constexpr NameRule kObjNames{.most_bytes = 80};

/// Binary, with normals. It has no names and no vertices, only triangles of float32
/// coordinates. Errors: kFailedPrecondition (more triangles than uint32 counts).
absl::Status write_stl(AtomicFile& file, const TetMesh& mesh, const WriteControl& control);

/// Binary, little-endian. Each face has a `label`, whose names are comments; fields are
/// properties of vertices, a vector three of them. Errors: kFailedPrecondition (more vertices
/// than int32 counts).
absl::Status write_ply(AtomicFile& file, const TetMesh& mesh, const WriteControl& control);

/// Text, with a group for each label.
absl::Status write_obj(AtomicFile& file, const TetMesh& mesh, const WriteControl& control);

}  // namespace tet
