#include "core/mesh/stable/slot_layout.h"

#include <algorithm>
#include <utility>

namespace tet {
namespace {

std::uint64_t end_of(const SlotRange& range) { return range.begin + range.count; }

/// Sorts ranges, and joins those that touch or overlap.
void join(std::vector<SlotRange>& ranges) {
  std::ranges::sort(ranges, {}, &SlotRange::begin);
  std::size_t kept = 0;
  for (const SlotRange& range : ranges) {
    if (kept > 0 && end_of(ranges[kept - 1]) >= range.begin) {
      SlotRange& last = ranges[kept - 1];
      last.count = std::max(end_of(last), end_of(range)) - last.begin;
    } else {
      ranges[kept++] = range;
    }
  }
  ranges.resize(kept);
}

}  // namespace

SlotLayout::SlotLayout(std::uint64_t count) : count_(count), slots_(count) {
  if (count > 0) runs_ = {{0, 0, count}};
}

SlotChange SlotLayout::follow(std::span<const KeptRun> kept, std::uint64_t count) {
  const SlotLayout before = std::exchange(*this, {});
  count_ = count;
  slots_ = before.slots_;
  std::vector<SlotRange> given_up;
  const auto give_up = [&](std::uint64_t from, std::uint64_t end) {
    before.for_each_run(from, end - from,
                        [&](std::uint64_t slot, std::uint64_t, std::uint64_t n) {
                          given_up.push_back({slot, n});
                        });
  };
  std::uint64_t from = 0;
  for (const KeptRun& run : kept) {
    give_up(from, run.from);
    from = run.from + run.count;
  }
  give_up(from, before.count_);
  join(given_up);
  free_ = before.free_;
  free_.insert(free_.end(), given_up.begin(), given_up.end());
  join(free_);
  std::ranges::reverse(free_);  // the lowest is taken from the end

  std::vector<SlotRange> filled;
  std::uint64_t next = 0;
  for (const KeptRun& run : kept) {
    fill(next, run.to, filled);
    before.for_each_run(run.from, run.count,
                        [&](std::uint64_t slot, std::uint64_t offset, std::uint64_t n) {
                          add({run.to + offset, slot, n});
                        });
    next = run.to + run.count;
  }
  fill(next, count, filled);
  std::ranges::reverse(free_);
  std::vector<SlotRange> changed = given_up;
  changed.insert(changed.end(), filled.begin(), filled.end());
  join(changed);
  return {std::move(given_up), std::move(changed), std::move(filled)};
}

/// Gives slots to new ones, while `free_` is in descending order.
void SlotLayout::fill(std::uint64_t first, std::uint64_t end, std::vector<SlotRange>& filled) {
  while (first < end) {
    if (free_.empty()) {
      add({first, slots_, end - first});
      filled.push_back({slots_, end - first});
      slots_ += end - first;
      return;
    }
    SlotRange& lowest = free_.back();
    const std::uint64_t taken = std::min(lowest.count, end - first);
    add({first, lowest.begin, taken});
    filled.push_back({lowest.begin, taken});
    first += taken;
    lowest.begin += taken;
    lowest.count -= taken;
    if (lowest.count == 0) free_.pop_back();
  }
}

void SlotLayout::add(const SlotRun& run) {
  if (run.count == 0) return;
  if (!runs_.empty()) {
    SlotRun& last = runs_.back();
    if (last.first + last.count == run.first && last.slot + last.count == run.slot) {
      last.count += run.count;
      return;
    }
  }
  runs_.push_back(run);
}

std::vector<KeptRun> SlotLayout::to_slots() const {
  std::vector<KeptRun> runs;
  runs.reserve(runs_.size());
  for (const SlotRun& run : runs_) runs.push_back({run.first, run.slot, run.count});
  return runs;
}

std::vector<KeptRun> SlotLayout::from_slots() const {
  std::vector<KeptRun> runs;
  runs.reserve(runs_.size());
  for (const SlotRun& run : runs_) runs.push_back({run.slot, run.first, run.count});
  std::ranges::sort(runs, {}, &KeptRun::from);
  return runs;
}

}  // namespace tet
