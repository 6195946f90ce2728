// Which rows of memory the vertices, or the tets, of a mesh have, where kept ones never move.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/stable/splice.h"

namespace tet {

/// `count` vertices or tets: number `first` on in the mesh, slot `slot` on in memory.
struct SlotRun {
  std::uint64_t first = 0, slot = 0, count = 0;
  friend bool operator==(const SlotRun&, const SlotRun&) = default;
};

/// Slots in a row.
struct SlotRange {
  std::uint64_t begin = 0, count = 0;
  friend bool operator==(const SlotRange&, const SlotRange&) = default;
};

/// What becomes of slots from one mesh to the next. The first two lists are sorted, and their
/// ranges are apart from each other.
struct SlotChange {
  std::vector<SlotRange> given_up;  ///< new ones may be there
  std::vector<SlotRange> changed;   ///< those that were given up, and those that new ones got
  std::vector<SlotRange> filled;    ///< those that new ones got, in the order of their numbers
};

/// The slot of every vertex, or every tet, of one mesh, and those that are nobody's. What it is
/// depends on the meshes that it has followed, and on nothing else.
class SlotLayout {
 public:
  SlotLayout() = default;
  /// Each has the slot of its own number.
  explicit SlotLayout(std::uint64_t count);

  /// Follows to a mesh of `count` that keeps `kept`: those that are kept stay in their slots,
  /// and the others get, in their order, the lowest that are free; what those do not hold is
  /// added at the end.
  SlotChange follow(std::span<const KeptRun> kept, std::uint64_t count);

  std::uint64_t count() const noexcept { return count_; }
  /// Slots, holes with them.
  std::uint64_t slots() const noexcept { return slots_; }
  std::uint64_t holes() const noexcept { return slots_ - count_; }
  /// Sorted by number; all of the mesh.
  const std::vector<SlotRun>& runs() const noexcept { return runs_; }
  /// Sorted, apart from each other.
  const std::vector<SlotRange>& free() const noexcept { return free_; }

  /// Calls `visit(slot, offset, count)` for the runs of `count` numbers from `first` on, which
  /// the mesh has.
  template <class Visit>
  void for_each_run(std::uint64_t first, std::uint64_t count, const Visit& visit) const;

  /// The runs as numbers that become slots, sorted by number; and the other way round, sorted
  /// by slot.
  std::vector<KeptRun> to_slots() const;
  std::vector<KeptRun> from_slots() const;

 private:
  void add(const SlotRun& run);
  void fill(std::uint64_t first, std::uint64_t end, std::vector<SlotRange>& filled);

  std::uint64_t count_ = 0, slots_ = 0;
  std::vector<SlotRun> runs_;
  std::vector<SlotRange> free_;
};

template <class Visit>
void SlotLayout::for_each_run(std::uint64_t first,
                              std::uint64_t count,
                              const Visit& visit) const {
  auto run = std::upper_bound(
      runs_.begin(), runs_.end(), first,
      [](std::uint64_t number, const SlotRun& r) { return number < r.first + r.count; });
  const std::uint64_t end = first + count;
  for (std::uint64_t at = first; at < end; ++run) {
    const std::uint64_t skipped = at - run->first;
    const std::uint64_t taken = std::min(run->count - skipped, end - at);
    visit(run->slot + skipped, at - first, taken);
    at += taken;
  }
}

}  // namespace tet
