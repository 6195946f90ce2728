#include "tetstream/client.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "client/library/api/core_request.h"
#include "client/library/api/mesh_impl.h"
#include "client/library/api/stream_impl.h"
#include "client/library/api/temporary_folder.h"
#include "client/library/api/to_public.h"
#include "client/library/api/work.h"
#include "client/library/mesh_client.h"
#include "client/library/wire_request.h"

namespace tetstream {

struct Client::Impl {
  explicit Impl(std::unique_ptr<tet::MeshClient> connected) : meshes(std::move(connected)) {}
  const std::unique_ptr<tet::MeshClient> meshes;
};

namespace {

using Fraction = std::function<void(double)>;

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

absl::StatusOr<std::string> upload_volume(tet::MeshClient& meshes,
                                          const Volume& volume,
                                          const tet::ClientProgress& progress,
                                          const tet::Cancellation& cancellation) {
  const absl::StatusOr<TemporaryFolder> folder = TemporaryFolder::make();
  if (!folder.ok()) return folder.status();
  const std::string path = folder->file("volume.vdb");
  if (const Status written = volume.write_vdb(path); !written.ok()) {
    return absl::Status(static_cast<absl::StatusCode>(written.code()), written.message());
  }
  return meshes.upload_file(path, progress, cancellation);
}

/// The message, once the server has what it is about.
absl::StatusOr<tet::v1::MeshRequest> prepare(tet::MeshClient& meshes,
                                             const StoredVolume& volume,
                                             const Request& request,
                                             const tet::Cancellation& cancellation) {
  absl::StatusOr<tet::MeshRequest> core = core_request(request);
  if (!core.ok()) return core.status();
  for (std::size_t i = 0; i < core->fields.size(); ++i) {
    const auto name = upload_volume(meshes, request.fields[i].values, {}, cancellation);
    if (!name.ok()) return name.status();
    core->fields[i].file = *name;
  }
  std::vector<std::string> grids;
  if (!volume.grid.empty()) grids.push_back(volume.grid);
  return tet::wire_request(*core, volume.name, grids);
}

tet::StreamOptions stream_options(const StreamOptions& options) {
  return {.encoding = to_wire(options.encoding), .skip_cache = options.skip_cache, .used = {}};
}

absl::StatusOr<tet::StreamedMesh> receive(tet::MeshClient& meshes,
                                          const StoredVolume& volume,
                                          const Request& request,
                                          const StreamOptions& options,
                                          const tet::Cancellation& cancellation) {
  const auto message = prepare(meshes, volume, request, cancellation);
  if (!message.ok()) return message.status();
  return meshes.stream_mesh(*message,
                            {.upload = {}, .planning = {}, .tets = telling(options.progress)},
                            cancellation, stream_options(options));
}

tet::TrailerFacts facts_of(const tet::StreamedMesh& mesh) {
  tet::TrailerFacts facts{std::nullopt, mesh.boundary, mesh.improvement, mesh.thin_walls};
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
          .token_in_plain = options.token_in_plain};
}

}  // namespace

Client::Client(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}

Result<Client> Client::connect(const std::string& address, const ClientOptions& options) {
  return guarded([&]() -> Result<Client> {
    auto connected = tet::MeshClient::connect(address, channel_options(options),
                                              {.attempts = std::max(1, options.attempts)});
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

Result<Mesh> Client::mesh(const StoredVolume& volume,
                          const Request& request,
                          const StreamOptions& options) const {
  return guarded([&]() -> Result<Mesh> {
    const Work work(options);
    absl::StatusOr<tet::StreamedMesh> mesh =
        receive(*impl_->meshes, volume, request, options, work.cancellation());
    if (!mesh.ok()) return to_public(mesh.status());
    return public_mesh(std::move(mesh->mesh), facts_of(*mesh), mesh->mesh_id);
  });
}

MeshStream Client::stream(const StoredVolume& volume,
                          const Request& request,
                          const StreamOptions& options) const {
  auto stream = std::make_unique<MeshStream::Impl>(options);
  stream->begin =
      [impl = impl_, volume, request, options](
          const tet::Cancellation& cancellation) -> Result<std::unique_ptr<tet::ChunkSupply>> {
    const auto message = prepare(*impl->meshes, volume, request, cancellation);
    if (!message.ok()) return to_public(message.status());
    return impl->meshes->stream_chunks(
        *message, {.upload = {}, .planning = {}, .tets = telling(options.progress)},
        cancellation, stream_options(options));
  };
  return MeshStream(std::move(stream));
}

Result<Estimate> Client::estimate(const StoredVolume& volume,
                                  const Request& request,
                                  const WorkOptions& options) const {
  return guarded([&]() -> Result<Estimate> {
    const Work work(options);
    const auto message = prepare(*impl_->meshes, volume, request, work.cancellation());
    if (!message.ok()) return to_public(message.status());
    const auto header = impl_->meshes->estimate(*message, work.cancellation());
    if (!header.ok()) return to_public(header.status());
    return Estimate{unsigned_count(header->vertex_count()), unsigned_count(header->tet_count()),
                    unsigned_count(header->mesh_bytes()), header->fill_seconds()};
  });
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
