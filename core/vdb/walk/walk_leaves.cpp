#include <cstring>

#include "core/vdb/walk/walk_tree.h"

namespace tet {
namespace {

void check_mask(std::uint64_t at, const std::byte* mask, const std::byte* expected) {
  if (std::memcmp(mask, expected, LeafMask::kBytes) != 0) {
    refuse_at(at, "a leaf has another mask than in the tree's topology");
  }
}

void check_origin(VdbCursor& cursor, const VoxelCoord& expected) {
  const std::uint64_t at = cursor.position();
  const auto origin = cursor.read<VoxelCoord>("leaf origin");
  if (origin != expected) {
    refuse_at(
        at, absl::StrFormat("a leaf says that it lies at (%d, %d, %d) instead of (%d, %d, "
                            "%d)",
                            origin.x, origin.y, origin.z, expected.x, expected.y, expected.z));
  }
}

/// What follows a leaf's mask.
void walk_leaf(VdbCursor& cursor,
               const ValueFormat& format,
               const LeafMask& mask,
               const VoxelCoord& origin) {
  if (format.type.leaves == LeafLayout::kValues) {
    walk_values<3>(cursor, format, mask.count());
    return;
  }
  check_origin(cursor, origin);
  if (format.type.leaves == LeafLayout::kBits) cursor.skip(LeafMask::kBytes, "leaf bits");
}

/// `masks` goes through the topology a second time, beside `cursor`.
void walk_run(VdbCursor& cursor,
              VdbCursor& masks,
              const ValueFormat& format,
              const LeafRun& run) {
  masks.move_to(run.children_at);
  const LowerMask children = LowerMask::from_bytes(masks.take(LowerMask::kBytes, "child mask"));
  masks.move_to(run.masks_at);
  children.for_each([&](std::size_t bit) {
    const std::uint64_t at = cursor.position();
    const std::byte* bytes = cursor.take(LeafMask::kBytes, "leaf mask again");
    check_mask(at, bytes, masks.take(LeafMask::kBytes, "leaf mask"));
    const VoxelCoord c = LowerMask::place(bit);
    walk_leaf(cursor, format, LeafMask::from_bytes(bytes),
              {run.origin.x + c.x * kLeafEdge, run.origin.y + c.y * kLeafEdge,
               run.origin.z + c.z * kLeafEdge});
  });
}

}  // namespace

void walk_leaves(VdbCursor& cursor,
                 const ValueFormat& format,
                 const std::vector<LeafRun>& runs) {
  VdbCursor masks = cursor.beside();
  for (const LeafRun& run : runs) walk_run(cursor, masks, format, run);
}

}  // namespace tet
