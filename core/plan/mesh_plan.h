// A mesh that is counted but not yet made: totals, chunk table, and a pure function from a
// chunk's number to its bytes.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/mesh/boundary.h"
#include "core/mesh/improve.h"
#include "core/mesh/lattice_to_world.h"
#include "core/mesh/quality.h"
#include "core/mesh/tet_mesh.h"
#include "core/plan/mesh_request.h"
#include "core/plan/shape.h"
#include "core/plan/thin_walls.h"

namespace tet {

/// Scratch memory of one task, reused from chunk to chunk. Not thread-safe: one per task.
class MeshWorkspace {
 public:
  MeshWorkspace();
  ~MeshWorkspace();
  MeshWorkspace(MeshWorkspace&&) noexcept;
  MeshWorkspace& operator=(MeshWorkspace&&) noexcept;

  struct Impl;
  Impl& impl() noexcept { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

/// Where long work stands; readable from any thread while it runs.
struct MeshProgress {
  std::atomic<std::uint64_t> done{0}, total{0};  ///< bricks surveyed, of those to survey

  /// So many more are to be surveyed, if that was not known already. One survey after the
  /// other.
  void expect(std::uint64_t bricks) noexcept {
    const std::uint64_t all = done + bricks;
    if (total < all) total = all;
  }
};

/// A survey that was made before, in blocks of so many bricks near the surface.
struct SurveyedBlocks {
  std::size_t block_bricks = 0;
  /// The bytes of one block; nothing where it has to be surveyed again. Null: all of them have.
  std::function<std::optional<std::vector<std::byte>>(std::size_t block)> find = nullptr;
};

/// Where the lattice of a compact mesh lies, and how it was stuffed.
struct CompactFrame {
  LatticeToWorld to_world;
  StuffingRules rules;
};

class CountedMesh;
struct PhiField;

/// A counted mesh and the field that it was counted from.
struct ComparedMesh {
  const CountedMesh& mesh;
  const PhiField& field;
};

/// Bricks of a mesh in the order of ids, the last one excluded.
struct BrickRange {
  std::size_t begin = 0, end = 0;
};

/// The counted mesh of one (shape, request). Immutable: any thread may call any member.
class MeshPlan {
 public:
  struct Impl;
  explicit MeshPlan(std::shared_ptr<const Impl> impl);
  ~MeshPlan();

  const MeshHeader& header() const noexcept;

  /// Where the lattice is too coarse for the surface's walls.
  const ThinWalls& thin_walls() const noexcept;
  /// Whether chunks are measured as they are made: not where the request skips that.
  Statistics statistics() const noexcept;
  /// Topology of the boundary of the inside, counted with the mesh. Nothing where a box cuts
  /// the surface, and where statistics are skipped.
  const std::optional<BoundaryTopology>& boundary() const noexcept;
  ChunkExtent chunk(std::uint64_t index) const noexcept;

  /// Memory that the plan takes, without its volume's.
  std::uint64_t bytes() const noexcept;

  /// Where the request asks for it: what the improvement did, and nothing otherwise.
  const std::optional<Improvement>& improvement() const noexcept { return improvement_; }
  /// Improves the whole mesh as this plan's chunks make it. Not of several grids, whose plan
  /// has them improved where the request asks for it; the next two neither.
  Improvement improve(TetMesh& mesh, const Cancellation& cancellation) const;
  /// The same plan with the positions that an improvement found.
  std::shared_ptr<const MeshPlan> with_positions(ByteBuffer positions,
                                                 const Improvement& improvement) const;

  /// Gives the values of the request's fields to a whole mesh of this plan, wherever its
  /// vertices lie by now. Parallel; run it on a TaskPool.
  void add_fields(TetMesh& mesh) const;

  /// Makes one chunk. Its bytes depend on (shape, request, index) alone.
  ///
  /// The columns have exactly the chunk's ChunkSizes, but `fields` may be empty: then they are
  /// left out. Returns the chunk's own statistics; empty where they are skipped.
  QualityStats fill_chunk(std::uint64_t index,
                          MeshWorkspace& workspace,
                          ChunkColumns columns) const noexcept;

  /// False where the surface is graded: the mesh was made when it was planned, as a whole; and
  /// of several grids, whose meshes are planned each by itself. All that follows is for meshes
  /// of bricks.
  bool has_bricks() const noexcept;

  /// The same by bricks, of which there are any number in a chunk; without fields.
  ComparedMesh counted() const noexcept;
  BrickRange bricks_of_chunk(std::uint64_t index) const noexcept;
  ChunkExtent bricks(const BrickRange& range) const noexcept;
  QualityStats fill_bricks(const BrickRange& range,
                           MeshWorkspace& workspace,
                           ChunkColumns columns) const noexcept;

  /// Appends one chunk as its compact encoding, which depends on (shape, request, index) alone
  /// too. Not for an improved mesh, whose positions no rule implies.
  void encode_chunk(std::uint64_t index,
                    MeshWorkspace& workspace,
                    std::vector<std::byte>& bytes) const;
  /// What compact chunks leave out because all of them share it.
  CompactFrame compact_frame() const noexcept;

 private:
  std::shared_ptr<const Impl> impl_;
  ByteBuffer positions_;  // of all vertices, where they were improved
  std::optional<Improvement> improvement_;
};

/// Counts the mesh: signs, cut points and warps are surveyed, leaves chosen, and every vertex
/// and tet given its place. Parallel; run it on a TaskPool. `progress` may be null. A request
/// to improve the mesh makes the whole of it here once, and keeps the improved positions. What
/// other hosts surveyed is not surveyed again (see divided_survey.h), nor what `earlier`, which
/// may be null, surveyed of a shape that was the same there; the plan's chunks are the same. Of
/// several grids neither is looked at, and the limits are for all together: see joined_plan.h.
///
/// Errors: kInvalidArgument (a field of the request), kFailedPrecondition (the shape has no
/// surface at this iso value, or its inside has no end), kResourceExhausted (over `limits`),
/// kCancelled, kDeadlineExceeded.
absl::StatusOr<std::shared_ptr<const MeshPlan>> plan_mesh(Shape shape,
                                                          const MeshRequest& request,
                                                          const MeshLimits& limits,
                                                          const Cancellation& cancellation,
                                                          MeshProgress* progress,
                                                          const SurveyedBlocks& surveyed = {},
                                                          const MeshPlan* earlier = nullptr);

}  // namespace tet
