#include "core/vdb/walk/walk_grid.h"

#include <algorithm>
#include <string_view>

#include <absl/strings/str_format.h>

#include "core/vdb/walk/memory_charge.h"
#include "core/vdb/walk/tree_type.h"
#include "core/vdb/walk/walk_refusal.h"
#include "core/vdb/walk/walk_transform.h"
#include "core/vdb/walk/walk_tree.h"

namespace tet {
namespace {

constexpr std::size_t kLongestTreeType = 64;

/// Where a grid says that its parts lie; all 0 in files without offsets.
struct Extent {
  std::uint64_t at = 0;  // of the extent itself
  std::int64_t grid = 0, blocks = 0, end = 0;
};

struct GridDescriptor {
  std::uint64_t at = 0;
  GridOutline grid;
  std::string parent;  // unique name of the grid whose tree it shares
  Extent extent;
};

Extent read_extent(VdbCursor& cursor) {
  Extent extent;
  extent.at = cursor.position();
  extent.grid = cursor.read<std::int64_t>("grid offset");
  extent.blocks = cursor.read<std::int64_t>("block offset");
  extent.end = cursor.read<std::int64_t>("end offset");
  return extent;
}

GridDescriptor read_descriptor(VdbCursor& cursor, const WalkLimits& limits) {
  GridDescriptor descriptor;
  descriptor.at = cursor.position();
  GridOutline& grid = descriptor.grid;
  grid.unique_name = cursor.read_string(limits.name_bytes, "grid name", "grid name text");
  grid.tree_type = cursor.read_string(kLongestTreeType, "grid type", "grid type text");
  constexpr std::string_view kHalf = "_HalfFloat";
  grid.half_float = grid.tree_type.ends_with(kHalf);
  if (grid.half_float) grid.tree_type.resize(grid.tree_type.size() - kHalf.size());
  descriptor.parent =
      cursor.read_string(limits.name_bytes, "instance parent", "instance parent text");
  grid.instance = !descriptor.parent.empty();
  descriptor.extent = read_extent(cursor);
  return descriptor;
}

void check_name(const GridDescriptor& descriptor, const VdbOutline& outline) {
  const auto same = [&](const GridOutline& grid) {
    return grid.unique_name == descriptor.grid.unique_name;
  };
  if (std::any_of(outline.grids.begin(), outline.grids.end(), same)) {
    refuse_at(descriptor.at, absl::StrFormat("there are two grids %s",
                                             quoted_name(descriptor.grid.unique_name)));
  }
}

/// An offset that a grid states, held against where the walk has come to.
void check_offset(const Extent& extent,
                  const char* what,
                  std::int64_t stated,
                  std::uint64_t position) {
  if (stated < 0 || static_cast<std::uint64_t>(stated) != position) {
    refuse_at(extent.at,
              absl::StrFormat("a grid's %s is %d instead of %d", what, stated, position));
  }
}

void check_start(const Extent& extent, const VdbCursor& cursor, bool has_offsets) {
  if (has_offsets) return check_offset(extent, "start offset", extent.grid, cursor.position());
  if (extent.grid != 0 || extent.blocks != 0 || extent.end != 0) {
    refuse_at(extent.at, "a grid states offsets in a file that has none");
  }
}

VdbCompression read_compression(VdbCursor& cursor) {
  constexpr std::uint32_t kZip = 1, kActiveMask = 2, kBlosc = 4;
  const std::uint64_t at = cursor.position();
  const auto flags = cursor.read<std::uint32_t>("compression");
  if (flags > (kZip | kActiveMask | kBlosc)) {
    refuse_at(at, absl::StrFormat("the compression %#x is not known", flags));
  }
  return {(flags & kZip) != 0, (flags & kActiveMask) != 0, (flags & kBlosc) != 0};
}

/// The reader goes by the metadata where it decides whether values are half floats.
void check_half_float(const GridDescriptor& descriptor, const WalkedMetadata& metadata) {
  if (metadata.half_float != descriptor.grid.half_float) {
    refuse_at(descriptor.at,
              "a grid's type and its metadata disagree whether its values are "
              "half floats");
  }
}

/// Jumps over what is not walked, to where the grid says that it ends.
void skip_to_end(VdbCursor& cursor, const Extent& extent) {
  const auto end = static_cast<std::uint64_t>(extent.end);
  if (extent.end < 0 || end < cursor.position() || end - cursor.position() > cursor.left()) {
    refuse_at(extent.at, absl::StrFormat("a grid ends at byte %d, with %d left after byte %d",
                                         extent.end, cursor.left(), cursor.position()));
  }
  cursor.skip(end - cursor.position(), "unwalked grid");
}

void check_can_skip(const GridDescriptor& descriptor, bool has_offsets) {
  if (has_offsets) return;
  refuse_at(descriptor.at, absl::StrFormat("the values of a grid of type %s cannot be passed "
                                           "over, since the file has no offsets",
                                           quoted_name(descriptor.grid.tree_type)));
}

void skip_unknown_tree(VdbCursor& cursor, GridDescriptor& descriptor, bool has_offsets) {
  check_can_skip(descriptor, has_offsets);
  const Extent& extent = descriptor.extent;
  if (extent.blocks < static_cast<std::int64_t>(cursor.position()) ||
      extent.blocks > extent.end) {
    refuse_at(
        extent.at,
        absl::StrFormat("a grid's block offset is %d, within its transform or beyond its end",
                        extent.blocks));
  }
  descriptor.grid.depth = WalkDepth::kSkipped;
  skip_to_end(cursor, extent);
}

void walk_known_tree(VdbCursor& cursor,
                     GridDescriptor& descriptor,
                     const TreeType& type,
                     bool has_offsets) {
  GridOutline& grid = descriptor.grid;
  const ValueFormat format{type, grid.half_float, grid.compression};
  grid.tree_at = cursor.position();
  const Topology topology = walk_topology(cursor, format);
  grid.tree = topology.outline;
  charge_memory(grid.tree, type);
  if (has_offsets) {
    check_offset(descriptor.extent, "block offset", descriptor.extent.blocks,
                 cursor.position());
  }
  if (type.leaves == LeafLayout::kPoints) {
    check_can_skip(descriptor, has_offsets);
    grid.depth = WalkDepth::kTopology;
    return skip_to_end(cursor, descriptor.extent);
  }
  walk_leaves(cursor, format, topology.runs);
}

/// The grid whose tree this one shares.
const GridOutline& find_parent(const GridDescriptor& descriptor, const VdbOutline& outline) {
  const auto parent =
      std::find_if(outline.grids.begin(), outline.grids.end(), [&](const GridOutline& grid) {
        return grid.unique_name == descriptor.parent && !grid.instance &&
               grid.tree_type == descriptor.grid.tree_type &&
               grid.half_float == descriptor.grid.half_float;
      });
  if (parent != outline.grids.end()) return *parent;
  refuse_at(descriptor.at, absl::StrFormat("a grid shares the tree of %s, and there is no such "
                                           "grid of its type before it",
                                           quoted_name(descriptor.parent)));
}

void walk_tree(VdbCursor& cursor, GridDescriptor& descriptor, const VdbOutline& outline) {
  if (descriptor.grid.instance) {
    const GridOutline& parent = find_parent(descriptor, outline);
    descriptor.grid.depth = parent.depth;
    descriptor.grid.tree = parent.tree;
    if (descriptor.extent.blocks != 0) {
      refuse_at(descriptor.extent.at, "a grid has values and shares the tree of another");
    }
    return;
  }
  const TreeType* type = find_tree_type(descriptor.grid.tree_type);
  if (type == nullptr) return skip_unknown_tree(cursor, descriptor, outline.has_offsets);
  walk_known_tree(cursor, descriptor, *type, outline.has_offsets);
}

/// The reader sizes two tables by this number.
void check_delayed_leaves(const GridDescriptor& descriptor, const WalkedMetadata& metadata) {
  const std::uint64_t places = metadata.delayed_leaves.value_or(0);
  if (places != 0 && places != descriptor.grid.tree.leaves) {
    refuse_at(descriptor.at, absl::StrFormat("a grid has places for %d leaves, and %d leaves",
                                             places, descriptor.grid.tree.leaves));
  }
}

}  // namespace

GridOutline walk_grid(VdbCursor& cursor, const VdbOutline& outline, const WalkLimits& limits) {
  GridDescriptor descriptor = read_descriptor(cursor, limits);
  check_name(descriptor, outline);
  check_start(descriptor.extent, cursor, outline.has_offsets);
  descriptor.grid.compression = read_compression(cursor);
  descriptor.grid.metadata_at = cursor.position();
  const WalkedMetadata metadata = walk_metadata(cursor, limits.metadata);
  descriptor.grid.grid_class = metadata.grid_class;
  check_half_float(descriptor, metadata);
  descriptor.grid.map = walk_transform(cursor);
  walk_tree(cursor, descriptor, outline);
  check_delayed_leaves(descriptor, metadata);
  if (outline.has_offsets) {
    check_offset(descriptor.extent, "end offset", descriptor.extent.end, cursor.position());
  }
  return std::move(descriptor.grid);
}

}  // namespace tet
