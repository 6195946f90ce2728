#include <optional>
#include <utility>

#include "client/command/mesh/finish_mesh.h"
#include "client/command/mesh/mesh_maker.h"
#include "client/command/mesh/prepare_request.h"
#include "client/command/process/stopwatch.h"
#include "client/library/error_details.h"
#include "client/library/mesh_client.h"

namespace tet {
namespace {

/// Shows both halves of a stream, and tells when the first ended.
class StreamWatch {
 public:
  explicit StreamWatch(ProgressBar& bar) : bar_(bar) { bar_.begin("planning", "bricks"); }

  void planning(std::uint64_t done, std::uint64_t total) {
    bar_.update(static_cast<double>(done), static_cast<double>(total));
  }
  void tets(std::uint64_t done, std::uint64_t total) {
    if (!planning_seconds_) {
      planning_seconds_ = watch_.lap();
      bar_.begin("meshing", "tets");
    }
    bar_.update(static_cast<double>(done), static_cast<double>(total));
  }

  ClientProgress callbacks() {
    return {.upload = {},
            .planning = [this](auto done, auto total) { planning(done, total); },
            .tets = [this](auto done, auto total) { tets(done, total); }};
  }
  std::vector<Stage> stages(double uploading_seconds) {
    return {{"uploading", uploading_seconds},
            {"planning", planning_seconds_.value_or(0)},
            {"meshing", watch_.lap()}};
  }

 private:
  ProgressBar& bar_;
  Stopwatch watch_;
  std::optional<double> planning_seconds_;
};

v1::Encoding encoding_of(const MeshOptions& options) {
  if (options.compact) return v1::ENCODING_COMPACT;
  return options.packed ? v1::ENCODING_PACKED : v1::ENCODING_PLAIN;
}

absl::StatusOr<MadeMesh> upload_and_stream(MeshClient& client,
                                           const MeshOptions& options,
                                           ProgressBar& bar,
                                           const Cancellation& interruption) {
  Stopwatch watch;
  absl::StatusOr<PreparedRequest> request = prepare_request(client, options, bar, interruption);
  if (!request.ok()) return request.status();
  const double uploading_seconds = watch.lap();

  StreamWatch stream(bar);
  absl::StatusOr<StreamedMesh> streamed = client.stream_mesh(
      request->message, stream.callbacks(), interruption,
      {.encoding = encoding_of(options), .skip_cache = options.skip_cache, .used = {}});
  if (!streamed.ok()) return streamed.status();
  const char* const transport = streamed->shared_memory ? "shared_memory" : "messages";
  MadeMesh made = made_of(*std::move(streamed), stream.stages(uploading_seconds));
  made.surface = request->surface;
  made.transport = transport;
  return made;
}

}  // namespace

absl::StatusOr<MadeMesh> make_mesh_on_server(const MeshOptions& options,
                                             ProgressBar& bar,
                                             const Cancellation& interruption) {
  const auto client = MeshClient::connect(options.server, options.channel);
  if (!client.ok()) return client.status();
  absl::StatusOr<MadeMesh> made = upload_and_stream(**client, options, bar, interruption);
  // Evicted, found damaged, or not on the server that took over: it takes another upload.
  const std::string reason = reason_of_failure(made.status());
  if (reason != "GRID_NOT_FOUND" && reason != "STORED_GRID_CORRUPT") return made;
  return upload_and_stream(**client, options, bar, interruption);
}

}  // namespace tet
