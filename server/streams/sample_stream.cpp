#include "server/streams/sample_stream.h"

#include <algorithm>
#include <utility>

#include "proto/convert/mesh_header.h"
#include "proto/convert/point_samples.h"
#include "proto/convert/request_rules.h"
#include "proto/convert/status.h"
#include "proto/wire/serialized.h"
#include "server/ops/guard.h"
#include "server/ops/memory.h"
#include "server/rpc/deadline.h"
#include "server/rpc/explain.h"

namespace tet {

namespace {

constexpr std::uint64_t kPointsPerPiece = 8192;

absl::Status sampling_order(const char* message) {
  return with_reason(absl::InvalidArgumentError(message), "MESSAGE_ORDER");
}

/// Points whose samples fit into one message: a chunk's columns are no smaller.
std::uint64_t points_per_piece(const ShapeSampler& sampler) {
  const std::uint64_t bytes_of_point = 4 * sizeof(double) + sampler.width() * sizeof(float);
  return std::min<std::uint64_t>(kPointsPerPiece, kChunkBytes / bytes_of_point);
}

grpc::ByteBuffer header_message(const ShapeSampler& sampler) {
  v1::SamplePointsResponse response;
  v1::SampleHeader& header = *response.mutable_header();
  to_proto(sampler.arrays(), *header.mutable_fields());
  header.set_inside_guess(sampler.inside_guess());
  return serialized(response);
}

}  // namespace

/// Events of gRPC's become the stream's. Owned by nobody: it ends itself.
class SampleStream::Side final : public Reactor {
 public:
  explicit Side(std::shared_ptr<SampleStream> stream) : stream_(std::move(stream)) {}

  void OnReadDone(bool ok) override { stream_->read_done(ok); }
  void OnWriteDone(bool ok) override { stream_->written(ok); }
  void OnCancel() override { stream_->cancelled(); }
  void OnDone() override { delete this; }

