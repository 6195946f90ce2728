#include "server/streams/remesh_stream.h"

#include <utility>

#include <absl/strings/str_cat.h>

#include "core/transfer/mesh_patch.h"
#include "core/volume/replace_leaves.h"
#include "proto/convert/request_rules.h"
#include "proto/convert/status.h"
#include "proto/wire/serialized.h"
#include "proto/wire/sha256.h"
#include "server/meshing/mesh_events.h"
#include "server/ops/memory.h"
#include "server/rpc/explain.h"

namespace tet {

namespace {

absl::Status out_of_order(const char* message) {
  return with_reason(absl::InvalidArgumentError(message), "MESSAGE_ORDER");
}

/// Whether that is the frame's own affair, and the next may fare better.
bool concerns_frame(const absl::Status& why) {
  switch (why.code()) {
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kNotFound:
    case absl::StatusCode::kFailedPrecondition:
    case absl::StatusCode::kOutOfRange:
    case absl::StatusCode::kResourceExhausted:
      return true;
    default:
      return false;
  }
}

/// Tells it in the fields of a google.rpc.Status.
v1::FrameRefusal refusal_of(const absl::Status& why) {
  v1::FrameRefusal refusal;
  refusal.ParseFromString(to_grpc(why).error_details());
  return refusal;
}

}  // namespace

/// gRPC's side, with what it reads.
class RemeshStream::Reads final : public ChunkReactorOf<Reactor> {
 public:
  explicit Reads(const std::shared_ptr<RemeshStream>& stream)
      : ChunkReactorOf<Reactor>(stream), session_(*stream) {}

  void OnReadDone(bool ok) override { session_.read_done(ok); }

