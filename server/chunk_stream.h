// One StreamMesh call: a mesh sent while it is made.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include <absl/status/status.h>
#include <grpcpp/alarm.h>
#include <grpcpp/support/server_callback.h>

#include "server/mesh_engine.h"
#include "server/request.h"

namespace tet {

/// The reactor of one stream: plans, then keeps a few chunks being made on the pool and writes
/// them in order. It never waits: each event (plan made, chunk made, message written, client
/// gone) moves it one step, on whichever thread the event came.
///
/// At most `window` chunks are made and not yet taken by the transport, so a client that reads
/// slowly holds that many buffers and nothing else.
///
/// Lives until gRPC is done with it and the last task that refers to it has run.
class ChunkStream final : public grpc::ServerWriteReactor<v1::MeshEvent>,
                          public std::enable_shared_from_this<ChunkStream> {
 public:
  /// Begins the call; what it returns is for gRPC.
  static grpc::ServerWriteReactor<v1::MeshEvent>* start(
      MeshEngine& engine,
      const grpc::CallbackServerContext& context,
      const v1::StreamMeshRequest& request);

 private:
  /// What is written next.
  enum class Phase { kPlanning, kHeader, kChunks, kTrailer, kEnded };
  enum class Step { kWait, kWrite, kFinish };

  /// A chunk being made (`ready` is false) or waiting to be written. Its buffers are reused.
  struct Slot {
    v1::MeshEvent event;
    QualityStats quality;
    bool ready = false;
  };

  ChunkStream(MeshEngine& engine, const grpc::CallbackServerContext& context);

  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

  void begin(const v1::StreamMeshRequest& request);
  void watch_progress();
  void report_progress();
  void begin_chunks(absl::StatusOr<PlannedMesh> planned);
  absl::Status check_range();
  void post_chunks();
  void make_chunk(std::uint64_t index);
  void fill(std::uint64_t index, Slot& slot);

  void advance();
  Step next_step();
  const v1::MeshEvent* next_event();
  void after_write();
  void after_chunk();
  void end(const absl::Status& status);

  Slot& slot_of(std::uint64_t index) { return slots_[index % slots_.size()]; }

  MeshEngine& engine_;
  Call call_;
  std::shared_ptr<PlanningWatch> watch_;
  std::shared_ptr<ChunkStream> self_;  ///< until gRPC is done

  std::mutex mutex_;  ///< guards all below
  std::unique_ptr<grpc::Alarm> progress_timer_;
  MeshTicket ticket_;
  StreamOrder order_;
  PlannedMesh planned_;
  Phase phase_ = Phase::kPlanning;
  Phase written_ = Phase::kPlanning;  ///< phase of the message being written
  bool writing_ = false;
  bool finished_ = false;
  bool progress_due_ = false;
  absl::Status status_;    ///< how the call ends
  v1::MeshEvent control_;  ///< the header, progress or trailer being written
  const v1::MeshEvent* outgoing_ = nullptr;
  std::vector<Slot> slots_;   ///< chunk i in slot i % size
  std::uint64_t next_ = 0;    ///< chunk to be written next
  std::uint64_t posted_ = 0;  ///< chunk to be posted next
  std::uint64_t end_ = 0;     ///< one past the last chunk
  QualityStats quality_;      ///< of the chunks written, in their order
  std::int64_t tets_written_ = 0;
  std::uint64_t bytes_written_ = 0;
};

}  // namespace tet
