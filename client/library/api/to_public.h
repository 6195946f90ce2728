// Internal types as the public headers have them.
#pragma once

#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "client/library/chunk_supply.h"
#include "core/mesh/tet_mesh.h"
#include "tetstream/mesh.h"
#include "tetstream/status.h"

namespace tetstream {

Status to_public(const absl::Status& status);

MeshHeader to_public(const tet::MeshHeader& header, std::string id);
Statistics to_public(const tet::TrailerFacts& facts);
Chunk to_public(const tet::ChunkView& chunk, const tet::MeshHeader& header);
/// The arrays of a whole mesh, which it holds.
MeshColumns columns_of(const tet::TetMesh& mesh);

}  // namespace tetstream
