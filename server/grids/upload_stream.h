// One UploadGrid call.
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include "core/base/parallel.h"
#include "proto/convert/upload_piece.h"
#include "server/grids/grid_store.h"
#include "server/grids/grid_upload.h"
#include "server/grids/upload_events.h"
#include "server/rpc/calls.h"
#include "server/rpc/stall_watch.h"
#include "tetstream/v1/grids.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

/// The reactor of one upload. A piece is written to disk and digested as two tasks, while the
/// next message is read; that one waits until both are done. So there is at most one piece in
/// work and one on its way, and what decides runs once at a time.
///
/// A client that sends nothing for too long is told so, and what came can be resumed. Then all
/// that is there is digested first, a part of it in each turn, as long as the client is there.
///
/// Lives until gRPC is done with it and nobody else looks at it.
class UploadStream final : public grpc::ServerReadReactor<grpc::ByteBuffer>, public Stallable {
 public:
  /// What the call needs of the server.
  struct Place {
    GridStore& store;
    CallRegistry& calls;
    FairTasks& disk;
    StallWatch& stalls;
  };

  /// Begins the call; what it returns is for gRPC. `response` becomes an UploadGridResponse.
  static grpc::ServerReadReactor<grpc::ByteBuffer>* start(const Place& place,
                                                          grpc::CallbackServerContext& context,
                                                          grpc::ByteBuffer& response);

 private:
  UploadStream(const Place& place,
               grpc::CallbackServerContext& context,
               grpc::ByteBuffer& response);

  void OnReadDone(bool ok) override;
  void OnDone() override { const std::shared_ptr<UploadStream> last = std::move(self_); }
  std::optional<Clock::time_point> waiting_since() override;
  void give_up(std::chrono::seconds waited) override;

  void begin();
  void read();

  static constexpr Clock::rep kNotReading = -1;

  void happened(UploadEvents::Event event);

  void go_on();
  absl::Status take_turn();
  absl::Status end_piece();
  absl::Status take_message();
  absl::Status take_start(const v1::UploadStart& start);
  bool is_resuming() const { return upload_ != nullptr && !upload_->has_digested_part(); }
  absl::Status resume();
  absl::Status take_piece(UploadPiece piece);
  void begin_work();
  absl::Status commit();
  void finish(const absl::Status& status);

  GridStore& store_;
  FairTasks& disk_;
  Admission& admission_;
  grpc::CallbackServerContext& context_;
  Call call_;
  absl::StatusOr<Ticket> ticket_;
  grpc::ByteBuffer& serialized_response_;
  v1::UploadGridResponse response_;
  std::unique_ptr<GridUpload> upload_;

  std::shared_ptr<UploadStream> self_;  ///< until gRPC is done
  UploadEvents events_;                 ///< message read, piece written, piece digested
  std::atomic<Clock::rep> read_start_{kNotReading};
  grpc::ByteBuffer message_;    ///< read last
  bool more_ = false;           ///< the last read brought a message
  UploadPiece piece_;           ///< in work
  std::string text_;            ///< holds its bytes if protobuf had to parse them
  absl::Status written_;        ///< what became of it
  std::uint64_t bytes_in_ = 0;  ///< of pieces written, by this call
};

}  // namespace tet
