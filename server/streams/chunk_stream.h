// A call that sends a mesh's chunks in order, whatever they come from.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <grpcpp/alarm.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include "proto/convert/request.h"
#include "server/meshing/chunk_maker.h"
#include "server/rpc/stream_writer.h"
#include "server/shared_memory/chunk_ring.h"
#include "server/streams/mesh_engine.h"
#include "server/streams/mesher_turn.h"
#include "server/streams/stream_ring.h"

namespace tet {

class ChunkStream;

/// gRPC's side of a stream of chunks, whichever kind of call it is. Owned by nobody: it ends
/// itself when gRPC is done with it.
class ChunkReactor {
 public:
  virtual ~ChunkReactor() = default;
  virtual void write(grpc::ByteBuffer* message) = 0;
  virtual void finish(const grpc::Status& status) = 0;
};

/// The logic of one stream: opens what it sends, then keeps a few chunks being made on the
/// pool and writes them in order.
///
/// At most `window` chunks are made and not yet taken by the transport, each in a block of the
/// send budget, so a client that reads slowly holds that many blocks and nothing else: its
/// place at the mesher is lent to others meanwhile.
class ChunkStream : public StreamWriter {
 protected:
  /// Where a chunk is made: in a block of its own, or in one of the stream's ring.
  struct Block {
    std::shared_ptr<SendBudget::Lease> lease;
    std::shared_ptr<const ChunkRing> ring;
  };

  ChunkStream(MeshEngine& engine, grpc::CallbackServerContext& context, std::string method);

  /// Begins the call, whose request was read with `parsed`; what it returns is for gRPC.
  static grpc::ServerWriteReactor<grpc::ByteBuffer>* start(
      const std::shared_ptr<ChunkStream>& stream, const absl::Status& parsed);

  /// Begins the call with gRPC's side of it, which lives until gRPC is done.
  void begin(ChunkReactor& reactor, const absl::Status& parsed);

  /// The call was admitted, and not yet as a mesh.
  virtual void admitted() {}
  /// The call waits for what it is to open; or queues for its turn at once.
  virtual void await() { queue(); }
  /// Waits for its turn to make a mesh, then opens it.
  void queue();
  /// Finds out what is sent, then calls `begin_chunks`, on any thread.
  virtual void open() = 0;
  /// Notes for the log how that ended; with the lock.
  virtual void note_opening() {}

  // These are asked of a stream that is open, on any thread.
  virtual std::uint64_t chunk_count() const = 0;
  virtual v1::MeshEvent header() const = 0;
  virtual absl::StatusOr<ChunkMessage> make(std::uint64_t index, Block block) = 0;
  virtual v1::MeshEvent trailer(std::uint64_t first,
                                std::uint64_t end,
                                const QualityStats& quality) const = 0;
  /// Makes a chunk of a counted mesh, wherever it goes.
  absl::StatusOr<ChunkMessage> make_mesh_chunk(const ChunkSource& source,
                                               std::uint64_t index,
                                               Block block);
  /// Work that the trailer waits for, or none. It is done while chunks are sent, on threads of
  /// long work, and stops when the watch is cancelled; asked for with the lock.
  virtual std::function<absl::Status()> work_for_trailer() { return nullptr; }

  /// Why chunks cannot be in shared memory, whatever the client has asked for. With the lock.
  virtual absl::Status check_shareable() const { return absl::OkStatus(); }
  /// The client asks for chunks in shared memory, or does not, and for their events beside the
  /// stream: see StreamRing.
  void claim_memory(const std::string& token, bool events);

  /// What the client is told of what cannot be opened, where the call goes on all the same;
  /// nothing ends the call. With the lock.
  virtual std::optional<v1::MeshEvent> refuse(const absl::Status& /*why*/) {
    return std::nullopt;
  }

  /// All was sent. Ends the call, or waits for more.
  void sent_all() override { close(absl::OkStatus()); }
  /// Makes room for others while this call waits for what is to be opened next.
  void give_turn_back();
  /// Begins to open that. False when the call ends.
  bool reopen();

