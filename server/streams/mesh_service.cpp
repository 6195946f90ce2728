#include "server/streams/mesh_service.h"

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <utility>

#include "core/fidelity/measure_plan.h"
#include "core/plan/make/fill_estimate.h"
#include "proto/convert/mesh_header.h"
#include "proto/convert/request.h"
#include "proto/convert/status.h"
#include "server/ops/guard.h"
#include "server/ops/memory.h"
#include "server/rpc/deadline.h"
#include "server/streams/mesh_stream.h"
#include "server/streams/mesher_turn.h"
#include "server/streams/remesh_stream.h"
#include "server/streams/sample_stream.h"

namespace tet {

namespace {

constexpr std::chrono::milliseconds kIdleEstimate{200};
/// How long an estimate may make chunks to see what that takes: less than a short turn of
/// plans.
constexpr std::chrono::milliseconds kTrying{20};

/// One EstimateMesh call. Lives until gRPC is done with it and the plan is made or given up.
class Estimate final : public grpc::ServerUnaryReactor,
                       public Stallable,
                       public std::enable_shared_from_this<Estimate> {
 public:
  static grpc::ServerUnaryReactor* start(MeshEngine& engine,
                                         grpc::CallbackServerContext& context,
                                         const v1::MeshRequest& request,
                                         v1::MeshHeader& response) {
    const std::shared_ptr<Estimate> estimate(new Estimate(engine, context, response));
    estimate->self_ = estimate;
    const absl::Status begun = guarded("EstimateMesh", [&] { estimate->begin(request); });
    if (!begun.ok()) estimate->end(begun);
    return estimate.get();
  }

  /// It waits for nothing of its client's.
  std::optional<Stallable::Clock::time_point> waiting_since() override { return std::nullopt; }
  void give_up(std::chrono::seconds /*waited*/) override {}
  void pass_time(Stallable::Clock::time_point now) override {
    turn_.lend_if_idle_since(now - kIdleEstimate);
  }

 private:
  Estimate(MeshEngine& engine, grpc::CallbackServerContext& context, v1::MeshHeader& response)
      : engine_(engine),
        call_(engine.calls, context, "EstimateMesh"),
        watch_(std::make_shared<PlanningWatch>(deadline_of(context))),
        response_(response) {}

  void begin(const v1::MeshRequest& request) {
    auto order = parse_mesh_request(request);
    const absl::Status admitted = call_.admission();
    const absl::Status status = admitted.ok() ? within_field("mesh", order.status()) : admitted;
    if (!status.ok()) return end(status);
    order_ = *std::move(order);
    if (!order_.digest.empty()) call_.note("grid", order_.digest);
    order_.space = call_.space();
    // Counts are the same without improvement, which would make the mesh.
    improve_ = std::exchange(order_.request.improve, false);
    call_.on_cut([watch = watch_] { watch->cancellation.cancel(); });
    engine_.stalls.add(weak_from_this());
    place_ = engine_.admit(call_, watch_->cancellation.deadline(),
                           [self = shared_from_this()](absl::StatusOr<Ticket> ticket) {
                             self->plan(std::move(ticket));
                           });
  }

  void plan(absl::StatusOr<Ticket> ticket) {
    if (!ticket.ok()) return finish(ticket.status());
    turn_.take(*std::move(ticket));
    const absl::Status asked = guarded("EstimateMesh", [&] {
      engine_.planner.plan(
          call_.client(), order_, watch_,
          [self = shared_from_this()](const auto& planned) { self->finish(planned); });
    });
    if (!asked.ok()) end(asked);
  }

  /// Chunks are tried in a turn of their own: a plan that was remembered took none.
  void finish(const absl::StatusOr<PlannedMesh>& planned) {
    if (!planned.ok()) return conclude(planned.status());
    engine_.short_tasks.post(call_.client(), [self = shared_from_this(), planned = *planned] {
      self->conclude(guarded("EstimateMesh", [&] {
        self->tell(planned);
        return absl::OkStatus();
      }));
    });
  }

  void conclude(const absl::Status& told) {
    turn_.give_back();
    const absl::Status cut = call_.registry().cut_off();
    end(told.ok() || cut.ok() ? told : cut);
  }

  void tell(const PlannedMesh& planned) {
    to_proto(planned.plan->header(), response_);
    const double fill = estimate_fill(*planned.plan, watch_->cancellation, kTrying).seconds;
    const double check = order_.request.fidelity
                             ? fidelity_seconds(*planned.plan, fill, engine_.pool.threads())
                             : 0;
    response_.set_fill_seconds(fill + check);
    v1::MeshRequest& canonical = *response_.mutable_canonical_request();
    canonical = planned.canonical;
    canonical.set_improve(improve_);
    response_.set_mesh_id(mesh_id_of(canonical));
    call_.note("mesh_id", response_.mesh_id());
    call_.note("tets", response_.tet_count());
  }

  /// Only the first end counts.
  void end(const absl::Status& status) {
    if (!ended_.exchange(true)) Finish(call_.finish(status));
  }

  // Whoever leaves the queue is not answered there.
  void OnCancel() override {
    watch_->cancellation.cancel();
    if (engine_.calls.admission().leave(place_)) finish(client_gone(watch_->cancellation));
  }
  void OnDone() override { const std::shared_ptr<Estimate> last = std::move(self_); }

  MeshEngine& engine_;
  Call call_;
  std::shared_ptr<PlanningWatch> watch_;
  v1::MeshHeader& response_;
  MeshOrder order_;
  bool improve_ = false;
  Admission::Place place_ = 0;  ///< in the queue; 0: in none
  MesherTurn turn_{engine_.calls.admission()};
  std::atomic<bool> ended_{false};
  std::shared_ptr<Estimate> self_;
};

void add_preset(v1::Capabilities& capabilities, v1::Preset name, Preset preset) {
  const AngleBounds bounds = angle_bounds(preset, CoordinateType::kFloat64);
  v1::PresetInfo& info = *capabilities.add_presets();
  info.set_preset(name);
  info.set_min_dihedral_deg(bounds.min_deg);
  info.set_max_dihedral_deg(bounds.max_deg);
}

void describe(const Config& config, v1::Capabilities& capabilities) {
  capabilities.set_server_version(TETSTREAM_VERSION);
  capabilities.set_algorithm_version(kAlgorithmVersion);
  add_preset(capabilities, v1::PRESET_DEFAULT, Preset::kDefault);
  add_preset(capabilities, v1::PRESET_MIN_ANGLE, Preset::kMinAngle);
  add_preset(capabilities, v1::PRESET_BOTH_SIDES, Preset::kBothSides);
  capabilities.add_coordinate_types(v1::COORDINATE_TYPE_FLOAT32);
  capabilities.add_coordinate_types(v1::COORDINATE_TYPE_FLOAT64);
  capabilities.set_max_labels(static_cast<std::int32_t>(kMaxMeshLabels) - 1);
  capabilities.add_encodings(v1::ENCODING_PLAIN);
  capabilities.add_encodings(v1::ENCODING_COMPACT);
  capabilities.add_encodings(v1::ENCODING_PACKED);
  capabilities.set_max_chunk_bytes(std::int64_t{kChunkBytes});
  v1::Limits& limits = *capabilities.mutable_limits();
  limits.set_max_concurrent_meshes(static_cast<std::int32_t>(config.max_streams));
  limits.set_max_tets(static_cast<std::int64_t>(config.max_tets));
  limits.set_max_request_bytes(static_cast<std::int64_t>(config.max_request_bytes));
  limits.set_max_store_bytes(static_cast<std::int64_t>(config.store_bytes));
  limits.set_max_resident_bytes(static_cast<std::int64_t>(config.resident_bytes));
  limits.set_max_client_meshes(static_cast<std::int32_t>(config.max_client_streams));
  limits.set_max_client_uploads(static_cast<std::int32_t>(config.max_client_uploads));
  limits.set_max_client_upload_bytes(static_cast<std::int64_t>(config.max_client_upload_bytes));
  limits.set_stall_seconds(static_cast<std::int32_t>(config.stall_seconds));
  limits.set_session_idle_seconds(static_cast<std::int32_t>(config.session_idle_seconds));
  limits.set_max_session_bytes(static_cast<std::int64_t>(session_bytes(config)));
  if (!config.has_jobs()) return;
  limits.set_max_namespace_jobs(static_cast<std::int64_t>(config.max_namespace_jobs));
}

}  // namespace

grpc::ServerUnaryReactor* MeshService::GetCapabilities(
    grpc::CallbackServerContext* context,
    const v1::GetCapabilitiesRequest* /*request*/,
    v1::Capabilities* response) {
  Call call(engine_.calls, *context, "GetCapabilities");
  const absl::Status admitted = call.admission();
  if (admitted.ok()) describe(engine_.config, *response);
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  reactor->Finish(call.finish(admitted));
  return reactor;
}

grpc::ServerUnaryReactor* MeshService::EstimateMesh(grpc::CallbackServerContext* context,
                                                    const v1::EstimateMeshRequest* request,
                                                    v1::MeshHeader* response) {
  return Estimate::start(engine_, *context, request->mesh(), *response);
}

grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* MeshService::RemeshSession(
    grpc::CallbackServerContext* context) {
  return RemeshStream::start(engine_, *context);
}

grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* MeshService::SamplePoints(
    grpc::CallbackServerContext* context) {
  return SampleStream::start(engine_, *context);
}

grpc::ServerWriteReactor<grpc::ByteBuffer>* MeshService::StreamMesh(
    grpc::CallbackServerContext* context, const grpc::ByteBuffer* request) {
  return MeshStream::start(engine_, *context, *request);
}

}  // namespace tet
