// The service as a C++ program uses it: files up, meshes down, broken connections mended.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "client/library/channel.h"
#include "core/base/cancel.h"
#include "core/fidelity/fidelity.h"
#include "core/mesh/boundary.h"
#include "core/mesh/improve/improve.h"
#include "core/mesh/quality.h"
#include "core/mesh/tet_mesh.h"
#include "core/plan/sample_points.h"
#include "core/plan/thin_walls.h"
#include "tetstream/v1/grids.pb.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

class ChunkSupply;
class Connection;
class RemeshSession;
enum class SessionIds : bool;

/// How often a broken call is taken up again.
struct RetryPolicy {
  int attempts = 8;  ///< in a row without any progress between them
  int attempts_once_known =
      12;                      ///< the same where a server has answered before: it may restart
  int first_backoff_ms = 100;  ///< doubled each time, up to max_backoff_ms
  int max_backoff_ms = 3000;
};

/// A mesh as it came over the wire.
struct StreamedMesh {
  TetMesh mesh;
  QualityStats quality;                      ///< empty where the request skips statistics
  std::optional<BoundaryTopology> boundary;  ///< of the inside, if the server told it
  std::optional<Improvement> improvement;    ///< where the request asked for it
  ThinWalls thin_walls;
  std::optional<MeshFidelity> fidelity;  ///< where the request asked for it
  std::string mesh_id;
  v1::MeshRequest canonical_request;
  bool cached = false;  ///< the (last) stream of it was served from a job's stored result
  bool shared_memory = false;  ///< its chunks came in memory shared with the server
};

/// How a mesh is made and received, beside what its request says of it.
struct StreamOptions {
  v1::Encoding encoding = v1::ENCODING_PLAIN;
  bool skip_cache = false;  ///< make it even where the result of a job is stored
  /// A mesh that is no longer needed. The new one is made in its memory, as far as that is
  /// enough: for arrays touched for the first time a system may take longer than for meshing.
  TetMesh used;
};

/// Told how far long work is, on the thread that called.
struct ClientProgress {
  /// Bytes of the file the server holds, of all.
  std::function<void(std::uint64_t done, std::uint64_t total)> upload;
  /// Bricks counted, of all; total is 0 while it is unknown.
  std::function<void(std::uint64_t done, std::uint64_t total)> planning;
  /// Tets received, of all.
  std::function<void(std::uint64_t done, std::uint64_t total)> tets;
};

/// What is asked of a stored file's grids.
enum class GridDetail : std::uint8_t {
  kHeader,  ///< what the file says of them
  kValues,  ///< what their values tell, too: the file is read
};

/// A connection to a server, or to one of several with the same grids: when one cannot be
/// reached or shuts down, the next goes on with what it began. Thread safety: any thread may
/// call any member.
///
/// Errors are the server's own codes and messages. kUnavailable (after all retries),
/// kDeadlineExceeded, kCancelled, kDataLoss and kInternal are the network's or the server's
/// fault, the others the request's. Every call ends within a tenth of a second of its
/// cancellation.
class MeshClient {
 public:
  /// `address` is host:port or unix:PATH, or several with commas between. Does not wait for the
  /// server: the first call tells whether it is there.
  static std::unique_ptr<MeshClient> connect(const std::string& address,
                                             RetryPolicy retry = {});
  /// Connects over TLS, or with a token. Errors: those of open_channel.
  static absl::StatusOr<std::unique_ptr<MeshClient>> connect(const std::string& address,
                                                             const ChannelOptions& options,
                                                             RetryPolicy retry = {});
  /// Shares a connection that others have too.
  explicit MeshClient(std::shared_ptr<Connection> connection);
  ~MeshClient();

  /// Stores a file unless it is stored, going on where an earlier upload of it ended; returns
  /// its name, `grids/{sha256}`. Errors also: kNotFound (no such file here).
  absl::StatusOr<std::string> upload_file(const std::string& path,
                                          const ClientProgress& progress,
                                          const Cancellation& cancellation);

  /// All stored files, by name.
  absl::StatusOr<std::vector<v1::GridFile>> list_grids(const Cancellation& cancellation);
  absl::StatusOr<v1::GridFile> grid_info(const std::string& name,
                                         const Cancellation& cancellation,
                                         GridDetail detail = GridDetail::kHeader);
  /// Names of the stored file's grids that can be meshed, in its order: for
  /// MeshRequest.grid_names.
  absl::StatusOr<std::vector<std::string>> meshable_grids(const std::string& name,
                                                          const Cancellation& cancellation);
  absl::StatusOr<v1::Capabilities> capabilities(const Cancellation& cancellation);
  absl::StatusOr<v1::MeshHeader> estimate(const v1::MeshRequest& request,
                                          const Cancellation& cancellation);

  /// kOk when the server says that it serves `service` ("", "liveness", "readiness").
  absl::Status check_health(const std::string& service, const Cancellation& cancellation);

  /// Makes a mesh on the server and receives all of it: the same mesh whatever the encoding. A
  /// stream that breaks is resumed at the first chunk that is missing. Errors also: kDataLoss
  /// (a checksum or a chunk's place is wrong).
  absl::StatusOr<StreamedMesh> stream_mesh(const v1::MeshRequest& request,
                                           const ClientProgress& progress,
                                           const Cancellation& cancellation,
                                           StreamOptions options = {});

  /// Receives the mesh chunk by chunk, as they are asked for: see chunk_supply.h. Whoever does
  /// not ask for the next holds the server back, and lets it stop by giving the supply up.
  /// Nothing is sent before the first call of a member. `cancellation` outlives the supply.
  std::unique_ptr<ChunkSupply> stream_chunks(const v1::MeshRequest& request,
                                             const ClientProgress& progress,
                                             const Cancellation& cancellation,
                                             const StreamOptions& options = {});

  /// Receives the mesh that stream_mesh would, byte for byte, where `earlier` was made by the
  /// same request of another grid: what did not change is taken from it, and only the rest is
  /// sent, if the server still has the earlier grid. Where parts were kept, `quality` is that
  /// of the rest alone. Errors also: kInvalidArgument (ENCODING_COMPACT, which carries whole
  /// meshes).
  absl::StatusOr<StreamedMesh> update_mesh(const v1::MeshRequest& request,
                                           const StreamedMesh& earlier,
                                           const ClientProgress& progress,
                                           const Cancellation& cancellation,
                                           StreamOptions options = {});

  /// Asks what a mesh of `request` would be made from at each of the points: see
  /// served_samples.h. `progress` is told how many were answered, of all.
  absl::StatusOr<PointSamples> sample_points(
      const v1::MeshRequest& request,
      std::span<const WorldPoint> points,
      const std::function<void(std::uint64_t done, std::uint64_t total)>& progress,
      const Cancellation& cancellation);

  /// A mesh that follows its shape, change by change: see remesh_session.h. `cancellation`
  /// outlives it.
  absl::StatusOr<std::unique_ptr<RemeshSession>> begin_session(const v1::MeshRequest& request,
                                                               const Cancellation& cancellation,
                                                               SessionIds ids = SessionIds{});

 private:
  std::shared_ptr<Connection> connection_;
};

}  // namespace tet
