#include "tetstream/client.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "client/library/api/client_impl.h"
#include "client/library/api/mesh_impl.h"
#include "client/library/api/stream_impl.h"
#include "client/library/api/to_public.h"
#include "client/library/api/work.h"
#include "client/library/served_range.h"
#include "proto/wire/serialized.h"
#include "tetstream/v1/meshes.grpc.pb.h"

namespace tetstream {

namespace {

using Fraction = std::function<void(double)>;

/// As good as for ever, and more than half of it again is a number, too.
constexpr int kMostAttempts = 1'000'000;

tet::v1::Encoding to_wire(Encoding encoding) {
  switch (encoding) {
    case Encoding::kPlain:
      return tet::v1::ENCODING_PLAIN;
    case Encoding::kPacked:
      return tet::v1::ENCODING_PACKED;
    case Encoding::kCompact:
      return tet::v1::ENCODING_COMPACT;
  }
  return tet::v1::ENCODING_PLAIN;
}

std::function<void(std::uint64_t, std::uint64_t)> telling(const Fraction& progress) {
  if (!progress) return nullptr;
  return [progress](std::uint64_t done, std::uint64_t total) {
    if (total > 0) progress(static_cast<double>(done) / static_cast<double>(total));
  };
}

tet::StreamOptions stream_options(const StreamOptions& options) {
  return {.encoding = to_wire(options.encoding), .skip_cache = options.skip_cache, .used = {}};
}

tet::TrailerFacts facts_of(const tet::StreamedMesh& mesh) {
  tet::TrailerFacts facts{std::nullopt, mesh.boundary, mesh.improvement, mesh.thin_walls,
                          mesh.fidelity};
  if (!mesh.quality.empty()) facts.quality = mesh.quality;
  return facts;
}

template <class Count>
std::uint64_t unsigned_count(Count count) {
  return static_cast<std::uint64_t>(std::max<Count>(count, 0));
}

tet::ChannelOptions channel_options(const ClientOptions& options) {
  return {.tls = options.tls,
          .tls_ca = options.tls_ca,
          .tls_cert = options.tls_cert,
          .tls_key = options.tls_key,
          .token = options.token,
          .token_in_plain = options.token_in_plain,
          .shared_memory = options.shared_memory};
}

tet::ClientProgress tets_told(const StreamOptions& options) {
  return {.upload = {}, .planning = {}, .tets = telling(options.progress)};
}

template <class Solid>
Result<Mesh> mesh_there(const Client::Impl& client,
                        const Solid& solid,
                        const Request& request,
                        const StreamOptions& options) {
  return guarded([&]() -> Result<Mesh> {
    const Work work(options);
    const auto message = message_of(*client.meshes, solid, request, work.cancellation());
    if (!message.ok()) return to_public(message.status());
    absl::StatusOr<tet::StreamedMesh> mesh = client.meshes->stream_mesh(
        *message, tets_told(options), work.cancellation(), stream_options(options));
    if (!mesh.ok()) return to_public(mesh.status());
    return public_mesh(std::move(mesh->mesh), facts_of(*mesh), mesh->mesh_id);
  });
}

tet::RangeCall range_call(const v1::MeshRequest& mesh, bool skip_cache, ChunkRange chunks) {
  const auto request = [mesh, skip_cache](std::uint64_t first, std::uint64_t end,
                                          const std::string& mesh_id) {
    v1::StreamMeshRequest message;
    *message.mutable_mesh() = mesh;
    message.set_skip_cache(skip_cache);
    message.set_start_chunk(static_cast<std::int64_t>(first));
    message.set_end_chunk(static_cast<std::int64_t>(end));
    message.set_expected_mesh_id(mesh_id);
    return tet::serialized(message);
  };
  return {v1::MeshService::service_full_name(), "StreamMesh", request, chunks.first,
          chunks.end};
}

template <class Solid>
MeshStream stream_there(const std::shared_ptr<const Client::Impl>& client,
                        const Solid& solid,
                        const Request& request,
                        const StreamOptions& options,
                        ChunkRange chunks) {
  auto stream = std::make_unique<MeshStream::Impl>(options);
  stream->begin =
      [client, solid, request, options, chunks](
          const tet::Cancellation& cancellation) -> Result<std::unique_ptr<tet::ChunkSupply>> {
    const auto message = message_of(*client->meshes, solid, request, cancellation);
    if (!message.ok()) return to_public(message.status());
    if (chunks.is_all()) {
      return client->meshes->stream_chunks(*message, tets_told(options), cancellation,
                                           stream_options(options));
    }
    return std::unique_ptr<tet::ChunkSupply>(std::make_unique<tet::ServedRange>(
        client->connection, range_call(*message, options.skip_cache, chunks),
        tets_told(options), cancellation));
  };
  return MeshStream(std::move(stream));
}

template <class Solid>
Result<Estimate> estimate_there(const Client::Impl& client,
                                const Solid& solid,
                                const Request& request,
                                const WorkOptions& options) {
  return guarded([&]() -> Result<Estimate> {
    const Work work(options);
    const auto message = message_of(*client.meshes, solid, request, work.cancellation());
    if (!message.ok()) return to_public(message.status());
    const auto header = client.meshes->estimate(*message, work.cancellation());
    if (!header.ok()) return to_public(header.status());
    return Estimate{unsigned_count(header->vertex_count()), unsigned_count(header->tet_count()),
                    unsigned_count(header->chunk_count()), unsigned_count(header->mesh_bytes()),
                    header->fill_seconds()};
  });
}

}  // namespace

Client::Client(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}

Result<Client> Client::connect(const std::string& address, const ClientOptions& options) {
  return guarded([&]() -> Result<Client> {
    const int attempts = std::clamp(options.attempts, 1, kMostAttempts);
    auto connected = tet::Connection::open(
        address, channel_options(options),
        {.attempts = attempts, .attempts_once_known = attempts + attempts / 2});
    if (!connected.ok()) return to_public(connected.status());
    return Client(std::make_shared<const Impl>(*std::move(connected)));
  });
}

Result<StoredVolume> Client::upload_file(const std::string& path,
                                         const std::string& grid,
                                         const WorkOptions& options) const {
  return guarded([&]() -> Result<StoredVolume> {
    const Work work(options);
    const auto name = impl_->meshes->upload_file(
        path, {.upload = telling(options.progress), .planning = {}, .tets = {}},
        work.cancellation());
    if (!name.ok()) return to_public(name.status());
    return StoredVolume{*name, grid};
  });
}

Result<StoredVolume> Client::upload(const Volume& volume, const WorkOptions& options) const {
  return guarded([&]() -> Result<StoredVolume> {
    const Work work(options);
    const auto name = upload_volume(
        *impl_->meshes, volume,
        {.upload = telling(options.progress), .planning = {}, .tets = {}}, work.cancellation());
    if (!name.ok()) return to_public(name.status());
    return StoredVolume{*name};
  });
}

Result<StoredVolume> Client::upload(const Labels& labels, const WorkOptions& options) const {
  return guarded([&]() -> Result<StoredVolume> {
    const Work work(options);
    const auto name = upload_labels(
        *impl_->meshes, labels,
        {.upload = telling(options.progress), .planning = {}, .tets = {}}, work.cancellation());
    if (!name.ok()) return to_public(name.status());
    return StoredVolume{*name};
  });
}

Result<Mesh> Client::mesh(const StoredVolume& volume,
                          const Request& request,
                          const StreamOptions& options) const {
  return mesh_there(*impl_, volume, request, options);
}

MeshStream Client::stream(const StoredVolume& volume,
                          const Request& request,
                          const StreamOptions& options,
                          ChunkRange chunks) const {
  return stream_there(impl_, volume, request, options, chunks);
}

Result<Estimate> Client::estimate(const StoredVolume& volume,
                                  const Request& request,
                                  const WorkOptions& options) const {
  return estimate_there(*impl_, volume, request, options);
}

Result<Mesh> Client::mesh(const Scene& scene,
                          const Request& request,
                          const StreamOptions& options) const {
  return mesh_there(*impl_, scene, request, options);
}

MeshStream Client::stream(const Scene& scene,
                          const Request& request,
                          const StreamOptions& options,
                          ChunkRange chunks) const {
  return stream_there(impl_, scene, request, options, chunks);
}

Result<Estimate> Client::estimate(const Scene& scene,
                                  const Request& request,
                                  const WorkOptions& options) const {
  return estimate_there(*impl_, scene, request, options);
}

Result<Capabilities> Client::capabilities(const WorkOptions& options) const {
  return guarded([&]() -> Result<Capabilities> {
    const Work work(options);
    const auto told = impl_->meshes->capabilities(work.cancellation());
    if (!told.ok()) return to_public(told.status());
    const auto& limits = told->limits();
    return Capabilities{.server_version = told->server_version(),
                        .algorithm_version = told->algorithm_version(),
                        .max_tets = unsigned_count(limits.max_tets()),
                        .max_store_bytes = unsigned_count(limits.max_store_bytes()),
                        .max_chunk_bytes = unsigned_count(told->max_chunk_bytes()),
                        .max_concurrent_meshes = static_cast<std::uint32_t>(
                            unsigned_count(limits.max_concurrent_meshes()))};
  });
}

Status Client::health(const std::string& service, const WorkOptions& options) const {
  return guarded([&]() -> Status {
    const Work work(options);
    return to_public(impl_->meshes->check_health(service, work.cancellation()));
  });
}

}  // namespace tetstream