 private:
  RemeshStream& session_;  ///< the base keeps it alive
};

RemeshStream::Reactor* RemeshStream::start(MeshEngine& engine,
                                           grpc::CallbackServerContext& context) {
  const std::shared_ptr<RemeshStream> session(new RemeshStream(engine, context));
  auto* const reads = new Reads(session);  // ends itself
  session->reads_ = reads;
  session->begin(*reads, absl::OkStatus());
  return reads;
}

void RemeshStream::read() {
  {
    const std::lock_guard lock(read_mutex_);
    read_start_ = Stallable::Clock::now();
  }
  start_operation([this] { reads_->StartRead(&incoming_message_); });
}

void RemeshStream::read_done(bool ok) {
  {
    const std::lock_guard lock(read_mutex_);
    read_start_.reset();
  }
  if (!ok) return close(why_unfinished());
  engine_.short_tasks.post(call_.client(),
                           [self = self()] { self->guard([&] { self->take_message(); }); });
}

/// OK where a session may end.
absl::Status RemeshStream::why_unfinished() const {
  if (in_frame_) return out_of_order("it ended before the `frame` of its last `part`");
  return started_ ? absl::OkStatus() : out_of_order("it ended before `start`");
}

/// In one of the client's tasks.
void RemeshStream::take_message() {
  v1::RemeshRequest message;
  const absl::Status ordered = deserialize(incoming_message_, message)
                                   ? check_order(message)
                                   : out_of_order("bytes that are no message");
  if (!ordered.ok()) return close(ordered);
  if (message.has_part()) {
    take_part(message.part());
    return read();
  }
  if (!reopen()) return;
  ++frames_;
  const absl::Status taken =
      message.has_start() ? take_start(message) : take_frame(message.frame());
  if (!taken.ok()) return begin_chunks(taken, 0, 0);
  watch_progress();
  queue();
}

absl::Status RemeshStream::check_order(const v1::RemeshRequest& message) const {
  if (message.has_start() && started_) return out_of_order("a second `start`");
  if (!message.has_start() && !started_) return out_of_order("a frame before `start`");
  if (message.has_start() || message.has_frame() || message.has_part()) return absl::OkStatus();
  return out_of_order("a message with neither `start` nor `frame`");
}

absl::Status RemeshStream::take_start(const v1::RemeshRequest& message) {
  started_ = true;
  tells_refusals_ = message.tell_refusals();
  if (message.loose_patches()) detail_ = PatchDetail::kSlices;
  claim_memory(message.shared_memory(), message.shared_memory_events());
  return within_field("start", take_start(message.start()));
}

absl::Status RemeshStream::take_start(const v1::MeshRequest& request) {
  if (auto status = check_rules(request, {Feature::kSession}); !status.ok()) return status;
  auto order = parse_mesh_request(request);
  if (!order.ok()) return order.status();
  next_ = {request, *std::move(order)};
  // What no field is known for says nothing, and would be kept as long as the session.
  next_.request.DiscardUnknownFields();
  next_.order.space = call_.space();
  next_.order.is_frame = true;
  if (!next_.order.digest.empty()) note_from_task("grid", next_.order.digest);
  return absl::OkStatus();
}

/// A frame is answered when it is whole: what comes of one that is refused is not looked at.
void RemeshStream::take_part(const v1::RemeshFrame& part) {
  in_frame_ = true;
  if (!incoming_status_.ok()) return;
  incoming_status_ =
      part.has_scene() ? invalid_field("scene is set in a `part`, but a scene is one message's")
                       : gather_leaves(part);
  if (!incoming_status_.ok()) incoming_.reset();
}

absl::Status RemeshStream::take_frame(const v1::RemeshFrame& frame) {
  const bool has_leaves = in_frame_.exchange(false) || !frame.leaves().empty();
  begin_frame();
  absl::Status status = std::exchange(incoming_status_, absl::OkStatus());
  if (!status.ok()) return within_field("frame", status);
  if (frame.has_scene()) {
    status = incoming_ ? invalid_field("scene is set, and so are leaves")
                       : take_scene(frame.scene());
  } else if (has_leaves) {
    status = gather_leaves(frame);
    if (status.ok()) status = replace();
  }
  incoming_.reset();
  return within_field("frame", status);
}

absl::Status RemeshStream::take_scene(const v1::Scene& scene) {
  if (!next_.order.is_scene()) {
    return invalid_field("scene is set, but the session began with a grid");
  }
  *next_.request.mutable_scene() = scene;
  next_.request.mutable_scene()->DiscardUnknownFields();
  auto order = parse_mesh_request(next_.request);
  if (!order.ok()) return order.status();
  order->space = next_.order.space;
  order->is_frame = true;
  next_.order = *std::move(order);
  return absl::OkStatus();
}

/// Nothing yet of the memory for changed grids.
std::shared_ptr<CallCharge> RemeshStream::no_charge() {
  return std::make_shared<CallCharge>("bytes of sessions' changed grids",
                                      engine_.activity.changed_grid_bytes,
                                      session_bytes(engine_.config));
}

absl::Status RemeshStream::gather_leaves(const v1::RemeshFrame& message) {
  if (shown_.order.is_scene()) {
    return invalid_field("leaves are set, but the session began with a scene");
  }
  if (!incoming_) {
    incoming_.emplace(shown_.order.digest, no_charge());
  }
  return incoming_->add(message);
}

/// The grid becomes that with the leaves that came.
absl::Status RemeshStream::replace() {
  const Volume& before = *volume_of(source_.plan->shape());
  auto charge = no_charge();
  const absl::Status charged = charge->add(most_bytes_with(before, incoming_->leaves()));
  if (!charged.ok()) return charged;
  auto changed = replace_leaves(before, incoming_->leaves(), watch_->cancellation);
  if (!absl::IsInvalidArgument(changed.status()) && !changed.ok()) return changed.status();
  if (!changed.ok()) {
    return invalid_field(absl::StrCat("leaves: ", changed.status().message()));
  }
  std::vector<BrickCoord> replaced;
  replaced.reserve(incoming_->leaves().size());
  for (const LeafValues& leaf : incoming_->leaves()) replaced.push_back(leaf.brick);
  replaced_ = std::make_shared<const std::vector<BrickCoord>>(std::move(replaced));
  MeshOrder& order = next_.order;
  order.volume = hold(*std::move(changed), std::move(charge));
  // Grids of sizes and fields stay those of the file.
  auto& sizes = order.request.sizing.grid;
  if (sizes && sizes->file.empty()) sizes->file = name_of_grid(order.digest);
  for (VertexField& field : order.request.fields) {
    if (field.file.empty()) field.file = name_of_grid(order.digest);
  }
  order.digest = incoming_->digest();
  return absl::OkStatus();
}

/// The grid, whose bytes count for as long as anyone has it.
std::shared_ptr<const Volume> RemeshStream::hold(Volume volume,
                                                 std::shared_ptr<CallCharge> charge) {
  charge->shrink_to(volume.size_bytes());
  return {new Volume(std::move(volume)),
          [charge = std::move(charge)](const Volume* gone) { delete gone; }};
}

/// All frames lie on the lattice of the first, about its origin: or nothing could be kept.
void RemeshStream::begin_frame() {
  next_ = shown_;
  replaced_ = nullptr;
  const v1::MeshRequest& first = planned_.canonical;
  const WorldPoint origin = source_.plan->header().origin;
  next_.request.set_spacing(first.spacing());
  next_.request.set_coordinate_type(first.coordinate_type());
  next_.request.mutable_origin()->set_x(origin.x);
  next_.request.mutable_origin()->set_y(origin.y);
  next_.request.mutable_origin()->set_z(origin.z);
  next_.order.request.spacing = first.spacing();
  next_.order.request.coordinates = source_.plan->header().coordinate_type;
  next_.order.request.origin = origin;
}

void RemeshStream::open() {
  engine_.planner.plan(
      call_.client(), next_.order, watch_,
      [self = self()](absl::StatusOr<PlannedMesh> planned) {
        self->guard([&] { self->planned(std::move(planned)); });
      },
      {.earlier = source_.plan, .replaced = std::exchange(replaced_, nullptr)});
}

void RemeshStream::planned(absl::StatusOr<PlannedMesh> planned) {
  if (!planned.ok()) return begin_chunks(planned.status(), 0, 0);
  const std::shared_ptr<const MeshPlan> earlier = std::move(source_.plan);
  planned_ = *std::move(planned);
  shown_ = std::exchange(next_, {});
  source_ = {planned_.plan, nullptr};
  source_.patch = MeshPatch::between(as_bricks(earlier), as_bricks(planned_.plan),
                                     watch_->cancellation, detail_);
  begin_chunks(check_cancelled(watch_->cancellation), 0, 0);
}

void RemeshStream::note_opening() {
  call_.note("frames", frames_);
  if (!planned_.mesh_id.empty()) call_.note("mesh_id", planned_.mesh_id);
}

v1::MeshEvent RemeshStream::header() const { return header_event(planned_, source_); }

absl::StatusOr<ChunkMessage> RemeshStream::make(std::uint64_t index, Block block) {
  return make_mesh_chunk(source_, index, std::move(block));
}

v1::MeshEvent RemeshStream::trailer(std::uint64_t first,
                                    std::uint64_t end,
                                    const QualityStats& quality) const {
  return trailer_event(source_, first, end, quality);
}

std::optional<v1::MeshEvent> RemeshStream::refuse(const absl::Status& why) {
  const bool is_first = frames_ == 1;
  if (is_first || !tells_refusals_ || !concerns_frame(why)) return std::nullopt;
  next_ = {};
  v1::MeshEvent event;
  *event.mutable_refused() = refusal_of(why);
  return event;
}

void RemeshStream::sent_all() {
  give_turn_back();
  read();
}

std::optional<Stallable::Wait> RemeshStream::wait(std::chrono::seconds limit) {
  if (const auto writing = ChunkStream::wait(limit)) return writing;
  const std::lock_guard lock(read_mutex_);
  // A client may think for longer than it may take over a message, or a frame's next part.
  if (!read_start_) return std::nullopt;
  const std::chrono::seconds of_frame(engine_.config.stall_seconds);
  return Wait{*read_start_, in_frame_ ? of_frame : engine_.session_idle()};
}

void RemeshStream::give_up(std::chrono::seconds waited) {
  if (ChunkStream::waiting_since()) return ChunkStream::give_up(waited);
  close(client_stalled("sent no frame", waited));
}

}  // namespace tet
