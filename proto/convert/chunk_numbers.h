// The numbers of a chunk as a message, and back.
#pragma once

#include <array>
#include <string_view>

#include "core/mesh/tet_mesh.h"
#include "proto/wire/chunk_frame.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

/// Negative numbers become huge ones, which whoever places the chunk refuses.
ChunkNumbers from_proto(const v1::MeshChunk& message);

/// Where the chunk that the numbers are of lies in the mesh.
ChunkExtent extent_of(const ChunkNumbers& numbers) noexcept;

/// The columns of a chunk that has come whole, in the order in which they are sent.
std::array<std::string_view, kMeshColumns> columns_of(const v1::MeshChunk& message);

/// Leaves what the chunk holds as it is.
void to_proto(const ChunkNumbers& numbers, v1::MeshChunk& message);

}  // namespace tet
