// Ids of vertices under other numbers, run by run.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/stable/splice.h"

namespace tet {

/// Tets that are moved at a time: so few that most have ids of a run or two, and that they are
/// still in the nearest cache when they are looked at again.
inline constexpr std::uint64_t kBlockTets = 32;

inline bool holds(const KeptRun& run, std::uint64_t id) noexcept {
  return id >= run.from && id - run.from < run.count;
}

/// New ids of kept vertices: what is to be added to the old ones. Runs are sorted by `from` and
/// do not overlap there. Immutable.
class NewIds {
 public:
  NewIds(std::span<const KeptRun> runs, std::uint64_t from_count)
      : runs_(runs),
        from_count_(from_count),
        shifts_((from_count + kSlot - 1) / kSlot, kNoneKept) {
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const std::uint64_t begin = runs[i].from, end = begin + runs[i].count;
      const std::uint64_t first = (begin + kSlot - 1) / kSlot;
      const std::uint64_t last = end == from_count ? shifts_.size() : end / kSlot;
      if (first >= last) {  // within a slot, or two
        list(begin, end, i);
        continue;
      }
      list(begin, first * kSlot, i);
      for (std::uint64_t slot = first; slot < last; ++slot) {
        shifts_[slot] = runs[i].to - runs[i].from;
      }
      list(last * kSlot, end, i);
    }
  }

  /// The run that holds an id, which is below `from_count`; or null.
  const KeptRun* run_of(std::uint64_t id) const {
    const std::uint64_t listed = shifts_[id / kSlot] ^ kNoneKept;
    if (listed <= lists_.size()) return listed == 0 ? nullptr : listed_run(listed, id);
    const auto after = std::upper_bound(
        runs_.begin(), runs_.end(), id,
        [](std::uint64_t value, const KeptRun& run) { return value < run.from; });
    return &*(after - 1);
  }

  /// Writes ids of the earlier mesh, each below `from_count`; false where one is not kept.
  template <class Index>
  bool move(std::span<const Index> from, Index* to) const {
    for (const Index id : from) {
      std::uint64_t shift = shifts_[id / kSlot];
      if (const std::uint64_t listed = shift ^ kNoneKept; listed <= lists_.size()) {
        const KeptRun* const run = listed == 0 ? nullptr : listed_run(listed, id);
        if (run == nullptr) return false;
        shift = run->to - run->from;
      }
      *to++ = static_cast<Index>(id + shift);  // modulo 2^n, so down too
    }
    return true;
  }

  std::uint64_t from_count() const { return from_count_; }

 private:
  /// Ids in a row that are looked up together where one run holds all of them.
  static constexpr std::uint64_t kSlot = 256;
  /// A slot without any kept id: no shift, as ids are smaller. That of a slot with ids of other
  /// runs, too, is this plus the number of its list, from 1 on.
  static constexpr std::uint64_t kNoneKept = std::uint64_t{1} << 63;
  static constexpr std::uint32_t kNoRun = ~std::uint32_t{0};

  /// Which run each id of a slot is in.
  using RunOfId = std::array<std::uint32_t, kSlot>;

  /// Notes the run of these ids.
  void list(std::uint64_t begin, std::uint64_t end, std::size_t run) {
    for (std::uint64_t id = begin; id < end; ++id) {
      std::uint64_t& shift = shifts_[id / kSlot];
      if (shift == kNoneKept) {
        lists_.emplace_back().fill(kNoRun);
        shift += lists_.size();
      }
      lists_[(shift ^ kNoneKept) - 1][id % kSlot] = static_cast<std::uint32_t>(run);
    }
  }

  const KeptRun* listed_run(std::uint64_t list, std::uint64_t id) const {
    const std::uint32_t run = lists_[list - 1][id % kSlot];
    return run == kNoRun ? nullptr : &runs_[run];
  }

  std::span<const KeptRun> runs_;
  std::uint64_t from_count_;
  std::vector<std::uint64_t> shifts_;  // of each slot
  std::vector<RunOfId> lists_;
};

template <class Index>
struct IdRange {
  Index least, most;
};

/// Finds the least and the most of at least one id.
template <class Index>
IdRange<Index> range_of(std::span<const Index> ids) {
  IdRange<Index> range{ids[0], ids[0]};
  for (const Index id : ids) {  // vectorised, as std::ranges::minmax is not
    range.least = id < range.least ? id : range.least;
    range.most = id > range.most ? id : range.most;
  }
  return range;
}

/// Writes the ids of block after block under their new numbers. Most blocks have ids of one run
/// or of two, and the next block those of the same: only for others each id is looked up.
template <class Index>
class IdMover {
 public:
  explicit IdMover(const NewIds& ids) : ids_(ids) {}

  /// False where one is not kept.
  bool move(std::span<const Index> from, Index* to) {
    const auto [least, most] = range_of(from);
    if (most >= ids_.from_count()) return false;
    if (!enter(least, low_) || !enter(most, high_)) return false;
    if (low_ == high_) {
      add(from, shift_of(*low_), to);
      return true;
    }
    return add_either(from, to) || ids_.move(from, to);
  }

 private:
  static Index shift_of(const KeptRun& run) { return static_cast<Index>(run.to - run.from); }

  /// Makes `run` the one that holds an id.
  bool enter(Index id, const KeptRun*& run) const {
    if (run == nullptr || !holds(*run, id)) run = ids_.run_of(id);
    return run != nullptr;
  }

  static void add(std::span<const Index> from, Index shift, Index* to) {
    for (std::size_t i = 0; i < from.size(); ++i) to[i] = static_cast<Index>(from[i] + shift);
  }

  /// False where some id is in neither run.
  bool add_either(std::span<const Index> from, Index* to) const {
    const auto low_end = static_cast<Index>(low_->from + low_->count);
    const auto high_begin = static_cast<Index>(high_->from);
    const Index low_shift = shift_of(*low_), high_shift = shift_of(*high_);
    Index between = 0;
    for (std::size_t i = 0; i < from.size(); ++i) {
      const Index id = from[i];
      const bool is_high = id >= high_begin;
      between |= static_cast<Index>(id >= low_end) & static_cast<Index>(!is_high);
      to[i] = static_cast<Index>(id + (is_high ? high_shift : low_shift));
    }
    return between == 0;
  }

  const NewIds& ids_;
  const KeptRun *low_ = nullptr, *high_ = nullptr;  // of the block before
};

/// Moves the ids of any number of tets, block by block. False where one is not kept.
template <class Index>
bool move_blocks(IdMover<Index>& mover, std::span<const Index> from, Index* to) {
  constexpr std::size_t kBlockIds = 4 * kBlockTets;
  bool all_kept = true;
  for (std::size_t first = 0; first < from.size(); first += kBlockIds) {
    const auto block = from.subspan(first, std::min(kBlockIds, from.size() - first));
    all_kept = mover.move(block, to + first) && all_kept;
  }
  return all_kept;
}

}  // namespace tet
