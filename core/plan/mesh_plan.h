// A mesh that is counted but not yet made: totals, chunk table, and a pure function from a
// chunk's number to its bytes.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/quality_stats.h"
#include "core/mesh/boundary_topology.h"
#include "core/mesh/improve/improvement.h"
#include "core/mesh/tet_mesh.h"
#include "core/plan/shape.h"
#include "core/plan/thin_walls.h"

namespace tet {

class MeshWorkspace;

/// What is known of a mesh before its chunks are made.
struct MeshFacts {
  Shape shape = {};
  MeshHeader header = {};
  ThinWalls thin_walls = {};
  Statistics statistics = Statistics::kMeasured;
  std::optional<BoundaryTopology> boundary = {};
  std::optional<Improvement> improvement = {};
  /// See MeshPlan::surface_bricks.
  std::uint64_t surface_bricks = 0;
};

/// The counted mesh of one (shape, request), of any kind: a new kind of mesh derives from this.
/// Immutable: any thread may call any member.
class MeshPlan {
 public:
  virtual ~MeshPlan();
  MeshPlan(const MeshPlan&) = delete;
  MeshPlan& operator=(const MeshPlan&) = delete;

  /// What was meshed, which the plan keeps in memory.
  const Shape& shape() const noexcept { return facts_.shape; }
  const MeshHeader& header() const noexcept { return facts_.header; }
  /// Where the lattice is too coarse for the surface's walls.
  const ThinWalls& thin_walls() const noexcept { return facts_.thin_walls; }
  /// Whether chunks are measured as they are made: not where the request skips that.
  Statistics statistics() const noexcept { return facts_.statistics; }
  /// Topology of the boundary of the inside, counted with the mesh. Nothing where a box cuts
  /// the surface, and where statistics are skipped.
  const std::optional<BoundaryTopology>& boundary() const noexcept { return facts_.boundary; }
  /// What the improvement did, where the request asks for one, and nothing otherwise.
  const std::optional<Improvement>& improvement() const noexcept { return facts_.improvement; }
  /// Bricks of finest cells near the surface that there were to look at; of several grids the
  /// most that one has. A surface of large leaves has far fewer faces than these say. None of
  /// labels.
  std::uint64_t surface_bricks() const noexcept { return facts_.surface_bricks; }

  virtual ChunkExtent chunk(std::uint64_t index) const noexcept = 0;

  /// Makes one chunk. Its bytes depend on (shape, request, index) alone.
  ///
  /// The columns have exactly the chunk's ChunkSizes, but `fields` may be empty: then they are
  /// left out. Returns the chunk's own statistics, which are empty where they are skipped.
  virtual QualityStats fill_chunk(std::uint64_t index,
                                  MeshWorkspace& workspace,
                                  ChunkColumns columns) const noexcept = 0;

  /// Memory that the plan takes, without its shape's.
  virtual std::uint64_t bytes() const noexcept = 0;

 protected:
  explicit MeshPlan(MeshFacts facts);

 private:
  const MeshFacts facts_;
};

}  // namespace tet
