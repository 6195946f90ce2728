// A real server and its clients in one process, as the service's benchmarks use them.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "client/library/mesh_client.h"
#include "core/base/cancel.h"
#include "server/server.h"

namespace tet::bench {

/// What is meshed: a solid of tests/support/vdb_fixtures.h on a lattice of its voxels.
struct BenchMesh {
  std::string solid;
  double voxel_size = 1;
  bool graded = false;
};

/// How a client reaches the server.
enum class Transport { kPort, kSocketFile, kSharedMemory };

/// A server with an empty store, and a client; gone with all their files when this is.
class Loopback {
 public:
  explicit Loopback(Transport transport = Transport::kPort);
  ~Loopback();
  Loopback(const Loopback&) = delete;
  Loopback& operator=(const Loopback&) = delete;

  MeshClient& client() { return *client_; }
  /// Another, with a connection of its own.
  std::unique_ptr<MeshClient> connect() const;

  /// Uploads a solid, which is at `file("solid.vdb")` then, and asks for its mesh. The grid is
  /// in memory when this returns, the plan remembered.
  v1::MeshRequest request_mesh(const BenchMesh& mesh);

  std::string file(const std::string& name) const { return (folder_ / name).string(); }

 private:
  const Transport transport_;
  std::filesystem::path folder_;
  std::unique_ptr<Server> server_;
  std::unique_ptr<MeshClient> client_;
};

/// A request for the same mesh under another name, so that nobody remembers its plan.
void rename_mesh(v1::MeshRequest& request);

/// A whole mesh, received into the memory of `used`.
TetMesh receive(MeshClient& client,
                const v1::MeshRequest& request,
                TetMesh used = {},
                v1::Encoding encoding = v1::ENCODING_PLAIN);

}  // namespace tet::bench
