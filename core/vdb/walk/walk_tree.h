// The nodes of a tree: first all masks and tiles, then the leaves' values.
#pragma once

#include <cstdint>
#include <vector>

#include "core/vdb/walk/vdb_cursor.h"
#include "core/vdb/walk/vdb_outline.h"
#include "core/vdb/walk/walk_values.h"

namespace tet {

/// The edge of a leaf, in voxels.
inline constexpr std::int32_t kLeafEdge = 8;

/// The leaves below one lower node: their masks lie one after the other.
struct LeafRun {
  std::uint64_t masks_at = 0;     ///< in the file
  std::uint64_t children_at = 0;  ///< in the file: which children the lower node has
  VoxelCoord origin;              ///< of the lower node
  std::uint32_t leaves = 0;
};

struct Topology {
  TreeOutline outline;
  std::vector<LeafRun> runs;  ///< 40 bytes for at least a thousand of the file's
};

/// Walks over buffer count, root, upper and lower nodes, and the leaves' masks.
Topology walk_topology(VdbCursor& cursor, const ValueFormat& format);

/// Walks over the leaves' values, holding each leaf against its mask in the topology.
void walk_leaves(VdbCursor& cursor,
                 const ValueFormat& format,
                 const std::vector<LeafRun>& runs);

}  // namespace tet
