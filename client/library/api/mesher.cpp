#include "tetstream/mesher.h"

#include <optional>
#include <utility>

#include "client/library/api/core_request.h"
#include "client/library/api/mesh_impl.h"
#include "client/library/api/stream_impl.h"
#include "client/library/api/to_public.h"
#include "client/library/api/work.h"
#include "client/library/local_chunks.h"
#include "core/fidelity/measure_plan.h"
#include "core/plan/make/fill_estimate.h"
#include "core/plan/make/mesher.h"
#include "core/plan/make/plan_mesh.h"

namespace tetstream {
namespace {

/// What a call is about, understood.
struct Order {
  tet::Shape shape;
  tet::MeshRequest request;
};

template <class Solid>
absl::StatusOr<Order> understand(const Solid& solid, const Request& request) {
  absl::StatusOr<tet::Shape> shape = shape_of(solid);
  if (!shape.ok()) return shape.status();
  absl::StatusOr<tet::MeshRequest> core = local_request(request);
  if (!core.ok()) return core.status();
  // All labels are meshed unless the request says which.
  const bool is_labels = tet::labels_of(*shape) != nullptr || tet::grids_of(*shape) != nullptr;
  if (is_labels && !core->labels) core->labels.emplace();
  return Order{*std::move(shape), *std::move(core)};
}

/// A mesh, and what is measured of it on request.
struct Made {
  tet::MeshResult mesh;
  std::optional<tet::MeshFidelity> fidelity;
};

absl::StatusOr<Made> make(const Order& order,
                          const WorkOptions& options,
                          const tet::Cancellation& cancellation) {
  tet::TaskPool pool(options.threads);
  absl::StatusOr<tet::MeshResult> made = tet::mesh_volume(
      pool, {.shape = order.shape, .request = order.request, .progress = options.progress},
      cancellation);
  if (!made.ok()) return made.status();
  Made result{*std::move(made), std::nullopt};
  if (!order.request.fidelity) return result;
  absl::StatusOr<tet::MeshFidelity> measured = absl::UnknownError("not started");
  pool.run([&] {
    measured = fidelity_of(result.mesh.mesh, order.shape, order.request, cancellation);
  });
  if (!measured.ok()) return measured.status();
  result.fidelity = *std::move(measured);
  return result;
}

absl::StatusOr<Estimate> count(Order order,
                               int threads,
                               const tet::Cancellation& cancellation) {
  const bool fidelity = order.request.fidelity;
  ask_for_counts(order.request);
  const auto plan = tet::plan_mesh(
      {.shape = std::move(order.shape), .request = std::move(order.request)}, cancellation);
  if (!plan.ok()) return plan.status();
  tet::FillEstimate fill = tet::estimate_fill(**plan, cancellation);
  if (absl::Status status = check_cancelled(cancellation); !status.ok()) return status;
  const tet::MeshHeader& header = (*plan)->header();
  if (fidelity) fill.seconds += fidelity_seconds(**plan, fill.seconds, threads);
  return Estimate{header.vertex_count, header.tet_count, header.chunk_count, fill.bytes,
                  fill.seconds};
}

tet::TrailerFacts facts_of(const Made& made) {
  const tet::MeshResult& result = made.mesh;
  tet::TrailerFacts facts{std::nullopt, result.boundary, result.improvement, result.thin_walls,
                          made.fidelity};
  if (!result.quality.empty()) facts.quality = result.quality;
  return facts;
}

template <class Solid>
Result<Mesh> mesh_of(const Solid& solid, const Request& request, const WorkOptions& options) {
  return guarded([&]() -> Result<Mesh> {
    const Work work(options);
    absl::StatusOr<Order> order = understand(solid, request);
    if (!order.ok()) return to_public(order.status());
    absl::StatusOr<Made> made = make(*order, options, work.cancellation());
    if (!made.ok()) return to_public(made.status());
    const tet::TrailerFacts facts = facts_of(*made);
    return public_mesh(std::move(made->mesh.mesh), facts);
  });
}

template <class Solid>
Result<Estimate> estimate_of(const Solid& solid,
                             const Request& request,
                             const WorkOptions& options) {
  return guarded([&]() -> Result<Estimate> {
    const Work work(options);
    absl::StatusOr<Order> order = understand(solid, request);
    if (!order.ok()) return to_public(order.status());
    absl::StatusOr<Estimate> counted = absl::UnknownError("not started");
    tet::TaskPool pool(options.threads);
    pool.run([&] { counted = count(*std::move(order), pool.threads(), work.cancellation()); });
    if (!counted.ok()) return to_public(counted.status());
    return *counted;
  });
}

template <class Solid>
MeshStream stream_of(const Solid& solid,
                     const Request& request,
                     const WorkOptions& options,
                     ChunkRange chunks) {
  auto impl = std::make_unique<MeshStream::Impl>(options);
  impl->begin =
      [solid, request, options, chunks](
          const tet::Cancellation& cancellation) -> Result<std::unique_ptr<tet::ChunkSupply>> {
    absl::StatusOr<Order> order = understand(solid, request);
    if (!order.ok()) return to_public(order.status());
    return std::unique_ptr<tet::ChunkSupply>(
        std::make_unique<tet::LocalChunks>(tet::LocalWork{std::move(order->shape),
                                                          std::move(order->request),
                                                          options.threads,
                                                          options.progress,
                                                          {chunks.first, chunks.end}},
                                           cancellation));
  };
  return MeshStream(std::move(impl));
}

}  // namespace

Result<Mesh> mesh(const Volume& volume, const Request& request, const WorkOptions& options) {
  return mesh_of(volume, request, options);
}
Result<Mesh> mesh(const Scene& scene, const Request& request, const WorkOptions& options) {
  return mesh_of(scene, request, options);
}
Result<Mesh> mesh(const Labels& labels, const Request& request, const WorkOptions& options) {
  return mesh_of(labels, request, options);
}

Result<Estimate> estimate(const Volume& volume,
                          const Request& request,
                          const WorkOptions& options) {
  return estimate_of(volume, request, options);
}
Result<Estimate> estimate(const Scene& scene,
                          const Request& request,
                          const WorkOptions& options) {
  return estimate_of(scene, request, options);
}
Result<Estimate> estimate(const Labels& labels,
                          const Request& request,
                          const WorkOptions& options) {
  return estimate_of(labels, request, options);
}

MeshStream stream(const Volume& volume,
                  const Request& request,
                  const WorkOptions& options,
                  ChunkRange chunks) {
  return stream_of(volume, request, options, chunks);
}
MeshStream stream(const Scene& scene,
                  const Request& request,
                  const WorkOptions& options,
                  ChunkRange chunks) {
  return stream_of(scene, request, options, chunks);
}
MeshStream stream(const Labels& labels,
                  const Request& request,
                  const WorkOptions& options,
                  ChunkRange chunks) {
  return stream_of(labels, request, options, chunks);
}

}  // namespace tetstream
