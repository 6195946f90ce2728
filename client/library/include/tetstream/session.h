// Meshes that follow their shapes, frame by frame.
#pragma once

#include <cstdint>
#include <memory>

#include "tetstream/export.h"
#include "tetstream/mesh.h"
#include "tetstream/request.h"
#include "tetstream/scene.h"
#include "tetstream/status.h"
#include "tetstream/volume.h"

namespace tetstream {

/// A mesh and the shape that it is of, which may change. Every frame's mesh lies on the lattice
/// of the first and has its origin, so that what did not change keeps its vertices; a server
/// sends only the rest. The same frames make the same bytes here and on a server.
///
/// A frame that cannot be meshed leaves the mesh as it was, and the next may fare better. After
/// any other failure, of the connection for instance, the session is over: begin another.
///
/// Not thread-safe. The options that it began with watch and stop all of it.
class TETSTREAM_API Session {
 public:
  const Mesh& mesh() const noexcept;

  /// The mesh becomes that of another volume, which has the transform, the kind and the
  /// background of the first. It may change as much as there is. Errors: those of the call that
  /// began the session, kInvalidArgument (another kind of volume; a session of a scene),
  /// kFailedPrecondition (the session is over).
  Status update(const Volume& volume);
  /// The mesh becomes that of another scene. Errors: as above.
  Status update(const Scene& scene);

  /// Tets of the last frame that were made here or sent by the server; the others were kept.
  std::uint64_t tets_sent() const noexcept;

  /// Whether it takes no more frames.
  bool is_over() const noexcept;

  /// Tells the server that this was all. Errors: what the session ended with.
  Status end();

  ~Session();
  Session(Session&&) noexcept;
  Session& operator=(Session&&) noexcept;

  struct Impl;
  explicit Session(std::unique_ptr<Impl> impl);

 private:
  std::unique_ptr<Impl> impl_;
};

/// Begins a session in this process, which makes each frame's mesh anew. Errors: those of mesh.
TETSTREAM_API Result<Session> begin_session(const Volume& volume,
                                            const Request& request = {},
                                            const WorkOptions& options = {});
TETSTREAM_API Result<Session> begin_session(const Scene& scene,
                                            const Request& request = {},
                                            const WorkOptions& options = {});

}  // namespace tetstream
