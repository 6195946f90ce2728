#include "server/streams/remesh_stream.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>

#include "core/transfer/mesh_patch.h"
#include "core/volume/replace_leaves.h"
#include "proto/convert/request_rules.h"
#include "proto/convert/status.h"
#include "proto/wire/serialized.h"
#include "proto/wire/sha256.h"
#include "proto/wire/transport.h"
#include "server/meshing/mesh_events.h"
#include "server/ops/memory.h"
#include "server/rpc/explain.h"

namespace tet {

namespace {

static_assert(std::endian::native == std::endian::little);

absl::Status out_of_order(const char* message) {
  return with_reason(absl::InvalidArgumentError(message), "MESSAGE_ORDER");
}

/// Voxels of leaves begin at multiples of 8.
absl::StatusOr<BrickCoord> brick_of(const v1::LeafUpdate& leaf) {
  for (const auto& [axis, voxel] :
       {std::pair("x", leaf.x()), std::pair("y", leaf.y()), std::pair("z", leaf.z())}) {
    if (voxel % kBrickEdge == 0) continue;
    return invalid_field(absl::StrCat(axis, " ", voxel, " is not a multiple of ", kBrickEdge));
  }
  return BrickCoord{leaf.x() / kBrickEdge, leaf.y() / kBrickEdge, leaf.z() / kBrickEdge};
}

/// The new values of a frame's leaves.
class FrameLeaves {
 public:
  static absl::StatusOr<FrameLeaves> of(const v1::RemeshFrame& frame) {
    FrameLeaves leaves;
    std::size_t bytes = 0;
    for (const v1::LeafUpdate& leaf : frame.leaves()) bytes += leaf.values().size();
    leaves.values_.resize(bytes / sizeof(float));
    float* to = leaves.values_.data();
    for (int i = 0; i < frame.leaves_size(); ++i) {
      const v1::LeafUpdate& leaf = frame.leaves(i);
      const auto brick = brick_of(leaf);
      if (!brick.ok()) return within_field(absl::StrCat("leaves[", i, "]"), brick.status());
      const std::size_t count = leaf.values().size() / sizeof(float);
      const bool whole = leaf.values().size() % sizeof(float) == 0;
      if (!whole || (count != 1 && count != kBrickCells)) {
        return within_field(absl::StrCat("leaves[", i, "]"),
                            invalid_field(absl::StrCat("values has ", leaf.values().size(),
                                                       " bytes; a leaf has 2048, or 4")));
      }
      std::memcpy(to, leaf.values().data(), leaf.values().size());
      leaves.leaves_.push_back({*brick, {to, count}});
      to += count;
    }
    return leaves;
  }

  const std::vector<LeafValues>& leaves() const { return leaves_; }

