#include "server/chunk_stream.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <string_view>
#include <utility>

#include <absl/strings/str_cat.h>
#include <grpc/grpc.h>

#include "proto/wire/checksum.h"
#include "proto/wire/chunk_frame.h"
#include "proto/wire/serialized.h"
#include "server/status.h"

namespace tet {

namespace {

constexpr std::chrono::milliseconds kProgressInterval{200};

absl::StatusOr<StreamOrder> parse(grpc::ByteBuffer request) {
  v1::StreamMeshRequest message;
  if (!deserialize(request, message)) {
    return with_reason(absl::InvalidArgumentError("the request is not a StreamMeshRequest"),
                       "MALFORMED");
  }
  return parse_stream_request(message);
}

std::uint32_t checksum_of(const ChunkColumns& columns) {
  const auto text = [](std::span<const std::byte> bytes) {
    return std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  return chunk_checksum(text(columns.positions), text(columns.tets), text(columns.regions));
}

}  // namespace

grpc::ServerWriteReactor<grpc::ByteBuffer>* ChunkStream::start(
    MeshEngine& engine, grpc::CallbackServerContext& context, const grpc::ByteBuffer& request) {
  const std::shared_ptr<ChunkStream> stream(new ChunkStream(engine, context));
  stream->self_ = stream;
  engine.stalls.add(stream);
  stream->begin(request);
  return stream.get();
}

ChunkStream::ChunkStream(MeshEngine& engine, grpc::CallbackServerContext& context)
    : engine_(engine),
      context_(context),
      call_(engine.calls, context, "StreamMesh"),
      watch_(std::make_shared<PlanningWatch>(context.deadline())) {}

void ChunkStream::begin(const grpc::ByteBuffer& request) {
  auto order = parse(request);
  const absl::Status admitted = call_.admission();
  const absl::Status status = admitted.ok() ? order.status() : admitted;
  if (!status.ok()) {
    end(status);
    return advance();
  }
  call_.note("grid", order->mesh.digest);
  order_ = *std::move(order);
  order_.mesh.space = call_.space();
  call_.on_cut([weak = weak_from_this()] {
    if (const auto self = weak.lock()) self->cut();
  });
  watch_progress();
  place_ = engine_.admit(call_, watch_->cancellation.deadline(),
                         [self = shared_from_this()](absl::StatusOr<Ticket> ticket) {
                           self->plan(std::move(ticket));
                         });
}

void ChunkStream::plan(absl::StatusOr<Ticket> ticket) {
  if (!ticket.ok()) return begin_chunks(ticket.status());
  {
    const std::lock_guard lock(mutex_);
    if (phase_ == Phase::kEnded) return;
    ticket_ = *std::move(ticket);
  }
  engine_.planner.plan(call_.client(), order_.mesh, watch_,
                       [self = shared_from_this()](absl::StatusOr<PlannedMesh> planned) {
                         self->plan_base(std::move(planned));
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

/// Only this task touches the plan until there are chunks: nobody needs the lock.
void ChunkStream::plan_base(absl::StatusOr<PlannedMesh> planned) {
  if (!planned.ok()) return begin_chunks(planned.status());
  planned_ = *std::move(planned);
  if (order_.base_digest.empty()) return begin_chunks(absl::OkStatus());
  MeshOrder base = order_.mesh;
  base.digest = order_.base_digest;
  engine_.planner.plan(call_.client(), std::move(base), watch_,
                       [self = shared_from_this()](absl::StatusOr<PlannedMesh> planned_base) {
                         self->find_patches(planned_base);
                       });
}

/// A base that is not what the client has, or not here any more, is no reason to fail.
void ChunkStream::find_patches(const absl::StatusOr<PlannedMesh>& base) {
  if (base.ok() && base->mesh_id == order_.base_mesh_id) {
    patch_ = MeshPatch::between(*base->plan, planned_.plan);
  }
  begin_chunks(absl::OkStatus());
}

void ChunkStream::begin_chunks(const absl::Status& planned) {
  {
    const std::lock_guard lock(mutex_);
    if (phase_ == Phase::kEnded) return;
    note_plan();
    const absl::Status status = planned.ok() ? check_range() : planned;
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

/// How long planning took, and what of.
void ChunkStream::note_plan() {
  engine_.calls.metrics().planned(call_.seconds());
  call_.note("plan_ms", 1e3 * call_.seconds());
  if (planned_.plan != nullptr) call_.note("mesh_id", planned_.mesh_id);
}

/// Settles which chunks to send.
absl::Status ChunkStream::check_range() {
  if (!order_.expected_mesh_id.empty() && order_.expected_mesh_id != planned_.mesh_id) {
    return with_reason(
        absl::FailedPreconditionError(absl::StrCat("expected_mesh_id ", order_.expected_mesh_id,
                                                   " is not this mesh's, ", planned_.mesh_id)),
        "OTHER_MESH");
  }
  const std::uint64_t count = chunk_count();
  end_ = order_.end_chunk == 0 ? count : order_.end_chunk;
  next_ = posted_ = order_.start_chunk;
  if (next_ <= end_ && end_ <= count) return absl::OkStatus();
  return with_reason(absl::OutOfRangeError(absl::StrCat("chunks ", next_, " to ", end_,
                                                        " are not within the mesh's ", count)),
                     "CHUNK_RANGE");
}

std::uint64_t ChunkStream::chunk_count() const {
  return patch_ ? patch_->patch_count() : planned_.plan->header().chunk_count;
}

/// Chunks made ahead: enough of all streams together to keep every thread busy, but two a
/// stream; and one where blocks are scarce.
std::uint64_t ChunkStream::window() const {
  if (engine_.send_budget.is_tight()) return 1;
  const auto streams = static_cast<std::uint64_t>(engine_.activity.meshes.load());
  return std::clamp<std::uint64_t>(slots_.size() / std::max<std::uint64_t>(streams, 1),
                                   std::min<std::uint64_t>(slots_.size(), 2), slots_.size());
}

/// Fills the window.
void ChunkStream::post_chunks() {
  const std::uint64_t ahead = window();
  while (posted_ < end_ && posted_ < next_ + ahead) ask_for_block(posted_++);
}

void ChunkStream::ask_for_block(std::uint64_t index) {
  engine_.send_budget.ask(
      this, call_.client(), [self = shared_from_this(), index](const Block& block) {
        self->engine_.activity.chunks_in_flight.fetch_add(1);
        self->engine_.chunk_tasks.post(
            self->call_.client(), [self, index, block] { self->make_chunk(index, block); });
      });
}

// Only this task touches the slot until it is ready: nobody needs the lock while it is filled.
void ChunkStream::make_chunk(std::uint64_t index, Block block) {
  Slot& slot = slot_of(index);
  const bool wanted = !watch_->cancellation.requested();
  if (wanted) {
    order_.compact ? encode(index, slot, std::move(block))
                   : fill(index, slot, std::move(block));
  }
  engine_.activity.chunks_in_flight.fetch_sub(1);
  {
    const std::lock_guard lock(mutex_);
    slot.ready = wanted;
    if (!wanted) end(client_gone(watch_->cancellation));
  }
  advance();
}

void ChunkStream::fill(std::uint64_t index, Slot& slot, Block block_lease) {
  const MeshPlan& plan = *planned_.plan;
  const ChunkExtent extent = patch_ ? patch_->extent(index) : plan.chunk(index);
  const ChunkSizes size(plan.header(), extent.vertex_count, extent.tet_count);
  const ChunkFrame frame({size.positions, size.tets, size.regions});
  const grpc::Slice slice = engine_.blocks.take(frame.block_bytes(), std::move(block_lease));
  auto* const block = reinterpret_cast<std::byte*>(const_cast<std::uint8_t*>(slice.begin()));
  const ChunkColumns columns{frame.positions(block), frame.tets(block), frame.regions(block)};

  MeshWorkspace workspace = engine_.workspaces.take();
  slot.quality = patch_ ? patch_->fill(index, workspace, columns)
                        : plan.fill_chunk(index, workspace, columns);
  engine_.workspaces.give_back(std::move(workspace));
  const auto parts =
      frame.write(block, {index, extent.first_vertex, extent.vertex_count, extent.first_tet,
                          extent.tet_count, checksum_of(columns)});
  const std::array<grpc::Slice, 3> slices = {slice.sub(parts[0].begin, parts[0].end),
                                             slice.sub(parts[1].begin, parts[1].end),
                                             slice.sub(parts[2].begin, parts[2].end)};
  slot.message = grpc::ByteBuffer(slices.data(), size.regions == 0 ? 2 : 3);
  slot.tets = extent.tet_count;
  slot.bytes = size.total();
  engine_.activity.chunks_made.fetch_add(1);
}

void ChunkStream::encode(std::uint64_t index, Slot& slot, Block block) {
  const MeshPlan& plan = *planned_.plan;
  const ChunkExtent extent = plan.chunk(index);
  std::vector<std::byte> bytes;
  MeshWorkspace workspace = engine_.workspaces.take();
  plan.encode_chunk(index, workspace, bytes);
  engine_.workspaces.give_back(std::move(workspace));

  v1::MeshEvent event;
  v1::MeshChunk& chunk = *event.mutable_chunk();
  chunk.set_index(static_cast<std::int64_t>(index));
  chunk.set_first_vertex(static_cast<std::int64_t>(extent.first_vertex));
  chunk.set_vertex_count(static_cast<std::int64_t>(extent.vertex_count));
  chunk.set_first_tet(static_cast<std::int64_t>(extent.first_tet));
  chunk.set_tet_count(static_cast<std::int64_t>(extent.tet_count));
  chunk.set_checksum(add_to_checksum(0, bytes));
  chunk.set_compact(bytes.data(), bytes.size());
  block->shrink_to(bytes.size());
  slot.message = serialized(event, std::move(block));
  slot.tets = extent.tet_count;
  slot.bytes = bytes.size();
  engine_.activity.chunks_made.fetch_add(1);
}

/// Takes one step if there is one to take. gRPC is called without the lock; `writing_` and
/// `finished_` keep others out meanwhile.
void ChunkStream::advance() {
  switch (next_step()) {
    case Step::kWait:
      return;
    case Step::kWrite:
      return StartWrite(&outgoing_);
    case Step::kFinish:
      make_room();
      return Finish(call_.finish(status_));
  }
}

/// Whoever sees the stream's end may begin the next at once.
void ChunkStream::make_room() {
  Ticket last;  // given back without the lock
  const std::lock_guard lock(mutex_);
  last.swap(ticket_);
}

ChunkStream::Step ChunkStream::next_step() {
  const std::lock_guard lock(mutex_);
  if (writing_ || finished_ || cancelling_) return Step::kWait;
  if (phase_ == Phase::kEnded) {
    finished_ = true;
    progress_timer_.reset();
    call_.note("tets", tets_written_);
    call_.note("chunks", next_ - std::min(next_, order_.start_chunk));
    call_.note("bytes_out", bytes_written_);
    return Step::kFinish;
  }
  if (!prepare_message()) return Step::kWait;
  writing_ = true;
  write_start_ = Stallable::Clock::now();
  written_ = phase_;
  return Step::kWrite;
}

/// The message to be written now, if there is one, becomes `outgoing_`.
bool ChunkStream::prepare_message() {
  switch (phase_) {
    case Phase::kPlanning:
      if (!std::exchange(progress_due_, false)) return false;
      outgoing_ = serialized(progress_event());
      return true;
    case Phase::kHeader:
      outgoing_ = serialized(header_event());
      return true;
    case Phase::kChunks:
      if (!slot_of(next_).ready) return false;
      outgoing_.Swap(&slot_of(next_).message);
      return true;
    case Phase::kTrailer:
      outgoing_ = serialized(trailer_event());
      return true;
    case Phase::kEnded:
      break;
  }
  return false;
}

v1::MeshEvent ChunkStream::progress_event() const {
  v1::MeshEvent event;
  v1::MeshProgress& progress = *event.mutable_progress();
  progress.set_done_bricks(static_cast<std::int64_t>(watch_->progress.done.load()));
  progress.set_total_bricks(static_cast<std::int64_t>(watch_->progress.total.load()));
  return event;
}

v1::MeshEvent ChunkStream::header_event() const {
  v1::MeshEvent event;
  v1::MeshHeader& header = *event.mutable_header();
  to_proto(planned_.plan->header(), header);
  header.set_mesh_id(planned_.mesh_id);
  *header.mutable_canonical_request() = planned_.canonical;
  if (patch_) {
    to_proto(patch_->kept(), *header.mutable_kept());
    header.mutable_kept()->set_patch_count(static_cast<std::int64_t>(patch_->patch_count()));
  }
  if (order_.compact) {
    to_proto(planned_.plan->compact_frame().to_world, *header.mutable_lattice());
  }
  return event;
}

v1::MeshEvent ChunkStream::trailer_event() const {
  v1::MeshEvent event;
  v1::MeshTrailer& trailer = *event.mutable_trailer();
  trailer.set_first_chunk(static_cast<std::int64_t>(order_.start_chunk));
  trailer.set_end_chunk(static_cast<std::int64_t>(end_));
  if (!order_.compact) to_proto(quality_, *trailer.mutable_quality());
  const auto& boundary = planned_.plan->boundary();
  if (boundary) to_proto(*boundary, *trailer.mutable_boundary());
  const auto& improvement = planned_.plan->improvement();
  if (improvement) to_proto(*improvement, *trailer.mutable_improvement());
  to_proto(planned_.plan->thin_walls(), *trailer.mutable_thin_walls());
  return event;
}

void ChunkStream::OnWriteDone(bool ok) {
  {
    const std::lock_guard lock(mutex_);
    writing_ = false;
    outgoing_.Clear();  // its block is gRPC's alone now
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
  } else if (end_ == chunk_count()) {
    phase_ = Phase::kTrailer;
  } else {
    end(absl::OkStatus());
  }
}

/// Counts the chunk that was written and reuses its slot.
void ChunkStream::after_chunk() {
  Slot& slot = slot_of(next_);
  if (next_ == order_.start_chunk) {
    engine_.calls.metrics().first_chunk(call_.seconds());
    call_.note("first_chunk_ms", 1e3 * call_.seconds());
  }
  engine_.calls.metrics().chunk_sent(slot.tets, slot.bytes);
  quality_.add(slot.quality);
  tets_written_ += slot.tets;
  bytes_written_ += slot.bytes;
  slot.ready = false;
  ++next_;
  post_chunks();
}

/// The call ends with `status` as soon as nothing is being written; the first status counts.
void ChunkStream::end(const absl::Status& status) {
  if (phase_ == Phase::kEnded) return;
  phase_ = Phase::kEnded;
  status_ = status;
  engine_.send_budget.leave(this);
}

std::optional<Stallable::Clock::time_point> ChunkStream::waiting_since() {
  const std::lock_guard lock(mutex_);
  if (!writing_ || phase_ == Phase::kEnded) return std::nullopt;
  return write_start_;
}

/// The message being written bars the way to any status, so the call is cancelled with it. That
/// may bring events here and now, so not under the lock; and gRPC must not be done meanwhile.
void ChunkStream::give_up(std::chrono::seconds waited) {
  const absl::Status status = client_stalled("took nothing", waited);
  {
    const std::lock_guard lock(mutex_);
    if (!writing_ || phase_ == Phase::kEnded) return;
    end(status);
    cancelling_ = true;
  }
  watch_->cancellation.cancel();
  grpc_call_cancel_with_status(context_.c_call(), GRPC_STATUS_ABORTED,
                               std::string(status.message()).c_str(), nullptr);
  {
    const std::lock_guard lock(mutex_);
    cancelling_ = false;
  }
  advance();
}

/// The server stops: the client goes on elsewhere, with the chunks it has.
void ChunkStream::cut() {
  {
    const std::lock_guard lock(mutex_);
    end(shutting_down());
  }
  watch_->cancellation.cancel();
  advance();
}

void ChunkStream::OnCancel() {
  watch_->cancellation.cancel();
  engine_.calls.admission().leave(place_);
  {
    const std::lock_guard lock(mutex_);
    end(client_gone(watch_->cancellation));
  }
  advance();
}

void ChunkStream::OnDone() { const std::shared_ptr<ChunkStream> last = std::move(self_); }

}  // namespace tet
