// Meshes that a tetstream server makes.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "tetstream/export.h"
#include "tetstream/labels.h"
#include "tetstream/mesh.h"
#include "tetstream/mesher.h"
#include "tetstream/request.h"
#include "tetstream/sample.h"
#include "tetstream/scene.h"
#include "tetstream/session.h"
#include "tetstream/stable_session.h"
#include "tetstream/status.h"
#include "tetstream/stream.h"
#include "tetstream/volume.h"

namespace tetstream {

/// How a server is spoken to. Files are PEM.
struct ClientOptions {
  /// Goes with every call. It needs TLS or `token_in_plain`, unless the server is on this host.
  std::string token = {};
  bool token_in_plain = false;  ///< send it even where others can read it on its way
  bool tls = false;             ///< also where any file is given
  std::string tls_ca = {};      ///< who signs the server's certificate; empty: the system's
  std::string tls_cert = {};    ///< the client's own certificate, where the server asks for it
  std::string tls_key = {};     ///< and its private key
  int attempts = 8;             ///< at a call that fails because the server cannot be reached
  bool shared_memory = true;    ///< take chunks from it, where the server's socket file is here
};

/// How chunks travel; the mesh is the same.
enum class Encoding : std::uint8_t {
  kPlain,    ///< as they are used: about 18 bytes a tet
  kPacked,   ///< a fifth of that, for slow networks
  kCompact,  ///< half a byte a tet, and the mesh is made here: not with `improve` or fields
};

struct StreamOptions : WorkOptions {
  Encoding encoding = Encoding::kPlain;
  bool skip_cache = false;  ///< make it even where a job of the server has stored it
};

/// What a server can do.
struct Capabilities {
  std::string server_version, algorithm_version;
  std::uint64_t max_tets = 0;         ///< of one mesh
  std::uint64_t max_store_bytes = 0;  ///< of all stored volumes together
  std::uint64_t max_chunk_bytes = 0;  ///< of one chunk's arrays
  std::uint32_t max_concurrent_meshes = 0;
};

/// A connection to a server. Copies share it, and any thread may call any member.
///
/// Errors are the server's own codes and messages; kUnavailable after all attempts, kDataLoss
/// and kInternal are the network's or the server's fault, the others the request's.
class TETSTREAM_API Client {
 public:
  /// `address` is host:port, unix:PATH (a socket file of this host), or several with commas
  /// between that know the same volumes. Does not wait for the server: the first call tells
  /// whether it is there. Errors: kNotFound and kInvalidArgument (a file of the options),
  /// kFailedPrecondition (a token that others could read).
  static Result<Client> connect(const std::string& address, const ClientOptions& options = {});

  /// Stores a .vdb file; nothing travels where the server has it. An upload that broke goes on
  /// where it ended. Errors also: kNotFound (no such file here).
  Result<StoredVolume> upload_file(const std::string& path,
                                   const std::string& grid = {},
                                   const WorkOptions& options = {}) const;
  /// Stores a volume of this process, by way of a temporary file, which is a new one for
  /// the server each time: keep what this returns.
  Result<StoredVolume> upload(const Volume& volume, const WorkOptions& options = {}) const;
  /// Stores a segmentation, by way of a temporary image; the same one is the same file each
  /// time. A request that meshes it has `labels`. Error also: kFailedPrecondition (level sets:
  /// upload the .vdb file that has them, and name its `grids`).
  Result<StoredVolume> upload(const Labels& labels, const WorkOptions& options = {}) const;

  /// Makes a mesh there and receives all of it. The request's fields are uploaded first.
  Result<Mesh> mesh(const StoredVolume& volume,
                    const Request& request = {},
                    const StreamOptions& options = {}) const;
  /// Makes the mesh of a scene, whose volumes are uploaded first.
  Result<Mesh> mesh(const Scene& scene,
                    const Request& request = {},
                    const StreamOptions& options = {}) const;
  /// Makes a mesh there, chunk by chunk; nothing is sent before the first call of a member.
  /// Some of its chunks always come plain.
  MeshStream stream(const StoredVolume& volume,
                    const Request& request = {},
                    const StreamOptions& options = {},
                    ChunkRange chunks = {}) const;
  MeshStream stream(const Scene& scene,
                    const Request& request = {},
                    const StreamOptions& options = {},
                    ChunkRange chunks = {}) const;
  /// Counts a mesh without making it.
  Result<Estimate> estimate(const StoredVolume& volume,
                            const Request& request = {},
                            const WorkOptions& options = {}) const;
  Result<Estimate> estimate(const Scene& scene,
                            const Request& request = {},
                            const WorkOptions& options = {}) const;

  /// Asks what a mesh of the request would be made from at x, y and z of each point: what
  /// tetstream::sample tells here, byte for byte. Points are sent and answered a few thousands
  /// at a time, and a call that broke goes on where it ended.
  Result<PointSamples> sample(const StoredVolume& volume,
                              std::span<const double> points,
                              const Request& request = {},
                              const WorkOptions& options = {}) const;
  Result<PointSamples> sample(const Scene& scene,
                              std::span<const double> points,
                              const Request& request = {},
                              const WorkOptions& options = {}) const;

  /// Begins a session there: a volume is uploaded once, and later what changes of it. Errors
  /// of a broken connection end it, too.
  Result<Session> begin_session(const Volume& volume,
                                const Request& request = {},
                                const WorkOptions& options = {}) const;
  Result<Session> begin_session(const Scene& scene,
                                const Request& request = {},
                                const WorkOptions& options = {}) const;

  /// Begins a session there whose vertices and tets keep their ids, and which is patched in
  /// place here.
  Result<StableSession> begin_stable_session(const Volume& volume,
                                             const Request& request = {},
                                             const WorkOptions& options = {}) const;
  Result<StableSession> begin_stable_session(const Scene& scene,
                                             const Request& request = {},
                                             const WorkOptions& options = {}) const;

  Result<Capabilities> capabilities(const WorkOptions& options = {}) const;
  /// kOk where the server says that it serves: "readiness", "liveness" or "jobs".
  Status health(const std::string& service = "readiness",
                const WorkOptions& options = {}) const;

  struct Impl;
  explicit Client(std::shared_ptr<const Impl> impl);
  const std::shared_ptr<const Impl>& impl() const noexcept { return impl_; }

 private:
  std::shared_ptr<const Impl> impl_;
};

}  // namespace tetstream
