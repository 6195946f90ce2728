// The third pass: the vertices and tets of one brick of labels after another.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "core/base/brick_neighbours.h"
#include "core/base/quality.h"
#include "core/labels/fill_labels.h"
#include "core/mesh/lattice_to_world.h"
#include "core/mesh/tet_mesh.h"
#include "core/plan/brick/background_quality.h"
#include "core/plan/labelled/counted_labels.h"

namespace tet {

/// Scratch memory for filling bricks.
struct LabelledScratch {
  LabelVertices vertices;
  LabelIds<std::uint32_t> ids32;
  std::unique_ptr<LabelIds<std::uint64_t>> ids64;  // for meshes beyond 2^32 vertices only
  LabelFillScratch fill;
};

/// Fills the bricks of a chunk, or of a run of them, one after another.
class LabelledBrickFiller {
 public:
  LabelledBrickFiller(const CountedLabels& mesh,
                      const MeshHeader& header,
                      const LatticeToWorld& to_world,
                      Statistics statistics,
                      LabelledScratch& scratch)
      : mesh_(mesh),
        header_(header),
        to_world_(to_world),
        statistics_(statistics),
        scratch_(scratch),
        numbers_(mesh.numbers()),
        neighbours_(mesh.tree().levels[0].bricks) {}

  /// Columns have exactly the brick's size. Bricks come in ascending order.
  void fill(std::size_t brick, const ChunkColumns& columns);

  /// Statistics of all bricks filled so far, in world units; empty where they are skipped.
  QualityStats stats() const noexcept;

 private:
  template <class Index>
  void fill_finest(std::size_t brick, const PlacesAround& around, const ChunkColumns& columns);
  template <class Index>
  void fill_coarse(BrickPlace place, const PlacesAround& around, const ChunkColumns& columns);
  template <class Index>
  LabelIds<Index>& ids();
  void write_finest_positions(std::size_t brick,
                              const LabelledPart& own,
                              std::span<std::byte> positions) const;
  const PlacesAround& neighbours_of(BrickPlace place);
  template <class Index>
  void mirror(std::span<std::byte> tets) const noexcept;
  QualityStats stats_of_run() const noexcept;

  const CountedLabels& mesh_;
  const MeshHeader& header_;
  const LatticeToWorld& to_world_;
  const Statistics statistics_;
  LabelledScratch& scratch_;
  NodeNumbers numbers_;
  BrickNeighbours neighbours_;  // on their way along a level
  BrickPlace last_;             // the brick that they have come to
  std::size_t filled_ = 0;      // bricks
  QualityStats runs_;           // filled before; then of the one being filled
  QualityMeter meter_;
  BackgroundMeter background_;
};

}  // namespace tet
