// Which parts of a mesh are those of an earlier one, brick by brick.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/brick_mask.h"
#include "core/base/cancel.h"
#include "core/mesh/stable/splice.h"
#include "core/plan/brick/counted_mesh.h"
#include "core/plan/brick/kept_bricks.h"

namespace tet {

/// A finest brick that keeps some of its tets: those of all other slices of cells.
struct PartlyNew {
  std::size_t brick = 0;
  BrickMask cells;
};

/// Beyond these a difference is of no use: the whole mesh is sent.
struct PatchLimits {
  /// Runs are in a header, which is one message: of 21 bytes each at most, and gRPC's clients
  /// take 4 MiB unless they say otherwise.
  std::size_t most_runs = 100'000;
  /// One tet of so many; 0 for none. What is put together from a patch is moved once more than
  /// what comes whole: a quarter of a session's frame where nearly all is new.
  std::uint64_t least_kept = 16;
};

/// Two meshes and how they are compared; refers to all that it has.
struct ComparedPair {
  const ComparedMesh& earlier;
  const ComparedMesh& now;
  PatchDetail detail;
  const Cancellation& cancellation;
};

struct MeshDifference {
  KeptParts kept;
  std::vector<BrickRange> changed;  ///< bricks whose tets are not all kept; in order
  std::vector<PartlyNew> partly;    ///< those of them that keep some; in order
};

/// Has one entry a level and reads neither mesh's counts. For the rest see compare_meshes.
/// Bricks that are `unchanged` (see find_unchanged_bricks) are not looked at again; with an
/// empty list all are. It is the same for all details but kWhole. Unspecified once the work is
/// to stop.
std::vector<KeptBricks> find_kept_bricks(const ComparedPair& meshes,
                                         std::vector<BrickPlaces> unchanged);

/// A brick's vertices are kept where each is there and lies where it lay; its tets where that
/// holds for all cells and vertices that they read. Depends on the two fields and the request
/// alone. Both meshes have the same rules and the same way from lattice to world. What `now`
/// found when it was counted after `earlier` is not looked for again. Parallel.
///
/// Where there would be more runs than the limits say, bricks are kept as a whole or not at
/// all. Returns nothing where there are more even so, or less is kept, for which no memory is
/// taken; or where the work is to stop.
std::optional<MeshDifference> compare_meshes(const ComparedPair& meshes,
                                             const PatchLimits& limits);

}  // namespace tet