 private:
  std::vector<float> values_;
  std::vector<LeafValues> leaves_;
};

/// Names a grid by the one before it and what was changed.
std::string digest_of(const std::string& before, const v1::RemeshFrame& frame) {
  Sha256 digest;
  digest.add(before);
  for (const v1::LeafUpdate& leaf : frame.leaves()) {
    digest.add(absl::StrCat("\n", leaf.x(), " ", leaf.y(), " ", leaf.z(), " ",
                            leaf.values().size(), "\n"));
    digest.add(leaf.values());
  }
  return digest.finish_hex();
}

}  // namespace

/// gRPC's side, with what it reads.
class RemeshStream::Reads final : public ChunkReactorOf<Reactor> {
 public:
  explicit Reads(std::shared_ptr<RemeshStream> stream)
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
  start_operation([this] { reads_->StartRead(&incoming_); });
}

void RemeshStream::read_done(bool ok) {
  {
    const std::lock_guard lock(read_mutex_);
    read_start_.reset();
  }
  if (!ok) return close(started_ ? absl::OkStatus() : out_of_order("it ended before `start`"));
  engine_.pool.post([self = self()] { self->guard([&] { self->take_message(); }); });
}

/// On the pool.
void RemeshStream::take_message() {
  if (!reopen()) return;
  v1::RemeshRequest message;
  const absl::Status taken = deserialize(incoming_, message)
                                 ? take(std::move(message))
                                 : out_of_order("bytes that are no message");
  if (!taken.ok()) return close(taken);
  ++frames_;
  watch_progress();
  queue();
}

absl::Status RemeshStream::take(v1::RemeshRequest message) {
  if (message.has_start() != !started_) {
    return out_of_order(started_ ? "a second `start`" : "a frame before `start`");
  }
  if (!started_) return within_field("start", take_start(message.start()));
  if (!message.has_frame()) return out_of_order("a message with neither `start` nor `frame`");
  return within_field("frame", take_frame(message.frame()));
}

absl::Status RemeshStream::take_start(const v1::MeshRequest& request) {
  if (auto status = check_rules(request, {Feature::kSession}); !status.ok()) return status;
  auto order = parse_mesh_request(request);
  if (!order.ok()) return order.status();
  started_ = true;
  request_ = request;
  order_ = *std::move(order);
  order_.space = call_.space();
  order_.is_frame = true;
  if (!order_.digest.empty()) call_.note("grid", order_.digest);
  return absl::OkStatus();
}

absl::Status RemeshStream::take_frame(const v1::RemeshFrame& frame) {
  keep_lattice();
  if (frame.has_scene()) return take_scene(frame.scene());
  return frame.leaves().empty() ? absl::OkStatus() : take_leaves(frame);
}

absl::Status RemeshStream::take_scene(const v1::Scene& scene) {
  if (!order_.is_scene()) {
    return invalid_field("scene is set, but the session began with a grid");
  }
  *request_.mutable_scene() = scene;
  auto order = parse_mesh_request(request_);
  if (!order.ok()) return order.status();
  order->space = order_.space;
  order->is_frame = true;
  order_ = *std::move(order);
  return absl::OkStatus();
}

absl::Status RemeshStream::take_leaves(const v1::RemeshFrame& frame) {
  if (order_.is_scene()) {
    return invalid_field("leaves are set, but the session began with a scene");
  }
  const auto leaves = FrameLeaves::of(frame);
  if (!leaves.ok()) return leaves.status();
  const Volume& before = *volume_of(source_.plan->shape());
  auto charged = charge(most_bytes_with(before, leaves->leaves()));
  if (!charged.ok()) return charged.status();
  auto changed = replace_leaves(before, leaves->leaves());
  if (!changed.ok()) {
    return invalid_field(absl::StrCat("leaves: ", changed.status().message()));
  }
  order_.volume = hold(*std::move(changed), *std::move(charged));
  // Grids of sizes and fields stay those of the file.
  auto& sizes = order_.request.sizing.grid;
  if (sizes && sizes->file.empty()) sizes->file = name_of_grid(order_.digest);
  for (VertexField& field : order_.request.fields) {
    if (field.file.empty()) field.file = name_of_grid(order_.digest);
  }
  order_.digest = digest_of(order_.digest, frame);
  return absl::OkStatus();
}

/// Memory of a changed grid, which counts for as long as this is there.
class RemeshStream::GridCharge {
 public:
  GridCharge(std::atomic<std::uint64_t>& all, std::uint64_t bytes) : all_(all), bytes_(bytes) {}
  ~GridCharge() { all_.fetch_sub(bytes_); }
  GridCharge(const GridCharge&) = delete;
  GridCharge& operator=(const GridCharge&) = delete;

  void shrink_to(std::uint64_t bytes) {
    if (bytes < bytes_) all_.fetch_sub(bytes_ - bytes);
    bytes_ = std::min(bytes, bytes_);
  }

