#include "server/streams/mesh_stream.h"

#include <algorithm>
#include <utility>

#include <absl/strings/str_cat.h>

#include "core/fidelity/measure_plan.h"
#include "core/transfer/mesh_patch.h"
#include "proto/convert/fidelity.h"
#include "proto/convert/status.h"
#include "proto/wire/serialized.h"
#include "server/meshing/mesh_events.h"
#include "server/meshing/shared_chunk.h"
#include "server/ops/guard.h"

namespace tet {

namespace {

absl::StatusOr<StreamOrder> parse(grpc::ByteBuffer request) {
  v1::StreamMeshRequest message;
  if (!deserialize(request, message)) {
    return with_reason(absl::InvalidArgumentError("the request is not a StreamMeshRequest"),
                       "MALFORMED");
  }
  return parse_stream_request(message);
}

/// Whether it may be another thing in a moment.
bool will_pass(const absl::Status& failure) {
  return absl::IsUnavailable(failure) || has_retry(failure);
}

}  // namespace

grpc::ServerWriteReactor<grpc::ByteBuffer>* MeshStream::start(
    MeshEngine& engine, grpc::CallbackServerContext& context, const grpc::ByteBuffer& request) {
  const std::shared_ptr<MeshStream> stream(new MeshStream(engine, context));
  auto order = guarded("StreamMesh", [&] { return parse(request); });
  if (order.ok()) stream->order_ = std::move(*order);
  return ChunkStream::start(stream, order.status());
}

void MeshStream::admitted() {
  if (!order_.mesh.digest.empty()) call_.note("grid", order_.mesh.digest);
  order_.mesh.space = call_.space();
  claim_memory(order_.shared_memory, order_.shared_memory_events);
  watch_progress();
}

void MeshStream::open() {
  if (engine_.results == nullptr || order_.stored_name.empty()) return plan();
  engine_.short_tasks.post(call_.client(), [self = self()] {
    self->guard([&] { self->find_stored() ? self->begin(self->check_mesh()) : self->plan(); });
  });
}

/// By the request alone: neither the grid nor a plan is needed.
bool MeshStream::find_stored() {
  stored_ = StoredMesh::find(*engine_.results, order_.mesh.space, order_.stored_name,
                             order_.start_chunk, order_.end_chunk);
  return stored_ != nullptr;
}

/// A base that is not what the client has, or not here any more, is no reason to fail. But
/// whoever resumes has patches already, and chunks of the whole mesh are no use beside them:
/// where the base cannot be had at this moment alone, the client is to ask once more.
void MeshStream::plan() {
  if (order_.base_digest.empty()) return plan_mesh();
  MeshOrder base = order_.mesh;
  base.digest = order_.base_digest;
  engine_.planner.plan(call_.client(), std::move(base), watch_,
                       [self = self()](const absl::StatusOr<PlannedMesh>& planned) {
                         if (self->order_.start_chunk > 0 && will_pass(planned.status())) {
                           return self->begin(planned.status());
                         }
                         const bool found =
                             planned.ok() && planned->mesh_id == self->order_.base_mesh_id;
                         if (found) self->base_ = planned->plan;
                         self->guard([&] { self->plan_mesh(); });
                       });
}

void MeshStream::plan_mesh() {
  engine_.planner.plan(call_.client(), order_.mesh, watch_,
                       [self = self()](absl::StatusOr<PlannedMesh> planned) {
                         if (self->gives_up_base(planned.status())) {
                           return self->guard([&] { self->plan_mesh(); });
                         }
                         if (!planned.ok()) return self->begin(planned.status());
                         self->planned_ = *std::move(planned);
                         self->guard([&] { self->find_patches(); });
                       },
                       {.earlier = base_});
}

/// Whether the mesh is to be planned once more, without the base: there may never be room for
/// both. Patches that the client has would be of no use then.
bool MeshStream::gives_up_base(const absl::Status& failure) {
  if (order_.start_chunk > 0 || !has_retry(failure)) return false;
  return std::exchange(base_, nullptr) != nullptr;
}

void MeshStream::find_patches() {
  const std::shared_ptr<const MeshPlan> base = std::exchange(base_, nullptr);
  source_ = {planned_.plan, nullptr, order_.encoding};
  source_.patch =
      MeshPatch::between(as_bricks(base), as_bricks(planned_.plan), watch_->cancellation);
  if (const auto s = check_cancelled(watch_->cancellation); !s.ok()) return begin(s);
  // A client that has more chunks than there are patches has those of the whole mesh.
  if (order_.start_chunk > source_.chunk_count()) source_.patch = nullptr;
  // A patch has no compact form: its vertices may belong to tets that the client keeps.
  const bool is_compact = order_.encoding == v1::ENCODING_COMPACT;
  if (source_.patch != nullptr && is_compact) source_.encoding = v1::ENCODING_PACKED;
  // Asked for in other words than a job that has made it.
  if (engine_.results != nullptr && !order_.stored_name.empty()) {
    stored_ = StoredMesh::find(*engine_.results, order_.mesh.space, plan_of(planned_),
                               order_.start_chunk, order_.end_chunk);
  }
  const absl::Status fits = reserve_for_fidelity();
  begin(fits.ok() ? check_mesh() : fits);
}

/// Before the header: whoever cannot have it is told at once.
absl::Status MeshStream::reserve_for_fidelity() {
  if (!order_.mesh.request.fidelity) return absl::OkStatus();
  auto reserved = engine_.planner.reserve(
      fidelity_bytes(*planned_.plan, engine_.pool.threads()),
      "bytes of counted meshes in memory, with what measures this one's fidelity (a larger "
      "spacing takes fewer, and a request without fidelity none)");
  if (!reserved.ok()) return reserved.status();
  reserved_ = *std::move(reserved);
  return absl::OkStatus();
}

/// The stream has not begun to be written when this is asked, and the trailer waits for it:
/// what it measures has one writer, and then readers.
std::function<absl::Status()> MeshStream::work_for_trailer() {
  if (!order_.mesh.request.fidelity || stored_ != nullptr) return nullptr;
  return [this] {
    auto measured = fidelity_of(*planned_.plan, order_.mesh.request, watch_->cancellation);
    reserved_ = nullptr;
    if (!measured.ok()) return measured.status();
    fidelity_ = *std::move(measured);
    return absl::OkStatus();
  };
}

absl::Status MeshStream::check_shareable() const {
  const bool plain = stored_ == nullptr && source_.encoding != v1::ENCODING_PACKED &&
                     source_.encoding != v1::ENCODING_COMPACT;
  return plain ? check_not_read_back(source_)
               : absl::FailedPreconditionError("chunks are stored, packed or compact");
}

const std::string& MeshStream::mesh_id() const {
  return stored_ ? stored_->plan().header().mesh_id() : planned_.mesh_id;
}

absl::Status MeshStream::check_mesh() const {
  if (order_.expected_mesh_id.empty() || order_.expected_mesh_id == mesh_id()) {
    return absl::OkStatus();
  }
  return with_reason(
      absl::FailedPreconditionError(absl::StrCat("expected_mesh_id ", order_.expected_mesh_id,
                                                 " is not this mesh's, ", mesh_id())),
      "OTHER_MESH");
}

/// Whoever resumes may have more patches of an update than the whole mesh has chunks. Where the
/// base is not here any more, the header says so, and the client asks for all of them.
void MeshStream::begin(const absl::Status& planned) {
  std::uint64_t start = order_.start_chunk;
  if (planned.ok() && !order_.base_digest.empty()) start = std::min(start, chunk_count());
  begin_chunks(planned, start, order_.end_chunk);
}

/// How long planning took, and what of.
void MeshStream::note_opening() {
  engine_.calls.metrics().planned(call_.seconds());
  call_.note("plan_ms", 1e3 * call_.seconds());
  if (!mesh_id().empty()) call_.note("mesh_id", mesh_id());
  if (stored_ == nullptr) return;
  call_.note("cached", true);
  engine_.activity.cached_streams.fetch_add(1);
}

std::uint64_t MeshStream::chunk_count() const {
  return stored_ ? stored_->chunk_count() : source_.chunk_count();
}

v1::MeshEvent MeshStream::header() const {
  if (stored_ == nullptr) return header_event(planned_, source_);
  v1::MeshEvent event;
  *event.mutable_header() = stored_->plan().header();
  event.mutable_header()->set_cached(true);
  return event;
}

absl::StatusOr<ChunkMessage> MeshStream::make(std::uint64_t index, Block block) {
  if (stored_ != nullptr) return read(index, std::move(block));
  return make_mesh_chunk(source_, index, std::move(block));
}

/// A chunk that turns out to be damaged is set aside: whoever comes back for it has it made.
absl::StatusOr<ChunkMessage> MeshStream::read(std::uint64_t index, Block block) {
  auto chunk = stored_->chunk(index, engine_.blocks, std::move(block.lease));
  if (!absl::IsDataLoss(chunk.status())) return chunk;
  return with_retry(
      with_reason(absl::UnavailableError(absl::StrCat(
                      "chunk ", index, " was stored, and is damaged; resume there")),
                  "CHUNK_DAMAGED"),
      absl::ZeroDuration());
}

v1::MeshEvent MeshStream::trailer(std::uint64_t first,
                                  std::uint64_t end,
                                  const QualityStats& quality) const {
  if (stored_) return trailer_event(stored_->plan(), first, end, quality);
  v1::MeshEvent event = trailer_event(source_, first, end, quality);
  if (fidelity_) to_proto(*fidelity_, *event.mutable_trailer());
  return event;
}

}  // namespace tet
