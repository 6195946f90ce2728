// One StreamMesh call: a mesh sent while it is made.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include <absl/status/status.h>
#include <grpcpp/alarm.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include "server/chunk_maker.h"
#include "server/mesh_engine.h"
#include "server/request.h"

namespace tet {

/// The reactor of one stream: plans, then keeps a few chunks being made on the pool and writes
/// them in order. It never waits: each event (plan made, chunk made, message written, client
/// gone) moves it one step, on whichever thread the event came.
///
/// At most `window` chunks are made and not yet taken by the transport, each in a
/// block of the send budget, so a client that reads slowly holds that many blocks and nothing
/// else. A client that reads nothing for too long loses its stream.
///
/// Lives until gRPC is done with it and the last task that refers to it has run.
class ChunkStream final : public grpc::ServerWriteReactor<grpc::ByteBuffer>,
                          public Stallable,
                          public std::enable_shared_from_this<ChunkStream> {
 public:
  /// Begins the call; what it returns is for gRPC.
  static grpc::ServerWriteReactor<grpc::ByteBuffer>* start(MeshEngine& engine,
                                                           grpc::CallbackServerContext& context,
                                                           const grpc::ByteBuffer& request);

 private:
  /// What is written next.
  enum class Phase { kPlanning, kHeader, kChunks, kTrailer, kEnded };
  enum class Step { kWait, kWrite, kFinish };

  /// A chunk being made (`ready` is false) or waiting to be written.
  struct Slot {
    ChunkMessage made;
    bool ready = false;
  };

  ChunkStream(MeshEngine& engine, grpc::CallbackServerContext& context);

  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;
  std::optional<Stallable::Clock::time_point> waiting_since() override;
  void give_up(std::chrono::seconds waited) override;

  void begin(const grpc::ByteBuffer& request);
  void plan(absl::StatusOr<Ticket> ticket);
  void watch_progress();
  void report_progress();
  void plan_base(absl::StatusOr<PlannedMesh> planned);
  void find_patches(const absl::StatusOr<PlannedMesh>& base);
  void begin_chunks(const absl::Status& planned);
  void note_plan();
  absl::Status check_range();
  std::uint64_t window() const;
  void post_chunks();
  void ask_for_block(std::uint64_t index);
  using Block = std::shared_ptr<SendBudget::Lease>;
  void fill_slot(std::uint64_t index, Block block);

  void advance();
  void make_room();
  Step next_step();
  bool prepare_message();
  void after_write();
  void after_chunk();
  void end(const absl::Status& status);
  void cut();

  Slot& slot_of(std::uint64_t index) { return slots_[index % slots_.size()]; }

  MeshEngine& engine_;
  grpc::CallbackServerContext& context_;  ///< there until gRPC is done
  Call call_;
  std::shared_ptr<PlanningWatch> watch_;
  std::shared_ptr<ChunkStream> self_;  ///< until gRPC is done
  Admission::Place place_ = 0;         ///< in the queue; 0: in none

  std::mutex mutex_;  ///< guards all below
  std::unique_ptr<grpc::Alarm> progress_timer_;
  Ticket ticket_;
  StreamOrder order_;
  PlannedMesh planned_;
  ChunkSource source_;  ///< with a patch where parts of the client's mesh are kept
  Phase phase_ = Phase::kPlanning;
  Phase written_ = Phase::kPlanning;  ///< phase of the message being written
  bool writing_ = false;
  Stallable::Clock::time_point write_start_{};
  bool cancelling_ = false;  ///< the call may not finish now
  bool finished_ = false;
  bool progress_due_ = false;
  absl::Status status_;        ///< how the call ends
  grpc::ByteBuffer outgoing_;  ///< the MeshEvent being written
  std::vector<Slot> slots_;    ///< chunk i in slot i % size
  std::uint64_t next_ = 0;     ///< chunk to be written next
  std::uint64_t posted_ = 0;   ///< chunk to be posted next
  std::uint64_t end_ = 0;      ///< one past the last chunk
  QualityStats quality_;       ///< of the chunks written, in their order
  std::uint64_t tets_written_ = 0, bytes_written_ = 0;
};

}  // namespace tet
