// A mesh that follows its shape: each change brings only what is new.
#pragma once

#include <memory>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "client/library/connection.h"
#include "client/library/mesh_client.h"
#include "core/base/cancel.h"

namespace tet {

class MeshReceiver;
class RawCall;

/// One session, with one server. Not thread-safe. A frame that the server refuses leaves the
/// mesh as it was, and the session alive; after any other error it is over: begin another.
class RemeshSession {
 public:
  /// Receives the mesh of `request`. Both `connection` and `cancellation` outlive the session.
  /// Errors: the server's, kDataLoss (a stream that is none), kCancelled, kDeadlineExceeded.
  static absl::StatusOr<std::unique_ptr<RemeshSession>> begin(Connection& connection,
                                                              const v1::MeshRequest& request,
                                                              const Cancellation& cancellation);
  ~RemeshSession();

  /// The mesh becomes that of another scene, or of a grid with these leaves. Where parts of it
  /// were kept, `quality` is that of the rest alone. Leaves that are more than one message may
  /// have go in several. Errors: as above.
  absl::Status update(const v1::Scene& scene);
  absl::Status update(const std::vector<v1::LeafUpdate>& leaves);

  const StreamedMesh& mesh() const noexcept { return mesh_; }
  /// Whether it takes no more frames.
  bool is_over() const noexcept { return ended_; }
  /// Tets of the last change that were sent, and not kept.
  std::uint64_t tets_sent() const noexcept { return tets_sent_; }

  /// Tells the server that this was all. Errors: what the session ended with.
  absl::Status end();

 private:
  RemeshSession(Connection& connection, const Cancellation& cancellation);

  absl::Status send(const v1::RemeshRequest& message);
  absl::Status exchange(const v1::RemeshRequest& message);
  absl::Status receive(MeshReceiver& receiver);
  absl::Status give_up(absl::Status why);
  absl::Status broken();

  const Cancellation& cancellation_;
  ClientCall call_;
  std::unique_ptr<RawCall> stream_;
  bool ended_ = false;
  StreamedMesh mesh_;
  TetMesh used_;  ///< the mesh before it: memory for the next
  std::uint64_t tets_sent_ = 0;
};

}  // namespace tet
