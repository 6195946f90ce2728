// A mesh that follows its shape: each change brings only what is new.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "client/library/connection.h"
#include "client/library/mesh_client.h"
#include "client/library/shared_chunks_pool.h"
#include "core/base/cancel.h"
#include "core/mesh/stable/stable_mesh.h"

namespace tet {

class RawCall;

/// Which ids a session's vertices and tets have.
enum class SessionIds : bool {
  kInOrder,  ///< those of the mesh as it is made as a whole: where one is new, others shift
  kStable,   ///< what is kept keeps its id, and a frame is patched in place: see StableMesh
};

/// One session, with one server. Not thread-safe. A frame that the server refuses leaves the
/// mesh as it was, and the session alive; after any other error, or exception, it is over:
/// begin another.
class RemeshSession {
 public:
  /// Receives the mesh of `request`; begins again where the connection breaks before it has
  /// come. `cancellation` outlives the session. Errors: the server's, kUnavailable (after all
  /// retries), kDataLoss (a stream that is none), kCancelled, kDeadlineExceeded.
  static absl::StatusOr<std::unique_ptr<RemeshSession>> begin(
      const std::shared_ptr<Connection>& connection,
      const v1::MeshRequest& request,
      const Cancellation& cancellation,
      SessionIds ids = SessionIds::kInOrder);
  ~RemeshSession();

  /// The mesh becomes that of another scene, or of a grid with these leaves. Where parts of it
  /// were kept, `quality` is that of the rest alone. Leaves that are more than one message may
  /// have go in several. Errors: as above.
  absl::Status update(const v1::Scene& scene);
  absl::Status update(const std::vector<v1::LeafUpdate>& leaves);

  /// The mesh, and what was told of it. With stable ids it has no columns.
  const StreamedMesh& mesh() const noexcept { return mesh_; }
  /// The columns by stable ids, which StableMesh::in_order brings into their order; else
  /// null. An error that ends the session leaves them half patched, and of no use.
  const StableMesh* stable() const noexcept { return stable_.get(); }
  /// Whether it takes no more frames.
  bool is_over() const noexcept { return ended_; }
  /// Tets of the last change that were sent, and not kept.
  std::uint64_t tets_sent() const noexcept { return tets_sent_; }

  /// Tells the server that this was all. Errors: what the session ended with.
  absl::Status end();

 private:
  RemeshSession(std::shared_ptr<Connection> connection,
                const ServerChannel& server,
                const Cancellation& cancellation,
                SessionIds ids);

  absl::Status send(const v1::RemeshRequest& message);
  absl::Status exchange(const v1::RemeshRequest& message);
  absl::Status take_frame(const v1::RemeshRequest& message);
  absl::Status patch();
  template <class Receiver>
  absl::Status receive(Receiver& receiver);
  absl::Status give_up(absl::Status why);
  absl::Status broken();

  const std::shared_ptr<Connection> connection_;  // first: the others use it
  const Cancellation& cancellation_;
  const std::string shared_memory_path_;  ///< of the server
  const PooledSharedChunks shared_;
  ClientCall call_;
  std::unique_ptr<RawCall> stream_;
  bool ended_ = false;
  StreamedMesh mesh_;
  TetMesh used_;  ///< the mesh before it: memory for the next
  std::unique_ptr<StableMesh> stable_;
  std::uint64_t tets_sent_ = 0;
};

}  // namespace tet
