// A mesh chunk by chunk, as fast as somebody takes them.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

#include "tetstream/export.h"
#include "tetstream/mesh.h"
#include "tetstream/status.h"

namespace tetstream {

/// Some of a mesh's chunks, which several readers may share out among them. The header that
/// comes with them is that of the whole mesh, and no statistics come.
struct ChunkRange {
  std::uint64_t first = 0;                ///< at most the header's chunk_count
  std::optional<std::uint64_t> end = {};  ///< one past the last; all that follow unless given

  bool is_all() const noexcept { return first == 0 && !end; }
};

/// A mesh that is made while it is read: the header, then chunks, then statistics.
///
///   while (const Chunk* chunk = stream.next()) use(*chunk);
///   if (const auto end = stream.finish(); !end.ok()) complain(end.status());
///
/// Whoever does not ask for the next chunk holds the work back: a server makes no more chunks
/// than its stream's buffers hold, and this process makes a few ahead. A connection that breaks
/// is taken up where it broke, and no chunk comes twice. Not thread-safe, but may be moved to
/// another thread between two calls. The volume, request and client that it comes from need not
/// outlive it.
class TETSTREAM_API MeshStream {
 public:
  /// Waits until the mesh is counted. Errors: those of the call that made the stream.
  Result<MeshHeader> header();

  /// The next chunk, which lives until the next call of this or until the stream ends, unless
  /// it is kept; null after the last, and after a failure. In a compact stream the first chunk
  /// comes when all that a server sends of the mesh has come, and the whole mesh is held here.
  const Chunk* next();

  /// Keeps the chunk that `next` gave last: its spans live, with what they hold, as long as a
  /// copy of the result does, and the stream takes other memory for the chunks that follow.
  /// Keep chunks of a compact stream to read only: all are parts of one mesh. Null before the
  /// first chunk.
  std::shared_ptr<const void> keep_chunk() const noexcept;

  /// What is told of the mesh, once `next` has returned null after the last chunk; or the
  /// failure that ended the stream. kFailedPrecondition while there are chunks to come.
  Result<Statistics> finish();

  /// Ends the work, here or on the server, unless it has ended.
  ~MeshStream();
  MeshStream(MeshStream&&) noexcept;
  MeshStream& operator=(MeshStream&&) noexcept;

  struct Impl;
  explicit MeshStream(std::unique_ptr<Impl> impl);

 private:
  std::unique_ptr<Impl> impl_;
};

/// Takes a mesh piece by piece; each member may be left out. One that returns false stops the
/// stream, which then ends with kCancelled. Called on the thread that called, one after the
/// other: a slow one holds the work back.
struct MeshSink {
  std::function<bool(const MeshHeader& header)> header = {};
  std::function<bool(const Chunk& chunk)> chunk = {};
  std::function<void(const Statistics& statistics)> statistics = {};
};

/// Gives all of a stream to a sink. kOk only where the whole mesh has come.
TETSTREAM_API Status drain(MeshStream stream, const MeshSink& sink);

}  // namespace tetstream
