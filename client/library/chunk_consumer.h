// Whoever wants a mesh's chunks: the whole mesh in memory, or somebody who takes one at a time.
#pragma once

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/mesh/stable/splice.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// What a StreamReader asks of whom it reads for. An error ends the stream.
class ChunkConsumer {
 public:
  virtual ~ChunkConsumer() = default;

  /// Makes room for a mesh, before its first chunk. `kept` says what the mesh has in common
  /// with the base that was asked for, and is null where all of it comes. Asked once more where
  /// all has to come anew.
  virtual absl::Status make_room(const MeshHeader& header, const KeptParts* kept) = 0;

  /// Where a chunk's columns are to be written, in exactly their sizes. A chunk that turns out
  /// to be damaged may come again.
  virtual absl::StatusOr<ChunkColumns> place(const ChunkExtent& chunk) = 0;

  /// The chunk lies in its place, and has been checked.
  virtual absl::Status take(const ChunkExtent& chunk) = 0;
};

}  // namespace tet
