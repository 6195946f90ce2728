// The third pass: one brick's vertices and tets, written where the count put them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/brick_neighbours.h"
#include "core/base/cancel.h"
#include "core/base/quality.h"
#include "core/mesh/face_labeller.h"
#include "core/mesh/lattice_to_world.h"
#include "core/mesh/tet_mesh.h"
#include "core/plan/brick/background_quality.h"
#include "core/plan/brick/counted_mesh.h"
#include "core/plan/brick/survey.h"
#include "core/plan/brick/write_positions.h"
#include "core/stuffing/brick_geometry.h"
#include "core/stuffing/cell_nodes.h"
#include "core/stuffing/fill.h"
#include "core/stuffing/local_vertices.h"

namespace tet {

/// Scratch memory for filling bricks.
struct BrickScratch {
  StuffingWorkspace stuffing;
  std::array<std::array<std::byte, kMaxGeometryBytes>, 8> geometry;  // that was not kept
  LocalVertices vertices;
  SlotIds<std::uint32_t> ids32;
  std::unique_ptr<SlotIds<std::uint64_t>> ids64;  // for meshes beyond 2^32 vertices only
  StuffedTets stuffed_tets;
  LocalFaces faces;
};

/// Bricks whose statistics are summed by themselves, from the first of a chunk on: parts of a
/// chunk that are filled by different threads have the same sum, to the last bit.
inline constexpr std::size_t kBricksPerRun = 16;

/// Fills the bricks of one chunk, or of a run of them, one after another.
class BrickFiller {
 public:
  BrickFiller(const CountedMesh& mesh,
              const PhiField& field,
              const MeshHeader& header,
              const LatticeToWorld& to_world,
              Statistics statistics,
              BrickScratch& workspace)
      : mesh_(mesh),
        header_(header),
        to_world_(to_world),
        statistics_(statistics),
        workspace_(workspace),
        labeller_(header, field.scene),
        sampler_(field),
        numbers_(mesh.numbers()),
        neighbours_(mesh.tree().levels[0].bricks) {}

  /// From now on it looks at `cancellation`, which must outlive it, within bricks of a scene
  /// that are stuffed again or whose faces its nodes label. Columns are not whole, and what was
  /// filled must not be read, once a look found it cancelled.
  void stop_when(const Cancellation& cancellation) noexcept;

  /// Columns have exactly the brick's size. Where `cells` are not null only their tets are
  /// written, and columns of tets have those alone; the mesh then has no faces.
  void fill(std::size_t brick,
            const ChunkColumns& columns,
            const BrickMask* cells = nullptr) noexcept;

  /// Statistics of all bricks filled so far, in world units; empty where they are skipped.
  QualityStats stats() const noexcept;

 private:
  template <class Index>
  void fill_tets(BrickPlace place,
                 const PlacesAround& places,
                 const BrickMask* cells,
                 const ChunkColumns& columns) noexcept;
  template <class Index>
  void write_faces(std::uint64_t first_tet, const ChunkColumns& columns) noexcept;
  void focus_labeller(const BrickFrame& frame) noexcept;
  FacePlace place_of(const LocalFace& face) const noexcept;
  WorldPoint world_of(const WorldPoint& lattice) const noexcept;
  template <class Index>
  Index* fill_finest_tets(MeshRegion region,
                          Index* out,
                          const Index* limit,
                          std::size_t tets) noexcept;
  template <class Index>
  Index* fill_background_tets(BrickPlace place,
                              const PlacesAround& places,
                              MeshRegion region,
                              Index* out,
                              std::size_t tets) noexcept;
  const PlacesAround& neighbours_of(BrickPlace place) noexcept;
  bool find_vertices(std::size_t brick) noexcept;
  void find_geometry(std::size_t brick) noexcept;
  CellNodes nodes_of(const PlacesAround& places) const noexcept;
  template <class Index>
  SlotIds<Index>& ids() noexcept;
  QualityStats stats_of_run() const noexcept;

  const CountedMesh& mesh_;
  const MeshHeader& header_;
  const LatticeToWorld& to_world_;
  const Statistics statistics_;
  BrickScratch& workspace_;
  const Cancellation* cancellation_ = nullptr;
  FaceLabeller labeller_;
  PhiSampler sampler_;
  NodeNumbers numbers_;
  BrickNeighbours neighbours_;  // on their way along a level
  BrickPlace last_;             // the brick that they have come to
  VerticesAround around_;       // of the brick being filled, where it is finest
  CellNodes nodes_;
  bool has_faces_ = false;
  // What is around the brick that is being filled; set only where the mesh has faces.
  OuterCells outer_;
  BrickSurroundings surroundings_;
  std::array<double, 3> corner_{};  ///< as that of its BrickFrame
  std::size_t filled_ = 0;          // bricks
  QualityStats runs_;               // filled before; then of the one being filled
  QualityMeter meter_;
  BackgroundMeter background_;
};

}  // namespace tet
