#include <algorithm>
#include <cstring>
#include <limits>
#include <string>

#include "core/vdb/walk/walk_tree.h"

namespace tet {
namespace {

constexpr std::int32_t kUpperEdge = 4096;
constexpr std::int32_t kLowerEdge = 128;

/// Twice the meshable range: far enough that reading decides nothing, and without overflow.
constexpr std::int32_t kFarthest = 2 * kMaxVoxelCoord;

constexpr std::uint64_t kOriginBytes = 12;
/// An upper node's origin, masks and code.
constexpr std::uint64_t kSmallestUpper = kOriginBytes + 2 * UpperMask::kBytes + 1;

bool contains(const VoxelBox& outer, const VoxelBox& inner) noexcept {
  return !outer.empty() && outer.min.x <= inner.min.x && outer.min.y <= inner.min.y &&
         outer.min.z <= inner.min.z && outer.max.x >= inner.max.x &&
         outer.max.y >= inner.max.y && outer.max.z >= inner.max.z;
}

void expand(VoxelBox& box, const VoxelBox& by) noexcept {
  if (by.empty()) return;
  if (box.empty()) {
    box = by;
    return;
  }
  box.min = {std::min(box.min.x, by.min.x), std::min(box.min.y, by.min.y),
             std::min(box.min.z, by.min.z)};
  box.max = {std::max(box.max.x, by.max.x), std::max(box.max.y, by.max.y),
             std::max(box.max.z, by.max.z)};
}

VoxelBox cube(const VoxelCoord& min, std::int32_t edge) noexcept {
  return {min, {min.x + edge - 1, min.y + edge - 1, min.z + edge - 1}};
}

/// Expands `box` by the set children of a node at `origin`, each `edge` voxels wide.
template <int kLog2>
void expand_by_children(VoxelBox& box,
                        const NodeMask<kLog2>& mask,
                        const VoxelCoord& origin,
                        std::int32_t edge) {
  if (contains(box, cube(origin, edge << kLog2))) return;
  const VoxelBox children = mask.box();
  if (children.empty()) return;
  const auto place = [&](const VoxelCoord& c, std::int32_t more) {
    return VoxelCoord{origin.x + c.x * edge + more, origin.y + c.y * edge + more,
                      origin.z + c.z * edge + more};
  };
  expand(box, {place(children.min, 0), place(children.max, edge - 1)});
}

void add_saturated(std::uint64_t& sum, std::uint64_t count, std::uint64_t each) {
  std::uint64_t product = 0;
  if (__builtin_mul_overflow(count, each, &product) ||
      __builtin_add_overflow(sum, product, &sum)) {
    sum = std::numeric_limits<std::uint64_t>::max();
  }
}

constexpr std::uint64_t cubed(std::uint64_t edge) { return edge * edge * edge; }

class TopologyWalk {
 public:
  TopologyWalk(VdbCursor& cursor, const ValueFormat& format)
      : cursor_(cursor), format_(format) {}

  Topology walk();

 private:
  void walk_root();
  void check_root_counts(std::uint64_t at, std::uint64_t tiles, std::uint64_t children) const;
  void walk_root_tile();
  void walk_upper();
  void walk_lower(const VoxelCoord& origin);
  void walk_leaf_masks(const LowerMask& children, const VoxelCoord& origin);
  VoxelCoord read_origin();
  void check_unique(std::uint64_t at);

  /// A node's masks and values; counts its tiles. Returns which children it has.
  template <int kLog2>
  NodeMask<kLog2> walk_node(const VoxelCoord& origin,
                            std::int32_t child_edge,
                            TileCounts& tiles);