 private:
  const std::shared_ptr<SampleStream> stream_;
};

SampleStream::SampleStream(MeshEngine& engine, grpc::CallbackServerContext& context)
    : StreamWriter(engine.calls, context, "SamplePoints"),
      engine_(engine),
      watch_(std::make_shared<PlanningWatch>(deadline_of(context))),
      charge_("bytes of points that are sampled",
              engine.activity.point_bytes,
              point_bytes(engine.config)) {}

SampleStream::Reactor* SampleStream::start(MeshEngine& engine,
                                           grpc::CallbackServerContext& context) {
  const std::shared_ptr<SampleStream> stream(new SampleStream(engine, context));
  auto* const side = new Side(stream);  // ends itself
  stream->side_ = side;
  engine.stalls.add(stream);
  stream->begin();
  return side;
}

void SampleStream::begin() {
  const absl::Status admitted = call_.admission();
  if (!admitted.ok()) return close(admitted);
  guard([this] {
    end_with_server();
    read();
  });
}

void SampleStream::write() { side_->StartWrite(&outgoing_); }
void SampleStream::finish(const grpc::Status& status) { side_->Finish(status); }

void SampleStream::read() {
  {
    const std::lock_guard lock(mutex_);
    is_reading_ = true;
    if (!is_working_) idle_since_ = Stallable::Clock::now();
  }
  start_operation([this] { side_->StartRead(&incoming_); });
}

void SampleStream::read_done(bool ok) {
  {
    const std::lock_guard lock(mutex_);
    is_reading_ = false;
    has_message_ = ok;
    idle_since_.reset();
  }
  go_on();
}

/// Works on the message that was read, unless one is in work, or none has come yet.
void SampleStream::go_on() {
  bool is_last = false;
  {
    const std::lock_guard lock(mutex_);
    if (is_working_ || is_reading_ || ended()) return;
    is_working_ = true;
    is_last = !std::exchange(has_message_, false);
  }
  if (!is_last) {
    return engine_.short_tasks.post(
        call_.client(), [self = self()] { self->guard([&] { self->take_message(); }); });
  }
  close(started_ ? absl::OkStatus() : sampling_order("it ended before `start`"));
}

/// In one of the client's tasks.
void SampleStream::take_message() {
  v1::SamplePointsRequest message;
  const absl::Status taken = deserialize(incoming_, message)
                                 ? take(message)
                                 : sampling_order("bytes that are no message");
  if (!taken.ok()) return close(taken);
  read();  // the next one comes while this one is in work
  if (sampler_) return post_pieces();
  const auto entered = [self = self()](absl::StatusOr<Ticket> ticket) {
    self->guard([&] { self->load(std::move(ticket)); });
  };
  place_ = engine_.admit(call_, watch_->cancellation.deadline(), entered);
}

absl::Status SampleStream::take(const v1::SamplePointsRequest& message) {
  if (message.has_start() != !started_) {
    return sampling_order(started_ ? "a second `start`" : "points before `start`");
  }
  if (!started_) return within_field("start", take_start(message.start()));
  if (!message.has_points()) {
    return sampling_order("a message with neither `start` nor `points`");
  }
  return within_field("points", take_points(message.points()));
}

absl::Status SampleStream::take_start(const v1::MeshRequest& request) {
  if (auto status = check_rules(request, {Feature::kPoints}); !status.ok()) return status;
  auto order = parse_mesh_request(request);
  if (!order.ok()) return order.status();
  started_ = true;
  order_ = *std::move(order);
  order_.space = call_.space();
  if (!order_.digest.empty()) note_from_task("grid", order_.digest);
  return absl::OkStatus();
}

absl::Status SampleStream::take_points(const v1::PointBatch& batch) {
  if (auto status = charge_.add(batch.positions().size()); !status.ok()) return status;
  auto points = from_proto(batch, first_point_);
  if (!points.ok()) return points.status();
  points_ = *std::move(points);
  return absl::OkStatus();
}

void SampleStream::load(absl::StatusOr<Ticket> ticket) {
  if (!ticket.ok()) return close(ticket.status());
  {
    const std::lock_guard lock(mutex_);
    if (ended()) return;
    ticket_ = *std::move(ticket);
  }
  engine_.planner.load(call_.client(), order_, watch_,
                       [self = self()](absl::StatusOr<PlanInput> input) {
                         self->guard([&] { self->loaded(std::move(input)); });
                       });
}

/// In one of the client's tasks. From here on this call is no mesh to others, and takes its
/// turns with chunks.
void SampleStream::loaded(absl::StatusOr<PlanInput> input) {
  if (!input.ok()) return close(input.status());
  auto sampler = ShapeSampler::make(std::move(input->shape), std::move(input->request));
  if (!sampler.ok()) return close(about_mesh(sampler.status()));
  grids_ = std::move(input->grids);
  sampler_.emplace(*std::move(sampler));
  give_turn_back();
  {
    const std::lock_guard lock(mutex_);
    header_due_ = true;
  }
  advance();
}

void SampleStream::give_turn_back() {
  Ticket last;  // given back without the lock
  const std::lock_guard lock(mutex_);
  last.swap(ticket_);
}

/// A client that thinks about its next points takes no memory for those before.
void SampleStream::free_points() {
  first_point_ += points_.size();
  points_ = {};
  charge_.shrink_to(0);
}

/// All of a message was answered.
void SampleStream::message_done() {
  free_points();
  {
    const std::lock_guard lock(mutex_);
    is_working_ = false;
    if (is_reading_) idle_since_ = Stallable::Clock::now();
  }
  go_on();
}

std::uint64_t SampleStream::piece_count() const {
  const std::uint64_t size = points_per_piece(*sampler_);
  return (points_.size() + size - 1) / size;
}

/// Begins to answer the message.
void SampleStream::post_pieces() {
  const std::uint64_t pieces = piece_count();
  if (pieces == 0) return message_done();
  const std::lock_guard lock(mutex_);
  next_ = posted_ = 0;
  pieces_ = pieces;
  post_more();
}

/// One piece is made while the one before it is on its way, but where blocks are scarce.
void SampleStream::post_more() {
  const std::uint64_t ahead = engine_.is_tight() ? 1 : slots_.size();
  while (!ended() && posted_ < std::min(pieces_, next_ + ahead)) {
    const std::uint64_t index = posted_++;
    engine_.send_budget.ask(this, call_.client(), [self = self(), index](const Block& block) {
      self->engine_.activity.chunks_in_flight.fetch_add(1);
      self->engine_.short_tasks.post(self->call_.client(),
                                     [self, index, block] { self->fill_piece(index, block); });
    });
  }
}

// Only this task touches the slot until it is ready.
void SampleStream::fill_piece(std::uint64_t index, Block block) {
  auto made = guarded("SamplePoints", [&] { return make_piece(index, std::move(block)); });
  engine_.activity.chunks_in_flight.fetch_sub(1);
  {
    const std::lock_guard lock(mutex_);
    if (made.ok()) {
      slot_of(index) = *std::move(made);
    } else {
      end(made.status());
    }
  }
  advance();
}

absl::StatusOr<SampleStream::Piece> SampleStream::make_piece(std::uint64_t index,
                                                             Block block) const {
  if (watch_->cancellation.requested()) return client_gone(watch_->cancellation);
  const std::uint64_t size = points_per_piece(*sampler_);
  const std::uint64_t first = index * size;
  const std::uint64_t count = std::min<std::uint64_t>(size, points_.size() - first);
  PointSamples samples = samples_for(*sampler_, count);
  sampler_->sample(std::span(points_).subspan(first, count), samples.columns(),
                   watch_->cancellation);
  if (watch_->cancellation.requested()) return client_gone(watch_->cancellation);
  v1::SamplePointsResponse response;
  to_proto(samples.columns(), first_point_ + first, *response.mutable_samples());
  const std::uint64_t bytes = response.ByteSizeLong();
  block->shrink_to(bytes);
  return Piece{serialized(response, std::move(block)), count, bytes, true};
}

bool SampleStream::prepare() {
  writes_header_ = std::exchange(header_due_, false);
  if (writes_header_) {
    outgoing_ = header_message(*sampler_);
    return true;
  }
  if (next_ == pieces_ || !slot_of(next_).ready) return false;
  outgoing_.Swap(&slot_of(next_).message);
  return true;
}

/// True after the last message that there is for now.
bool SampleStream::after_write() {
  outgoing_.Clear();  // its block is gRPC's alone now
  if (ended()) return false;
  if (writes_header_) return true;
  Piece& piece = slot_of(next_++);
  engine_.calls.metrics().points_sampled(piece.points, piece.bytes);
  call_.use().sent_bytes += piece.bytes;
  points_sent_ += piece.points;
  bytes_sent_ += piece.bytes;
  piece = {};
  post_more();
  return next_ == pieces_;
}

void SampleStream::note_finish() {
  call_.note("points", points_sent_);
  call_.note("bytes_out", bytes_sent_);
}

void SampleStream::abandon() {
  watch_->cancellation.cancel();
  engine_.calls.admission().leave(place_);
}

std::optional<Stallable::Wait> SampleStream::wait(std::chrono::seconds limit) {
  if (const auto writing = StreamWriter::wait(limit)) return writing;
  const std::lock_guard lock(mutex_);
  // A client may think for longer than it may take over a message.
  if (!idle_since_) return std::nullopt;
  return Wait{*idle_since_, engine_.session_idle()};
}

void SampleStream::give_up(std::chrono::seconds waited) {
  if (StreamWriter::waiting_since()) return StreamWriter::give_up(waited);
  close(client_stalled("sent no points", waited));
}

}  // namespace tet
