// One SamplePoints call: what is said of points, as they come.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include "core/plan/sample_points.h"
#include "proto/convert/request.h"
#include "server/rpc/stream_writer.h"
#include "server/streams/call_charge.h"
#include "server/streams/mesh_engine.h"

namespace tet {

/// Loads what is sampled in its turn among the meshes. Then each message of points is answered
/// in pieces, which are made in turn with the chunks of others, each in a block of the send
/// budget. While one message is answered the next is read, and no more: a client that does not
/// read is not read from.
class SampleStream final : public StreamWriter {
 public:
  using Reactor = grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>;

  /// Begins the call; what it returns is for gRPC.
  static Reactor* start(MeshEngine& engine, grpc::CallbackServerContext& context);

  /// gRPC has read a message; or there is none.
  void read_done(bool ok);

  std::optional<Wait> wait(std::chrono::seconds limit) override;
  void give_up(std::chrono::seconds waited) override;

 private:
  class Side;
  using Block = std::shared_ptr<SendBudget::Lease>;

  /// A run of the message's points, being made (`ready` is false) or waiting to be written.
  struct Piece {
    grpc::ByteBuffer message;
    std::uint64_t points = 0, bytes = 0;
    bool ready = false;
  };

  SampleStream(MeshEngine& engine, grpc::CallbackServerContext& context);
  void begin();

  void read();
  void go_on();
  void take_message();
  absl::Status take(const v1::SamplePointsRequest& message);
  absl::Status take_start(const v1::MeshRequest& request);
  absl::Status take_points(const v1::PointBatch& batch);
  void load(absl::StatusOr<Ticket> ticket);
  void loaded(absl::StatusOr<PlanInput> input);
  void give_turn_back();
  void free_points();
  void message_done();

  void post_pieces();
  void post_more();
  void fill_piece(std::uint64_t index, Block block);
  absl::StatusOr<Piece> make_piece(std::uint64_t index, Block block) const;
  std::uint64_t piece_count() const;
  Piece& slot_of(std::uint64_t index) { return slots_[index % slots_.size()]; }

  bool prepare() override;
  bool after_write() override;
  void note_end() override { engine_.send_budget.leave(this); }
  void note_finish() override;
  void write() override;
  void finish(const grpc::Status& status) override;
  void sent_all() override { message_done(); }
  void abandon() override;
  void before_finish() override { give_turn_back(); }

  std::shared_ptr<SampleStream> self() {
    return std::static_pointer_cast<SampleStream>(shared_from_this());
  }

  MeshEngine& engine_;
  const std::shared_ptr<PlanningWatch> watch_;
  Side* side_ = nullptr;                    ///< gRPC's, there until the call is finished
  std::atomic<Admission::Place> place_{0};  ///< in the queue; 0: in none
  grpc::ByteBuffer incoming_;               ///< the message being read

  // Whoever works on a message touches these: one at a time, from its start to its last piece.
  bool started_ = false;
  MeshOrder order_;
  std::vector<GridLease> grids_;  ///< keep the files from being evicted
  std::optional<ShapeSampler> sampler_;
  std::vector<WorldPoint> points_;  ///< of a message that is not answered
  CallCharge charge_;               ///< for these
  std::uint64_t first_point_ = 0;   ///< of these, within the call

  // The writer's lock guards all below.
  Ticket ticket_;  ///< while what is sampled is loaded
  bool is_reading_ = false, is_working_ = false, has_message_ = false;
  std::optional<Stallable::Clock::time_point> idle_since_;  ///< while a message is awaited
  bool header_due_ = false, writes_header_ = false;
  std::array<Piece, 2> slots_;           ///< piece i in slot i % size
  std::uint64_t next_ = 0, posted_ = 0;  ///< piece to be written, and to be made
  std::uint64_t pieces_ = 0;             ///< of the message
  grpc::ByteBuffer outgoing_;            ///< the message being written
  std::uint64_t points_sent_ = 0, bytes_sent_ = 0;
};

}  // namespace tet
