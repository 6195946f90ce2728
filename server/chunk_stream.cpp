#include "server/chunk_stream.h"

#include <algorithm>
#include <chrono>
#include <span>
#include <utility>

#include <absl/strings/str_cat.h>

#include "proto/wire/checksum.h"
#include "server/status.h"

namespace tet {

namespace {

constexpr std::chrono::milliseconds kProgressInterval{200};

std::span<std::byte> resized(std::string& column, std::size_t size) {
  column.resize(size);
  return std::as_writable_bytes(std::span(column));
}

absl::Status client_gone(const Cancellation& cancellation) {
  if (cancellation.deadline_passed()) return absl::DeadlineExceededError("the deadline passed");
  return absl::CancelledError("the client went away");
}

}  // namespace

grpc::ServerWriteReactor<v1::MeshEvent>* ChunkStream::start(
    MeshEngine& engine,
    const grpc::CallbackServerContext& context,
    const v1::StreamMeshRequest& request) {
  const std::shared_ptr<ChunkStream> stream(new ChunkStream(engine, context));
  stream->self_ = stream;
  stream->begin(request);
  return stream.get();
}

ChunkStream::ChunkStream(MeshEngine& engine, const grpc::CallbackServerContext& context)
    : engine_(engine),
      call_(engine.calls, context, "StreamMesh"),
      watch_(std::make_shared<PlanningWatch>(context.deadline())) {}

void ChunkStream::begin(const v1::StreamMeshRequest& request) {
  auto ticket = engine_.admit();
  auto order = parse_stream_request(request);
  const absl::Status status = ticket.ok() ? order.status() : ticket.status();
  if (!status.ok()) {
    end(status);
    return advance();
  }
  ticket_ = *std::move(ticket);
  order_ = *std::move(order);
  watch_progress();
  engine_.planner.plan(order_.mesh, watch_,
                       [self = shared_from_this()](absl::StatusOr<PlannedMesh> planned) {
                         self->begin_chunks(std::move(planned));
                       });
}

// Each interval has an alarm of its own: one cannot be set again from within its own callback.
void ChunkStream::watch_progress() {
  const std::lock_guard lock(mutex_);
  if (phase_ != Phase::kPlanning) return;
  const auto next = std::chrono::system_clock::now() + kProgressInterval;
  progress_timer_ = std::make_unique<grpc::Alarm>();
  progress_timer_->Set(next, [self = shared_from_this()](bool fired) {
    if (fired) self->report_progress();
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

void ChunkStream::begin_chunks(absl::StatusOr<PlannedMesh> planned) {
  {
    const std::lock_guard lock(mutex_);
    if (phase_ == Phase::kEnded) return;
    if (planned.ok()) planned_ = *std::move(planned);
    const absl::Status status = planned.ok() ? check_range() : planned.status();
    if (!status.ok()) {
      end(status);
    } else {
      phase_ = Phase::kHeader;
      const auto window = static_cast<std::uint64_t>(engine_.pool.threads()) + 1;
      slots_.resize(std::clamp<std::uint64_t>(end_ - next_, 1, window));
      post_chunks();
    }
  }
  advance();
}

/// Settles which chunks to send.
absl::Status ChunkStream::check_range() {
  if (!order_.expected_mesh_id.empty() && order_.expected_mesh_id != planned_.mesh_id) {
    return with_reason(
        absl::FailedPreconditionError(absl::StrCat("expected_mesh_id ", order_.expected_mesh_id,
                                                   " is not this mesh's, ", planned_.mesh_id)),
        "OTHER_MESH");
  }
  const std::uint64_t count = planned_.plan->header().chunk_count;
  end_ = order_.end_chunk == 0 ? count : order_.end_chunk;
  next_ = posted_ = order_.start_chunk;
  if (next_ <= end_ && end_ <= count) return absl::OkStatus();
  return with_reason(absl::OutOfRangeError(absl::StrCat("chunks ", next_, " to ", end_,
                                                        " are not within the mesh's ", count)),
                     "CHUNK_RANGE");
}

/// Fills the window.
void ChunkStream::post_chunks() {
  while (posted_ < end_ && posted_ < next_ + slots_.size()) {
    engine_.activity.chunks_in_flight.fetch_add(1);
    engine_.pool.post(
        [self = shared_from_this(), index = posted_] { self->make_chunk(index); });
    ++posted_;
  }
}

// Only this task touches the slot until it is ready: nobody needs the lock while it is filled.
void ChunkStream::make_chunk(std::uint64_t index) {
  Slot& slot = slot_of(index);
  const bool wanted = !watch_->cancellation.requested();
  if (wanted) fill(index, slot);
  engine_.activity.chunks_in_flight.fetch_sub(1);
  {
    const std::lock_guard lock(mutex_);
    slot.ready = wanted;
    if (!wanted) end(client_gone(watch_->cancellation));
  }
  advance();
}

void ChunkStream::fill(std::uint64_t index, Slot& slot) {
  const ChunkExtent extent = planned_.plan->chunk(index);
  v1::MeshChunk& chunk = *slot.event.mutable_chunk();
  chunk.set_index(static_cast<std::int64_t>(index));
  chunk.set_first_vertex(static_cast<std::int64_t>(extent.first_vertex));
  chunk.set_vertex_count(static_cast<std::int64_t>(extent.vertex_count));
  chunk.set_first_tet(static_cast<std::int64_t>(extent.first_tet));
  chunk.set_tet_count(static_cast<std::int64_t>(extent.tet_count));

  MeshWorkspace workspace = engine_.workspaces.take();
  const ChunkSizes size(planned_.plan->header(), extent.vertex_count, extent.tet_count);
  slot.quality = planned_.plan->fill_chunk(index, workspace,
                                           {resized(*chunk.mutable_positions(), size.positions),
                                            resized(*chunk.mutable_tets(), size.tets),
                                            resized(*chunk.mutable_regions(), size.regions)});
  engine_.workspaces.give_back(std::move(workspace));
  chunk.set_checksum(chunk_checksum(chunk.positions(), chunk.tets(), chunk.regions()));
  engine_.activity.chunks_made.fetch_add(1);
}

/// Takes one step if there is one to take. gRPC is called without the lock; `writing_` and
/// `finished_` keep others out meanwhile.
void ChunkStream::advance() {
  switch (next_step()) {
    case Step::kWait:
      return;
    case Step::kWrite:
      return StartWrite(outgoing_);
    case Step::kFinish:
      return Finish(call_.finish(status_));
  }
}

ChunkStream::Step ChunkStream::next_step() {
  const std::lock_guard lock(mutex_);
  if (writing_ || finished_) return Step::kWait;
  if (phase_ == Phase::kEnded) {
    finished_ = true;
    progress_timer_.reset();
    call_.note("tets", tets_written_);
    call_.note("bytes", bytes_written_);
    return Step::kFinish;
  }
  outgoing_ = next_event();
  if (outgoing_ == nullptr) return Step::kWait;
  writing_ = true;
  written_ = phase_;
  return Step::kWrite;
}

/// The message to be written now, if there is one.
const v1::MeshEvent* ChunkStream::next_event() {
  switch (phase_) {
    case Phase::kPlanning: {
      if (!std::exchange(progress_due_, false)) return nullptr;
      v1::MeshProgress& progress = *control_.mutable_progress();
      progress.set_done_bricks(static_cast<std::int64_t>(watch_->progress.done.load()));
      progress.set_total_bricks(static_cast<std::int64_t>(watch_->progress.total.load()));
      return &control_;
    }
    case Phase::kHeader: {
      v1::MeshHeader& header = *control_.mutable_header();
      to_proto(planned_.plan->header(), header);
      header.set_mesh_id(planned_.mesh_id);
      *header.mutable_canonical_request() = planned_.canonical;
      return &control_;
    }
    case Phase::kChunks:
      return slot_of(next_).ready ? &slot_of(next_).event : nullptr;
    case Phase::kTrailer: {
      v1::MeshTrailer& trailer = *control_.mutable_trailer();
      trailer.set_first_chunk(static_cast<std::int64_t>(order_.start_chunk));
      trailer.set_end_chunk(static_cast<std::int64_t>(end_));
      to_proto(quality_, *trailer.mutable_quality());
      return &control_;
    }
    case Phase::kEnded:
      break;
  }
  return nullptr;
}

void ChunkStream::OnWriteDone(bool ok) {
  {
    const std::lock_guard lock(mutex_);
    writing_ = false;
    if (!ok) {
      watch_->cancellation.cancel();
      end(client_gone(watch_->cancellation));
    }
    if (phase_ != Phase::kEnded) after_write();
  }
  advance();
}

void ChunkStream::after_write() {
  if (written_ == Phase::kPlanning) return;
  if (written_ == Phase::kTrailer) return end(absl::OkStatus());
  if (written_ == Phase::kChunks) after_chunk();
  if (next_ < end_) {
    phase_ = Phase::kChunks;
  } else if (end_ == planned_.plan->header().chunk_count) {
    phase_ = Phase::kTrailer;
  } else {
    end(absl::OkStatus());
  }
}

/// Counts the chunk that was written and reuses its slot.
void ChunkStream::after_chunk() {
  Slot& slot = slot_of(next_);
  const v1::MeshChunk& chunk = slot.event.chunk();
  quality_.add(slot.quality);
  tets_written_ += chunk.tet_count();
  bytes_written_ += chunk.positions().size() + chunk.tets().size() + chunk.regions().size();
  slot.ready = false;
  ++next_;
  post_chunks();
}

/// The call ends with `status` as soon as nothing is being written; the first status counts.
void ChunkStream::end(const absl::Status& status) {
  if (phase_ == Phase::kEnded) return;
  phase_ = Phase::kEnded;
  status_ = status;
}

void ChunkStream::OnCancel() {
  watch_->cancellation.cancel();
  {
    const std::lock_guard lock(mutex_);
    end(client_gone(watch_->cancellation));
  }
  advance();
}

void ChunkStream::OnDone() { const std::shared_ptr<ChunkStream> last = std::move(self_); }

}  // namespace tet
