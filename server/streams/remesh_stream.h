// One RemeshSession call: a mesh that follows its shape, frame by frame.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/plan/brick/kept_bricks.h"
#include "server/meshing/shared_chunk.h"
#include "server/streams/call_charge.h"
#include "server/streams/chunk_stream.h"
#include "server/streams/frame_leaves.h"

namespace tet {

/// Each frame is read, planned from the plan before it, and sent as what differs from it; then
/// the next is read. While it waits for one it holds no turn to mesh. A frame that cannot be
/// planned leaves everything as it was.
class RemeshStream final : public ChunkStream {
 public:
  using Reactor = grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>;

  /// Begins the call; what it returns is for gRPC.
  static Reactor* start(MeshEngine& engine, grpc::CallbackServerContext& context);

  /// gRPC has read a message; or there is none.
  void read_done(bool ok);

 private:
  class Reads;

  RemeshStream(MeshEngine& engine, grpc::CallbackServerContext& context)
      : ChunkStream(engine, context, "RemeshSession") {}

  void await() override { read(); }
  void open() override;
  void note_opening() override;
  std::uint64_t chunk_count() const override { return source_.chunk_count(); }
  absl::Status check_shareable() const override { return check_not_read_back(source_); }
  v1::MeshEvent header() const override;
  absl::StatusOr<ChunkMessage> make(std::uint64_t index, Block block) override;
  v1::MeshEvent trailer(std::uint64_t first,
                        std::uint64_t end,
                        const QualityStats& quality) const override;
  std::optional<v1::MeshEvent> refuse(const absl::Status& why) override;
  void sent_all() override;
  std::optional<Wait> wait(std::chrono::seconds limit) override;
  void give_up(std::chrono::seconds waited) override;

  void read();
  void take_message();
  absl::Status why_unfinished() const;
  absl::Status check_order(const v1::RemeshRequest& message) const;
  absl::Status take_start(const v1::RemeshRequest& message);
  absl::Status take_start(const v1::MeshRequest& request);
  void take_part(const v1::RemeshFrame& part);
  absl::Status take_frame(const v1::RemeshFrame& frame);
  absl::Status take_scene(const v1::Scene& scene);
  std::shared_ptr<CallCharge> no_charge();
  absl::Status gather_leaves(const v1::RemeshFrame& message);
  absl::Status replace();
  std::shared_ptr<const Volume> hold(Volume volume, std::shared_ptr<CallCharge> charge);
  void begin_frame();
  void planned(absl::StatusOr<PlannedMesh> planned);

  std::shared_ptr<RemeshStream> self() {
    return std::static_pointer_cast<RemeshStream>(shared_from_this());
  }

  Reads* reads_ = nullptr;             ///< there until the call is finished
  grpc::ByteBuffer incoming_message_;  ///< being read
  /// A part was read, and not yet its frame.
  std::atomic<bool> in_frame_{false};
  std::mutex read_mutex_;
  std::optional<Stallable::Clock::time_point> read_start_;  ///< while a message is awaited

  /// What a frame's mesh is made of.
  struct Frame {
    v1::MeshRequest request;
    MeshOrder order;
  };

  // Whoever has the frame touches these: from the message that was read to its last chunk.
  bool started_ = false, tells_refusals_ = false;
  PatchDetail detail_ = PatchDetail::kBricks;  ///< kSlices for clients who know loose patches
  std::int64_t frames_ = 0;
  std::optional<FrameLeaves> incoming_;  ///< of the frame that is read, if it has any
  absl::Status incoming_status_;         ///< why that frame is refused
  /// Bricks of the grid that it replaces; null where it does not.
  std::shared_ptr<const std::vector<BrickCoord>> replaced_;
  Frame next_;   ///< becomes that of the mesh, once it is planned
  Frame shown_;  ///< of the mesh that the client has
  PlannedMesh planned_;
  ChunkSource source_;
};

}  // namespace tet
