#include "server/streams/chunk_stream.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include <absl/strings/str_cat.h>

#include "proto/convert/status.h"
#include "proto/wire/serialized.h"
#include "server/meshing/mesh_events.h"
#include "server/ops/guard.h"
#include "server/rpc/deadline.h"

namespace tet {

namespace {

constexpr std::chrono::milliseconds kProgressInterval{200};

/// Longer than a reader who takes what it gets lets a stream wait, and shorter than anybody
/// waits in the queue.
constexpr std::chrono::milliseconds kIdle{200};

}  // namespace

ChunkStream::ChunkStream(MeshEngine& engine,
                         grpc::CallbackServerContext& context,
                         std::string method)
    : StreamWriter(engine.calls, context, std::move(method)),
      engine_(engine),
      watch_(std::make_shared<PlanningWatch>(deadline_of(context))),
      turn_(engine.calls.admission()),
      shared_(engine) {}

grpc::ServerWriteReactor<grpc::ByteBuffer>* ChunkStream::start(
    const std::shared_ptr<ChunkStream>& stream, const absl::Status& parsed) {
  using Reactor = ChunkReactorOf<grpc::ServerWriteReactor<grpc::ByteBuffer>>;
  auto* const reactor = new Reactor(stream);  // ends itself
  stream->begin(*reactor, parsed);
  return reactor;
}

void ChunkStream::begin(ChunkReactor& reactor, const absl::Status& parsed) {
  reactor_ = &reactor;
  engine_.stalls.add(weak_from_this());
  const absl::Status may_call = call_.admission();
  const absl::Status status = may_call.ok() ? parsed : may_call;
  if (!status.ok()) return close(status);
  guard([this] {
    admitted();
    end_with_server();
    await();
  });
}

void ChunkStream::queue() {
  place_ = engine_.admit(
      call_, watch_->cancellation.deadline(),
      [self = self()](absl::StatusOr<Ticket> ticket) { self->enter(std::move(ticket)); });
}

/// Whoever sees the stream's end, or its pause, may begin the next at once.
void ChunkStream::give_turn_back() { turn_.give_back(); }

void ChunkStream::pass_time(Stallable::Clock::time_point now) {
  turn_.lend_if_idle_since(now - kIdle);
}

bool ChunkStream::reopen() {
  const std::lock_guard lock(mutex_);
  if (ended()) return false;
  phase_ = Phase::kOpening;
  progress_due_ = false;
  quality_ = {};
  opening_since_ = call_.seconds();
  watch_->progress.done = 0;
  watch_->progress.total = 0;
  return true;
}

void ChunkStream::enter(absl::StatusOr<Ticket> ticket) {
  if (!ticket.ok()) return begin_chunks(ticket.status(), 0, 0);
  {
    const std::lock_guard lock(mutex_);
    if (ended()) return;
    turn_.take(*std::move(ticket));
  }
  guard([this] { open(); });
}

// Each interval has an alarm of its own: one cannot be set again from within its own callback.
void ChunkStream::watch_progress() {
  const std::lock_guard lock(mutex_);
  if (ended() || phase_ != Phase::kOpening) return;
  const auto next = std::chrono::system_clock::now() + kProgressInterval;
  progress_timer_ = std::make_unique<grpc::Alarm>();
  progress_timer_->Set(next, [self = self()](bool fired) {
    if (fired) contain("progress", [&] { self->report_progress(); });
  });
}

void ChunkStream::report_progress() {
  {
    const std::lock_guard lock(mutex_);
    progress_due_ = true;
  }
  advance();
  watch_progress();
}

void ChunkStream::begin_chunks(const absl::Status& opened,
                               std::uint64_t start,
                               std::uint64_t end_chunk) {
  {
    const std::lock_guard lock(mutex_);
    if (ended()) return;
    const absl::Status status = guarded(call_.method().c_str(), [&] {
      note_opening();
      const absl::Status begins = opened.ok() ? set_range(start, end_chunk) : opened;
      if (begins.ok()) begin_window();
      return begins;
    });
    if (!status.ok()) begin_refusal(status);
  }
  advance();
}

/// Or the call's end.
void ChunkStream::begin_refusal(const absl::Status& why) {
  const auto refusal = refuse(why);
  if (!refusal) return end(why);
  refusal_ = serialized(*refusal);
  phase_ = Phase::kRefusal;
}

void ChunkStream::begin_window() {
  phase_ = Phase::kHeader;
  turn_.opened();
  const auto window = static_cast<std::uint64_t>(engine_.pool.threads()) + 1;
  slots_.resize(std::clamp<std::uint64_t>(end_ - next_, 1, window));
  open_ring();
  post_chunks();
  begin_work_for_trailer();
}

/// A stream that ends before the last chunk has no trailer.
void ChunkStream::begin_work_for_trailer() {
  if (end_ != chunk_count()) return;
  std::function<absl::Status()> work = work_for_trailer();
  if (work == nullptr) return;
  trailer_waits_ = true;
  turn_.begin();
  engine_.longer.post(call_.client(), [self = self(), work = std::move(work)] {
    const absl::Status status = guarded(self->call_.method().c_str(), work);
    self->turn_.end();
    {
      const std::lock_guard lock(self->mutex_);
      self->trailer_waits_ = false;
      if (!status.ok()) self->end(status);
    }
    self->advance();
  });
}

/// Settles which chunks to send.
absl::Status ChunkStream::set_range(std::uint64_t start, std::uint64_t end_chunk) {
  const std::uint64_t count = chunk_count();
  end_ = end_chunk == 0 ? count : end_chunk;
  first_ = next_ = posted_ = start;
  if (next_ <= end_ && end_ <= count) return absl::OkStatus();
  return with_reason(absl::OutOfRangeError(absl::StrCat("chunks ", next_, " to ", end_,
                                                        " are not within the mesh's ", count)),
                     "CHUNK_RANGE");
}

/// Chunks made ahead: enough of all streams together to keep every thread busy, but two a
/// stream; and one where blocks are scarce.
std::uint64_t ChunkStream::window() const {
  if (engine_.is_tight()) return 1;
  const auto streams = static_cast<std::uint64_t>(engine_.activity.meshes.load());
  return std::clamp<std::uint64_t>(slots_.size() / std::max<std::uint64_t>(streams, 1),
                                   std::min<std::uint64_t>(slots_.size(), 2), slots_.size());
}

/// Fills the window.
void ChunkStream::post_chunks() {
  const std::uint64_t ahead = window();
  while (posted_ < end_ && posted_ < next_ + ahead) {
    if (shared_.ring() == nullptr) {
      ask_for_block(posted_++);
      continue;
    }
    if (!shared_.ring()->has_room(posted_)) return;
    post_chunk(posted_++, {nullptr, shared_.ring()});
  }
}

void ChunkStream::ask_for_block(std::uint64_t index) {
  engine_.send_budget.ask(this, call_.client(),
                          [self = self(), index](std::shared_ptr<SendBudget::Lease> lease) {
                            self->post_chunk(index, {std::move(lease), nullptr});
                          });
}

void ChunkStream::post_chunk(std::uint64_t index, Block block) {
  turn_.begin();
  engine_.activity.chunks_in_flight.fetch_add(1);
  engine_.short_tasks.post(call_.client(), [self = self(), index, block = std::move(block)] {
    self->fill_slot(index, block);
  });
}

// Only this task touches the slot until it is ready: nobody needs the lock while it is filled.
void ChunkStream::fill_slot(std::uint64_t index, Block block) {
  Slot& slot = slot_of(index);
  absl::Status status = absl::OkStatus();
  if (watch_->cancellation.requested()) {
    status = client_gone(watch_->cancellation);
  } else {
    auto made = guarded(call_.method().c_str(), [&] { return make(index, std::move(block)); });
    status = made.status();
    if (made.ok()) {
      slot.made = *std::move(made);
    } else if (watch_->cancellation.requested()) {
      status = client_gone(watch_->cancellation);
    }
  }
  engine_.activity.chunks_in_flight.fetch_sub(1);
  turn_.end();
  {
    const std::lock_guard lock(mutex_);
    slot.ready = status.ok();
    if (!status.ok()) end(status);
  }
  advance();
}

/// The header, with what the client reads chunks from.
v1::MeshEvent ChunkStream::whole_header() const {
  v1::MeshEvent event = header();
  if (const auto& ring = shared_.ring()) {
    v1::SharedMemory& memory = *event.mutable_header()->mutable_shared_memory();
    memory.set_block_bytes(static_cast<std::int64_t>(ring->size().block_bytes));
    memory.set_blocks(static_cast<std::int64_t>(ring->size().blocks));
    memory.set_events(shared_.tells_beside() && next_ < end_);  // or there are none
  }
  return event;
}

/// Whatever ends the stream before it is whole, its work ends with it: nobody counts it any
/// more, and what measures fidelity would go on for as long as the mesh is large.
void ChunkStream::note_end() {
  if (!ended_well()) watch_->cancellation.cancel();
  engine_.send_budget.leave(this);
  shared_.end(ended_well());
}

void ChunkStream::note_finish() {
  progress_timer_.reset();
  call_.note("tets", tets_written_);
  call_.note("chunks", chunks_written_);
  call_.note("bytes_out", bytes_written_);
}

bool ChunkStream::prepare() {
  if (phase_ == Phase::kChunks && shared_.tells_beside()) tell_beside();
  written_ = phase_;
  return prepare_message();
}

/// The message to be written now, if there is one, becomes `outgoing_`.
bool ChunkStream::prepare_message() {
  switch (phase_) {
    case Phase::kOpening:
      if (!std::exchange(progress_due_, false)) return false;
      outgoing_ = serialized(progress_event(watch_->progress));
      return true;
    case Phase::kHeader:
      outgoing_ = serialized(whole_header());
      return true;
    case Phase::kChunks:
      if (!slot_of(next_).ready) return false;
      outgoing_.Swap(&slot_of(next_).made.event);
      if (shared_.ring() != nullptr) shared_.ring()->tell(next_ + 1);
      return true;
    case Phase::kTrailer:
      if (trailer_waits_) return false;
      outgoing_ = serialized(trailer(first_, end_, quality_));
      return true;
    case Phase::kRefusal:
      outgoing_.Swap(&refusal_);
      return true;
    case Phase::kSent:
      break;
  }
  return false;
}

/// True after the last message there is.
bool ChunkStream::after_write() {
  outgoing_.Clear();  // its block is gRPC's alone now
  if (ended()) return false;
  if (written_ == Phase::kOpening) return false;
  if (written_ == Phase::kRefusal) {
    phase_ = Phase::kSent;
    return true;
  }
  if (written_ == Phase::kChunks) after_chunk();
  phase_ = written_ == Phase::kTrailer ? Phase::kSent : phase_of_next();
  if (written_ == Phase::kChunks && phase_ != Phase::kChunks && shared_.tells_beside()) {
    tell_of_rest();  // the last one fitted into no block
    if (ended()) return false;
  }
  return phase_ == Phase::kSent && all_acknowledged();
}

/// Behind a header or a chunk.
ChunkStream::Phase ChunkStream::phase_of_next() const {
  if (next_ < end_) return Phase::kChunks;
  return end_ == chunk_count() ? Phase::kTrailer : Phase::kSent;
}

/// Counts the chunk that was written and reuses its slot.
void ChunkStream::after_chunk() {
  Slot& slot = slot_of(next_);
  if (next_ == first_) {
    const double seconds = call_.seconds() - opening_since_;
    engine_.calls.metrics().first_chunk(seconds);
    call_.note("first_chunk_ms", 1e3 * seconds);
  }
  engine_.calls.metrics().chunk_sent(slot.made.tets, slot.made.bytes);
  call_.use().sent_bytes += slot.made.bytes;
  quality_.add(slot.made.quality);
  tets_written_ += slot.made.tets;
  bytes_written_ += slot.made.bytes;
  slot.ready = false;
  ++chunks_written_;
  ++next_;
  post_chunks();
}

void ChunkStream::abandon() {
  watch_->cancellation.cancel();
  engine_.calls.admission().leave(place_);
}

}  // namespace tet