 private:
  std::atomic<std::uint64_t>& all_;
  std::uint64_t bytes_;
};

/// Before anything is taken.
absl::StatusOr<std::shared_ptr<RemeshStream::GridCharge>> RemeshStream::charge(
    std::uint64_t bytes) {
  constexpr char kWhat[] = "bytes of sessions' changed grids";
  const std::uint64_t limit = session_bytes(engine_.config);
  if (bytes > limit) return over_limit(kWhat, bytes, limit);
  auto& held = engine_.activity.changed_grid_bytes;
  const std::uint64_t all = held.fetch_add(bytes) + bytes;
  auto charged = std::make_shared<GridCharge>(held, bytes);
  if (all <= limit) return charged;
  return with_retry(over_limit(kWhat, all, limit, "SERVER_BUSY"), absl::Seconds(1));
}

/// The grid, whose bytes count for as long as anyone has it.
std::shared_ptr<const Volume> RemeshStream::hold(Volume volume,
                                                 std::shared_ptr<GridCharge> charge) {
  charge->shrink_to(volume.size_bytes());
  return {new Volume(std::move(volume)),
          [charge = std::move(charge)](const Volume* gone) { delete gone; }};
}

/// All frames lie on the lattice of the first, about its origin: or nothing could be kept.
void RemeshStream::keep_lattice() {
  const v1::MeshRequest& first = planned_.canonical;
  const WorldPoint origin = source_.plan->header().origin;
  request_.set_spacing(first.spacing());
  request_.set_coordinate_type(first.coordinate_type());
  request_.mutable_origin()->set_x(origin.x);
  request_.mutable_origin()->set_y(origin.y);
  request_.mutable_origin()->set_z(origin.z);
  order_.request.spacing = first.spacing();
  order_.request.coordinates = source_.plan->header().coordinate_type;
  order_.request.origin = origin;
}

void RemeshStream::open() {
  engine_.planner.plan(call_.client(), order_, watch_,
                       [self = self()](absl::StatusOr<PlannedMesh> planned) {
                         self->guard([&] { self->planned(std::move(planned)); });
                       },
                       {.earlier = source_.plan});
}

void RemeshStream::planned(absl::StatusOr<PlannedMesh> planned) {
  if (!planned.ok()) return begin_chunks(planned.status(), 0, 0);
  const std::shared_ptr<const MeshPlan> earlier = std::move(source_.plan);
  planned_ = *std::move(planned);
  source_ = {planned_.plan, nullptr};
  source_.patch = MeshPatch::between(as_bricks(earlier), as_bricks(planned_.plan));
  begin_chunks(absl::OkStatus(), 0, 0);
}

void RemeshStream::note_opening() {
  call_.note("frames", frames_);
  if (!planned_.mesh_id.empty()) call_.note("mesh_id", planned_.mesh_id);
}

v1::MeshEvent RemeshStream::header() const { return header_event(planned_, source_); }

absl::StatusOr<ChunkMessage> RemeshStream::make(std::uint64_t index, Block block) {
  ChunkMessage made = make_chunk(source_, index, engine_.chunk_memory(), std::move(block));
  engine_.activity.chunks_made.fetch_add(1);
  return made;
}

v1::MeshEvent RemeshStream::trailer(std::uint64_t first,
                                    std::uint64_t end,
                                    const QualityStats& quality) const {
  return trailer_event(source_, first, end, quality);
}

void RemeshStream::sent_all() {
  give_turn_back();
  read();
}

std::optional<Stallable::Clock::time_point> RemeshStream::waiting_since() {
  if (const auto writing = ChunkStream::waiting_since()) return writing;
  const std::lock_guard lock(read_mutex_);
  // A client may think for longer than it may take over a message.
  const std::chrono::seconds most(engine_.config.session_idle_seconds);
  if (!read_start_ || Stallable::Clock::now() - *read_start_ < most) return std::nullopt;
  return read_start_;
}

void RemeshStream::give_up(std::chrono::seconds waited) {
  if (ChunkStream::waiting_since()) return ChunkStream::give_up(waited);
  close(client_stalled("sent no frame", waited));
}

}  // namespace tet
