// The first pass: signs, cut points and warps of every brick near the surface.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/field/field_difference.h"
#include "core/field/find_bricks.h"
#include "core/octree/octree.h"
#include "core/plan/brick/thin_bricks.h"
#include "core/plan/mesh_progress.h"
#include "core/plan/meshed_space.h"
#include "core/stuffing/brick_geometry.h"
#include "core/stuffing/fill.h"
#include "core/stuffing/restored_nodes.h"
#include "core/stuffing/stuffed_brick.h"
#include "core/stuffing/topology/surface_parts.h"
#include "core/stuffing/topology/surface_topology.h"

namespace tet {

/// Scratch memory for stuffing one brick after another.
struct StuffingWorkspace {
  BrickSamples samples;
  StuffedLattice lattice;
};

/// Stuffs a brick: the method, from its samples to its warped lattice. False, and no lattice,
/// when all nodes that the brick knows lie on one side of the surface; at voxels there may then
/// be no samples either. `restored` may be null.
bool stuff_brick(PhiSampler& sampler,
                 BrickCoord brick,
                 const StuffingRules& rules,
                 const RestoredNodes* restored,
                 StuffingWorkspace& workspace) noexcept;

/// Packed geometry (see brick_geometry.h) of some of a survey's bricks; what is not kept is
/// found again from the samples.
struct KeptGeometry {
  std::vector<const std::byte*> of_brick;  ///< null where it was not kept
  std::vector<std::shared_ptr<const std::byte[]>> blocks;
  std::uint64_t block_bytes = 0;  ///< of all blocks
  /// Bricks of earlier surveys that are in the blocks, which those surveys share, and no longer
  /// in `of_brick`.
  std::uint64_t gone = 0;
};

inline constexpr std::uint32_t kNotKnown = ~std::uint32_t{0};

/// The surface's parts near one brick of a survey.
struct PartsOfBrick {
  std::uint32_t brick = 0;  ///< its place
  /// Shared with the later surveys in which they are the same.
  std::shared_ptr<const SurfaceParts> parts;
};

/// What the survey found, by brick; only bricks whose nodes touch the surface.
struct Survey {
  std::vector<BrickCoord> bricks;  ///< sorted
  std::vector<StuffedBrick> stuffed;
  std::vector<BrickMask> finest;  ///< cells that must stay finest; possibly none
  std::vector<FanMasks> fans;     ///< where both sides are meshed; empty otherwise
  KeptGeometry geometry;
  /// The place of each in the earlier survey that it was taken from, else kNotKnown: until the
  /// mesh is counted, and where there was one.
  std::vector<std::uint32_t> known;
  std::vector<ThinBrick> thin;  ///< sorted; few, and not all of them among `bricks`
  std::shared_ptr<const RestoredNodes> restored;  ///< may be null

  // The surface within each brick.
  std::vector<SurfaceCounts> counts;
  std::vector<SurfaceSheet> sheets;
  /// Where it is not known to be one sheet; sorted by brick.
  std::vector<PartsOfBrick> parts;
  bool has_topology = false;      ///< else nothing was found for the last three
  bool box_cuts_surface = false;  ///< the surface is open, and not counted

  /// Whether a lattice corner is `+` after the warp; refers to the survey, which must outlive
  /// it.
  InsideTest inside_test() const;

  /// Memory it takes, but for the few nodes restored.
  std::uint64_t bytes() const noexcept;
};

/// A survey of the same space when the field was another, and where it still holds.
struct EarlierSurvey {
  const Survey& survey;
  const FieldDifference& difference;
};

/// Whether what was surveyed of `earlier` can hold in `space`: neither was made with regard to
/// other bricks, or to a domain, and what is wanted was looked for.
bool can_reuse(const Survey& earlier, const MeshedSpace& space) noexcept;

/// What `earlier`, which may be null, still says of a brick is taken from it. Errors:
/// kResourceExhausted (more bricks than space.most_bricks), kCancelled, kDeadlineExceeded.
/// `progress` may be null.
absl::StatusOr<Survey> survey_bricks(const PhiField& field,
                                     const std::vector<BrickCoord>& candidates,
                                     const MeshedSpace& space,
                                     const Cancellation& cancellation,
                                     MeshProgress* progress,
                                     const EarlierSurvey* earlier = nullptr);

}  // namespace tet
