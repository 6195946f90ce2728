#include "server/grids/upload_stream.h"

#include <utility>

#include <absl/strings/str_cat.h>

#include "proto/convert/request.h"
#include "proto/convert/status.h"
#include "proto/wire/serialized.h"
#include "server/ops/guard.h"

namespace tet {

namespace {

/// What is digested of a part in one turn: others' turns come every few hundredths of a second.
constexpr std::uint64_t kPartBytesOfTurn = std::uint64_t{16} << 20;

absl::Status out_of_order(const char* message) {
  return with_reason(absl::InvalidArgumentError(message), "MESSAGE_ORDER");
}

}  // namespace

grpc::ServerReadReactor<grpc::ByteBuffer>* UploadStream::start(
    const Place& place, grpc::CallbackServerContext& context, grpc::ByteBuffer& response) {
  const std::shared_ptr<UploadStream> upload(new UploadStream(place, context, response));
  upload->self_ = upload;
  place.stalls.add(upload);
  upload->begin();
  return upload.get();
}

UploadStream::UploadStream(const Place& place,
                           grpc::CallbackServerContext& context,
                           grpc::ByteBuffer& response)
    : store_(place.store),
      disk_(place.disk),
      admission_(place.calls.admission()),
      context_(context),
      call_(place.calls, context, "UploadGrid"),
      ticket_(admission_.admit_upload(call_.client())),
      serialized_response_(response) {}

void UploadStream::begin() {
  absl::Status admitted = call_.admission();
  if (admitted.ok()) admitted = ticket_.status();
  if (!admitted.ok()) return finish(admitted);
  events_.await(UploadEvents::kMessage);
  read();
}

void UploadStream::read() {
  read_start_ = Clock::now().time_since_epoch().count();
  StartRead(&message_);
}

void UploadStream::OnReadDone(bool ok) {
  read_start_ = kNotReading;
  more_ = ok;
  happened(UploadEvents::kMessage);
}

std::optional<Stallable::Clock::time_point> UploadStream::waiting_since() {
  const Clock::rep start = read_start_;
  if (start == kNotReading) return std::nullopt;
  return Clock::time_point(Clock::duration(start));
}

/// Where the message is all that is awaited, it is awaited no more: nobody else has a turn. The
/// piece before it is written by then, and is the client's to resume from.
void UploadStream::give_up(std::chrono::seconds waited) {
  if (!events_.give_up()) return;
  read_start_ = kNotReading;
  const absl::Status kept = end_piece();
  finish(kept.ok() ? client_stalled("sent nothing", waited) : kept);
}

/// `go_on` runs next, on the pool, when all awaited events have happened.
void UploadStream::happened(UploadEvents::Event event) {
  if (!events_.happened(event)) return;
  disk_.post(call_.client(), [self = self_] { self->go_on(); });
}

void UploadStream::go_on() {
  const absl::Status status = guarded("UploadGrid", [&] { return take_turn(); });
  if (!status.ok()) finish(status);
}

absl::Status UploadStream::take_turn() {
  const bool is_resumed = is_resuming();
  absl::Status status = is_resumed ? resume() : end_piece();
  if (status.ok() && !response_.complete() && !is_resumed) {
    // The stream ended, by the client's will or not: what has come is kept either way.
    if (!more_) {
      if (response_.name().empty()) return out_of_order("the stream ended before `start`");
      finish(absl::OkStatus());
      return absl::OkStatus();
    }
    status = call_.registry().cut_off();
    if (status.ok()) status = take_message();
  }
  if (!status.ok()) return status;
  response_.complete() ? finish(status) : begin_work();
  return absl::OkStatus();
}

/// The piece in work, if there is one, is written and digested, or was not.
absl::Status UploadStream::end_piece() {
  if (piece_.size == 0 || !written_.ok()) return written_;
  upload_->advance(piece_.size);
  bytes_in_ += piece_.size;
  call_.registry().metrics().upload_received(piece_.size);
  call_.use().received_bytes += piece_.size;
  piece_ = {};
  response_.set_committed_size(static_cast<std::int64_t>(upload_->committed_size()));
  return upload_->has_all() ? commit() : absl::OkStatus();
}

/// Takes the message that was read: a piece is in work from now on.
absl::Status UploadStream::take_message() {
  if (auto piece = read_piece(message_)) return take_piece(*std::move(piece));
  v1::UploadGridRequest message;
  if (!deserialize(message_, message)) return out_of_order("bytes that are no message");
  if (message.has_data()) {
    if (message.data().offset() < 0) {
      return within_field("data", invalid_field(absl::StrCat("offset ", message.data().offset(),
                                                             " is negative")));
    }
    text_ = std::move(*message.mutable_data()->mutable_data());
    return take_piece(
        {static_cast<std::uint64_t>(message.data().offset()), text_.size(), {text_}, {}});
  }
  if (!message.has_start()) return out_of_order("a message with neither `start` nor `data`");
  return take_start(message.start());
}

absl::Status UploadStream::take_start(const v1::UploadStart& start) {
  if (upload_ != nullptr) return out_of_order("a second `start`");
  const auto digest = parse_grid_name(start.name());
  if (!digest.ok()) return digest.status();
  if (start.size_bytes() < 1) {
    return invalid_field(absl::StrCat("size_bytes ", start.size_bytes(), " is not positive"));
  }
  const GridKey key{call_.space(), *digest};
  auto upload = store_.begin_upload(key, static_cast<std::uint64_t>(start.size_bytes()),
                                    {call_.client(), admission_.limits().client_upload_bytes});
  if (!upload.ok() && !absl::IsAlreadyExists(upload.status())) return upload.status();
  response_.set_name(start.name());
  call_.note("grid", *digest);
  if (!upload.ok()) {
    const UploadState state = store_.upload_state(key);
    response_.set_complete(store_.touch(key));
    response_.set_committed_size(static_cast<std::int64_t>(state.committed_size));
    return absl::OkStatus();
  }
  upload_ = *std::move(upload);
  return resume();
}

/// Looks at what is there of the file, or at some of it: then the next turn goes on.
absl::Status UploadStream::resume() {
  if (context_.IsCancelled()) return absl::CancelledError("the client has gone");
  absl::Status status = call_.registry().cut_off();
  if (status.ok()) status = upload_->digest_part(kPartBytesOfTurn);
  if (!status.ok() || is_resuming()) return status;
  response_.set_committed_size(static_cast<std::int64_t>(upload_->committed_size()));
  // All bytes may have come before a restart, without the commit.
  return upload_->has_all() ? commit() : absl::OkStatus();
}

absl::Status UploadStream::take_piece(UploadPiece piece) {
  if (upload_ == nullptr) return out_of_order("`data` before `start`");
  if (auto status = upload_->check(piece.offset, piece.size); !status.ok()) return status;
  piece_ = std::move(piece);
  return absl::OkStatus();
}

// Do not touch this call after its last event was awaited: `go_on` may run already.
void UploadStream::begin_work() {
  if (is_resuming()) return disk_.post(call_.client(), [self = self_] { self->go_on(); });
  const bool has_piece = piece_.size > 0;
  const bool last =
      has_piece && upload_->committed_size() + piece_.size == upload_->size_bytes();
  constexpr unsigned kOfPiece = UploadEvents::kWritten | UploadEvents::kDigested;
  events_.await((last ? 0U : UploadEvents::kMessage) | (has_piece ? kOfPiece : 0U));
  if (!last) read();
  if (!has_piece) return;
  disk_.post(call_.client(), [self = self_] {
    self->upload_->digest(self->piece_.bytes);
    self->happened(UploadEvents::kDigested);
  });
  written_ = guarded("UploadGrid", [&] { return upload_->write(piece_.bytes); });
  happened(UploadEvents::kWritten);
}

absl::Status UploadStream::commit() {
  const absl::Status committed = upload_->commit();
  response_.set_complete(committed.ok());
  return committed;
}

void UploadStream::finish(const absl::Status& status) {
  // Whoever sees the answer may go on with the upload at once.
  upload_.reset();
  ticket_ = nullptr;
  call_.note("bytes_in", bytes_in_);
  call_.note("committed_bytes", response_.committed_size());
  serialized_response_ = serialized(response_);
  Finish(call_.finish(status));
}

}  // namespace tet
