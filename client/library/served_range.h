// Some of a mesh's chunks, as a server sends them.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "client/library/chunk_supply.h"
#include "client/library/connection.h"
#include "client/library/event_stream.h"
#include "client/library/part_receiver.h"
#include "core/base/cancel.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

/// What is asked for.
struct RangeCall {
  std::string service, method;  ///< that answers with MeshEvents
  /// The message for chunks [first, end) of the mesh of this id, which is empty at first; an
  /// end of 0 is the mesh's.
  std::function<grpc::ByteBuffer(
      std::uint64_t first, std::uint64_t end, const std::string& mesh_id)>
      request;
  std::uint64_t first = 0;
  std::optional<std::uint64_t> end = {};
};

/// Holds one chunk at a time, whose place within the mesh nobody knew before. Several of these
/// share a mesh out among them. No facts are told.
class ServedRange : public ChunkSupply {
 public:
  /// `cancellation` outlives this, and `progress` may be null.
  ServedRange(std::shared_ptr<Connection> connection,
              RangeCall call,
              ClientProgress progress,
              const Cancellation& cancellation);

  absl::StatusOr<const MeshHeader*> header() override;
  std::string mesh_id() const override { return mesh_id_; }
  absl::StatusOr<const ChunkView*> next() override;
  std::shared_ptr<const TetMesh> keep() const override {
    return receiver_ ? receiver_->kept() : nullptr;
  }
  const TrailerFacts& facts() const override { return facts_; }

 private:
  StreamCall stream_call();
  absl::StatusOr<bool> step();
  absl::Status take(grpc::ByteBuffer& event);
  absl::Status begin(const v1::MeshHeader& message);
  absl::Status show(const TetMesh& part, const ChunkExtent& place);
  std::uint64_t next_chunk() const { return receiver_ ? receiver_->next_chunk() : call_.first; }

  const std::shared_ptr<Connection> connection_;
  const RangeCall call_;
  const ClientProgress progress_;
  MeshHeader header_;
  std::string mesh_id_;
  std::optional<PartReceiver> receiver_;  ///< once there is a header
  ChunkView chunk_;
  bool has_chunk_ = false;  ///< that nobody has been given yet
  std::uint64_t tets_ = 0;
  const TrailerFacts facts_;
  absl::Status failure_;
  EventStream events_;  // last: it uses the others
};

}  // namespace tet
