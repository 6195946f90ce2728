// The third pass: one brick's vertices and tets, written where the count put them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "core/base/quality.h"
#include "core/mesh/tet_mesh.h"
#include "core/pipeline/counted_mesh.h"
#include "core/pipeline/mesh_plan.h"
#include "core/pipeline/survey.h"

namespace tet {

/// From lattice coordinates to stored positions: linear * (lattice - origin).
struct LatticeToWorld {
  std::array<std::array<double, 3>, 3> linear{};
  VoxelCoord origin;  ///< a lattice corner; stored positions are relative to it
  bool mirrors =
      false;  ///< the map turns positive tets negative, so two of their nodes are swapped
};

struct MeshWorkspace::Impl {
  StuffingWorkspace stuffing;
  FinestIds<std::uint32_t> ids32;
  std::unique_ptr<FinestIds<std::uint64_t>> ids64;  // for meshes beyond 2^32 vertices only
};

/// Fills the bricks of one chunk, one after another.
class BrickFiller {
 public:
  BrickFiller(const CountedMesh& mesh,
              const PhiField& field,
              const MeshHeader& header,
              const LatticeToWorld& to_world,
              MeshWorkspace::Impl& workspace)
      : mesh_(mesh),
        header_(header),
        to_world_(to_world),
        workspace_(workspace),
        sampler_(field) {}

  /// Columns have exactly the brick's size.
  void fill(std::size_t brick, const ChunkColumns& columns) noexcept;

  /// Statistics of all bricks filled so far, in world units.
  QualityStats stats() const noexcept;

 private:
  template <class Index>
  void fill_tets(BrickPlace place,
                 std::span<std::byte> bytes,
                 std::span<std::byte> regions) noexcept;
  template <class Index>
  void number_finest(BrickCoord brick, FinestIds<Index>& ids) noexcept;
  template <class Index>
  Index* fill_finest_tets(std::size_t brick,
                          const FinestIds<Index>& ids,
                          MeshRegion region,
                          Index* out) noexcept;
  template <class Index>
  Index* fill_background_tets(BrickPlace place, MeshRegion region, Index* out) noexcept;
  template <class Index>
  FinestIds<Index>& ids() noexcept;
  template <class Real>
  void fill_positions(BrickPlace place, std::span<std::byte> bytes) noexcept;
  void count_background_quality(const BackgroundCounts& counts, int level) noexcept;

  const CountedMesh& mesh_;
  const MeshHeader& header_;
  const LatticeToWorld& to_world_;
  MeshWorkspace::Impl& workspace_;
  PhiSampler sampler_;
  const StuffedLattice* lattice_ = nullptr;  // of the brick being filled, where it was stuffed
  QualityMeter meter_;
  QualityStats background_;
};

}  // namespace tet
