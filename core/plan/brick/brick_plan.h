// The plan of a mesh whose chunks are runs of bricks, each made when it is asked for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/plan/brick/counted_mesh.h"
#include "core/plan/lattice_plan.h"

namespace tet {

class NewParts;

class BrickPlan final : public LatticePlan {
 public:
  /// Takes the chunks from cut_into_chunks, and the header that it filled in.
  BrickPlan(MeshFacts facts,
            MeshSource source,
            CountedMesh mesh,
            std::vector<std::size_t> first_brick);

  /// Refers to the plan.
  ComparedMesh counted() const noexcept { return {mesh_, field()}; }

  // The mesh by bricks, of which there are any number in a chunk; without fields.

  BrickRange bricks_of_chunk(std::uint64_t index) const noexcept;
  ChunkExtent bricks(const BrickRange& range) const noexcept;
  QualityStats fill_bricks(const BrickRange& range,
                           MeshWorkspace& workspace,
                           ChunkColumns columns) const noexcept;
  /// Fills only what is new; columns have the size of NewParts::within.
  QualityStats fill_new(const BrickRange& range,
                        const NewParts& parts,
                        MeshWorkspace& workspace,
                        ChunkColumns columns) const noexcept;

  ChunkExtent chunk(std::uint64_t index) const noexcept override;
  QualityStats fill_chunk(std::uint64_t index,
                          MeshWorkspace& workspace,
                          ChunkColumns columns) const noexcept override;
  std::uint64_t bytes() const noexcept override;

 private:
  const CountedMesh mesh_;
  const std::vector<std::size_t> first_brick_;  // of each chunk, and one more
};

/// The first brick of each chunk, and one more; says in `header` how many chunks there are.
std::vector<std::size_t> cut_into_chunks(const CountedMesh& mesh,
                                         std::size_t chunk_bytes,
                                         MeshHeader& header);

/// Null where the plan's chunks are no runs of bricks.
const BrickPlan* as_bricks(const MeshPlan& plan) noexcept;

/// Shares the plan, which may be null.
std::shared_ptr<const BrickPlan> as_bricks(
    const std::shared_ptr<const MeshPlan>& plan) noexcept;

/// The bricks that a mesh was counted in, though its vertices may have been moved since and its
/// faces named otherwise. Null
/// where there were none.
const BrickPlan* bricks_beneath(const MeshPlan& plan) noexcept;

}  // namespace tet
