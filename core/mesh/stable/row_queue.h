// Where rows that come one after another belong.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/mesh/stable/slot_layout.h"
#include "core/mesh/stable/splice.h"

namespace tet {

/// Rows of a column that are to be written, in the order in which they come.
class RowQueue {
 public:
  RowQueue() = default;
  explicit RowQueue(std::vector<SlotRange> rows) : rows_(std::move(rows)) {}

  /// The numbers below `count` that no run keeps. Runs are sorted, and fit.
  static RowQueue beside(std::span<const KeptRun> kept, std::uint64_t count);

  /// Calls `visit(row, offset, n)` for runs of the next `count` rows; false where there are not
  /// so many left.
  template <class Visit>
  bool take(std::uint64_t count, const Visit& visit);

 private:
  std::vector<SlotRange> rows_;
  std::size_t at_ = 0;
  std::uint64_t taken_ = 0;  ///< of the range that is next
};

inline RowQueue RowQueue::beside(std::span<const KeptRun> kept, std::uint64_t count) {
  std::vector<SlotRange> rows;
  std::uint64_t next = 0;
  for (const KeptRun& run : kept) {
    if (run.to > next) rows.push_back({next, run.to - next});
    next = run.to + run.count;
  }
  if (count > next) rows.push_back({next, count - next});
  return RowQueue(std::move(rows));
}

template <class Visit>
bool RowQueue::take(std::uint64_t count, const Visit& visit) {
  for (std::uint64_t offset = 0; offset < count;) {
    if (at_ == rows_.size()) return false;
    const SlotRange& range = rows_[at_];
    const std::uint64_t n = std::min(range.count - taken_, count - offset);
    visit(range.begin + taken_, offset, n);
    offset += n;
    taken_ += n;
    if (taken_ == range.count) {
      ++at_;
      taken_ = 0;
    }
  }
  return true;
}

}  // namespace tet