  /// Sends chunks [start, end), or up to the last where `end` is 0; or a refusal; or ends the
  /// call.
  void begin_chunks(const absl::Status& opened, std::uint64_t start, std::uint64_t end);
  /// Tells the client every now and then how far opening is.
  void watch_progress();

  std::shared_ptr<ChunkStream> self() {
    return std::static_pointer_cast<ChunkStream>(shared_from_this());
  }

  std::optional<Stallable::Clock::time_point> waiting_since() override;
  void give_up(std::chrono::seconds waited) override;

  MeshEngine& engine_;
  std::shared_ptr<PlanningWatch> watch_;

 private:
  /// What is written next.
  enum class Phase { kOpening, kHeader, kChunks, kTrailer, kRefusal, kSent };

  /// A chunk being made (`ready` is false) or waiting to be written.
  struct Slot {
    ChunkMessage made;
    bool ready = false;
  };

  void enter(absl::StatusOr<Ticket> ticket);
  void report_progress();
  void begin_window();
  void begin_work_for_trailer();
  void begin_refusal(const absl::Status& why);
  absl::Status set_range(std::uint64_t start, std::uint64_t end);
  std::uint64_t window() const;
  void post_chunks();
  void ask_for_block(std::uint64_t index);
  void post_chunk(std::uint64_t index, Block block);
  void post_freed();
  void open_ring();
  bool all_acknowledged();
  void tell_beside();
  void tell_of_rest();
  bool tell_of_chunk();
  ChunkRing::Events ring_events();
  v1::MeshEvent whole_header() const;
  void fill_slot(std::uint64_t index, Block block);

  void pass_time(Stallable::Clock::time_point now) final;
  bool prepare() final;
  bool prepare_message();
  bool after_write() final;
  Phase phase_of_next() const;
  void after_chunk();
  void note_end() final;
  void note_finish() final;
  void write() final { reactor_->write(&outgoing_); }
  void finish(const grpc::Status& status) final { reactor_->finish(status); }
  void abandon() final;
  void before_finish() final { give_turn_back(); }

  Slot& slot_of(std::uint64_t index) { return slots_[index % slots_.size()]; }

  ChunkReactor* reactor_ = nullptr;         ///< there until the call is finished
  std::atomic<Admission::Place> place_{0};  ///< in the queue; 0: in none
  MesherTurn turn_;

  // The writer's lock guards all below.
  std::unique_ptr<grpc::Alarm> progress_timer_;
  Phase phase_ = Phase::kOpening;
  Phase written_ = Phase::kOpening;  ///< phase of the message being written
  bool progress_due_ = false;
  bool trailer_waits_ = false;  ///< for work that is not done
  grpc::ByteBuffer outgoing_;   ///< the MeshEvent being written
  grpc::ByteBuffer refusal_;    ///< the one that is written next, where there is nothing else
  std::vector<Slot> slots_;     ///< chunk i in slot i % size
  StreamRing shared_;           ///< without a ring chunks travel in their messages
  bool waits_ = false;          ///< all is sent, and not all acknowledged
  std::uint64_t first_ = 0;     ///< chunk that the stream begins with
  std::uint64_t next_ = 0;      ///< chunk to be written next
  std::uint64_t posted_ = 0;    ///< chunk to be posted next
  std::uint64_t end_ = 0;       ///< one past the last chunk
  QualityStats quality_;        ///< of the chunks written, in their order
  std::uint64_t tets_written_ = 0, bytes_written_ = 0, chunks_written_ = 0;
  double opening_since_ = 0;  ///< seconds since the call arrived
};

/// Events of one kind of reactor become the stream's.
template <class Reactor>
class ChunkReactorOf : public Reactor, public ChunkReactor {
 public:
  explicit ChunkReactorOf(std::shared_ptr<ChunkStream> stream) : stream_(std::move(stream)) {}

  void write(grpc::ByteBuffer* message) override { this->StartWrite(message); }
  void finish(const grpc::Status& status) override { this->Finish(status); }

 private:
  void OnWriteDone(bool ok) override { stream_->written(ok); }
  void OnCancel() override { stream_->cancelled(); }
  void OnDone() override { delete this; }

  const std::shared_ptr<ChunkStream> stream_;
};

}  // namespace tet
