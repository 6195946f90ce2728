// A mesh chunk by chunk, as fast as somebody asks for them; wherever it is made.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/base/quality_stats.h"
#include "core/fidelity/fidelity.h"
#include "core/mesh/boundary_topology.h"
#include "core/mesh/improve/improvement.h"
#include "core/mesh/tet_mesh.h"
#include "core/plan/thin_walls.h"

namespace tet {

/// A chunk whose columns somebody else holds.
struct ChunkView {
  std::uint64_t index = 0;
  ChunkExtent place;
  ConstColumns columns;
};

/// What is told of a mesh behind its last chunk.
struct TrailerFacts {
  std::optional<QualityStats> quality;
  std::optional<BoundaryTopology> boundary;
  std::optional<Improvement> improvement;
  ThinWalls thin_walls;
  std::optional<MeshFidelity> fidelity = {};
};

/// Gives a mesh chunk by chunk, and between two calls ends only what was begun. Every failure
/// ends it, and is told again by all later calls. Not thread-safe.
class ChunkSupply {
 public:
  virtual ~ChunkSupply() = default;

  /// Waits until the mesh is counted. It lives as long as this.
  virtual absl::StatusOr<const MeshHeader*> header() = 0;
  /// The server's name for the mesh; empty unless a server makes it.
  virtual std::string mesh_id() const { return ""; }
  /// The next chunk, which lives until the next call; null after the last.
  virtual absl::StatusOr<const ChunkView*> next() = 0;
  /// Keeps the chunk that `next` gave last: its columns stay while the result lives.
  virtual std::shared_ptr<const TetMesh> keep() const = 0;
  /// What was told of the mesh. Call it once `next` has given null.
  virtual const TrailerFacts& facts() const = 0;
};

}  // namespace tet