  VdbCursor& cursor_;
  const ValueFormat& format_;
  Topology topology_;
  std::string background_;           // as the file has it
  std::vector<VoxelCoord> origins_;  // of the root's tiles and children
};

Topology TopologyWalk::walk() {
  const std::uint64_t at = cursor_.position();
  const auto buffers = cursor_.read<std::int32_t>("buffer count");
  if (buffers != 1) {
    refuse_at(at, absl::StrFormat("a tree has %d buffers instead of 1", buffers));
  }
  walk_root();
  return std::move(topology_);
}

void TopologyWalk::walk_root() {
  const std::byte* background = cursor_.take(format_.type.value_bytes, "background");
  background_.assign(reinterpret_cast<const char*>(background), format_.type.value_bytes);
  const std::uint64_t at = cursor_.position();
  const auto tiles = cursor_.read<std::uint32_t>("root tile count");
  const auto children = cursor_.read<std::uint32_t>("root child count");
  check_root_counts(at, tiles, children);
  topology_.outline.root_entries = std::uint64_t{tiles} + children;
  for (std::uint32_t i = 0; i < tiles; ++i) walk_root_tile();
  for (std::uint32_t i = 0; i < children; ++i) walk_upper();
  check_unique(at);
}

void TopologyWalk::check_root_counts(std::uint64_t at,
                                     std::uint64_t tiles,
                                     std::uint64_t children) const {
  const std::uint64_t tile_bytes = kOriginBytes + format_.type.value_bytes + 1;
  if (tiles * tile_bytes + children * kSmallestUpper > cursor_.left()) {
    refuse_at(at, absl::StrFormat("a root claims %d tiles and %d children, which do not fit %d "
                                  "bytes",
                                  tiles, children, cursor_.left()));
  }
}

void TopologyWalk::check_unique(std::uint64_t at) {
  std::sort(origins_.begin(), origins_.end());
  const auto twice = std::adjacent_find(origins_.begin(), origins_.end());
  if (twice != origins_.end()) {
    refuse_at(at, absl::StrFormat("a root has two entries at (%d, %d, %d)", twice->x, twice->y,
                                  twice->z));
  }
}

VoxelCoord TopologyWalk::read_origin() {
  const std::uint64_t at = cursor_.position();
  const auto origin = cursor_.read<VoxelCoord>("root origin");
  for (const std::int32_t c : {origin.x, origin.y, origin.z}) {
    if (c % kUpperEdge != 0 || c < -kFarthest || c > kFarthest - kUpperEdge) {
      refuse_at(at,
                absl::StrFormat("a root entry lies at (%d, %d, %d); it must be a multiple of "
                                "%d within %d of the origin",
                                origin.x, origin.y, origin.z, kUpperEdge, kFarthest));
    }
  }
  origins_.push_back(origin);
  return origin;
}

void TopologyWalk::walk_root_tile() {
  const VoxelCoord origin = read_origin();
  const bool background = std::memcmp(cursor_.take(background_.size(), "root tile value"),
                                      background_.data(), background_.size()) == 0;
  const std::uint64_t at = cursor_.position();
  const auto active = cursor_.read<std::uint8_t>("root tile state");
  if (active > 1) refuse_at(at, absl::StrFormat("a root tile has the state %d", active));
  TreeOutline& outline = topology_.outline;
  outline.root_tiles.active += active;
  if (active == 0 && background) return;
  outline.root_tiles.stored += 1;
  expand(outline.stored_box, cube(origin, kUpperEdge));
  if (active == 0) return;
  add_saturated(outline.active_voxels, 1, cubed(kUpperEdge));
  expand(outline.active_box, cube(origin, kUpperEdge));
}

template <int kLog2>
NodeMask<kLog2> TopologyWalk::walk_node(const VoxelCoord& origin,
                                        std::int32_t child_edge,
                                        TileCounts& tiles) {
  using Mask = NodeMask<kLog2>;
  const std::uint64_t at = cursor_.position();
  const Mask children = Mask::from_bytes(cursor_.take(Mask::kBytes, "child mask"));
  const Mask active = Mask::from_bytes(cursor_.take(Mask::kBytes, "value mask"));
  const std::uint32_t both = (children & active).count();
  if (both != 0) refuse_at(at, absl::StrFormat("%d children of a node are active tiles", both));
  const std::uint32_t count = active.count();
  const Mask inactive = walk_values<kLog2>(cursor_, format_, count);
  const Mask stored = ~children & (active | inactive);
  TreeOutline& outline = topology_.outline;
  tiles.active += count;
  tiles.stored += stored.count();
  add_saturated(outline.active_voxels, count, cubed(static_cast<std::uint64_t>(child_edge)));
  expand_by_children(outline.active_box, active, origin, child_edge);
  expand_by_children(outline.stored_box, stored, origin, child_edge);
  return children;
}

void TopologyWalk::walk_upper() {
  const VoxelCoord origin = read_origin();
  topology_.outline.uppers += 1;
  const UpperMask children = walk_node<5>(origin, kLowerEdge, topology_.outline.upper_tiles);
  children.for_each([&](std::size_t bit) {
    const VoxelCoord c = UpperMask::place(bit);
    walk_lower({origin.x + c.x * kLowerEdge, origin.y + c.y * kLowerEdge,
                origin.z + c.z * kLowerEdge});
  });
}

void TopologyWalk::walk_lower(const VoxelCoord& origin) {
  topology_.outline.lowers += 1;
  const std::uint64_t children_at = cursor_.position();
  const LowerMask children = walk_node<4>(origin, kLeafEdge, topology_.outline.lower_tiles);
  const std::uint32_t leaves = children.count();
  if (leaves == 0) return;
  topology_.runs.push_back({cursor_.position(), children_at, origin, leaves});
  topology_.outline.leaves += leaves;
  expand_by_children(topology_.outline.stored_box, children, origin, kLeafEdge);
  walk_leaf_masks(children, origin);
}

void TopologyWalk::walk_leaf_masks(const LowerMask& children, const VoxelCoord& origin) {
  TreeOutline& outline = topology_.outline;
  children.for_each([&](std::size_t bit) {
    const LeafMask mask = LeafMask::from_bytes(cursor_.take(LeafMask::kBytes, "leaf mask"));
    const VoxelCoord c = LowerMask::place(bit);
    add_saturated(outline.active_voxels, mask.count(), 1);
    expand_by_children(
        outline.active_box, mask,
        {origin.x + c.x * kLeafEdge, origin.y + c.y * kLeafEdge, origin.z + c.z * kLeafEdge},
        1);
  });
}

}  // namespace

Topology walk_topology(VdbCursor& cursor, const ValueFormat& format) {
  return TopologyWalk(cursor, format).walk();
}

}  // namespace tet
