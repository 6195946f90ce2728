// Runs of what a brick keeps of what it had, in the order of numbers.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/brick_mask.h"
#include "core/mesh/stable/splice.h"

namespace tet {

/// Appends a run, or makes the last one longer where it goes on.
inline void add_run(std::vector<KeptRun>& runs, const KeptRun& run) {
  if (run.count == 0) return;
  if (!runs.empty()) {
    KeptRun& last = runs.back();
    if (last.from + last.count == run.from && last.to + last.count == run.to) {
      last.count += run.count;
      return;
    }
  }
  runs.push_back(run);
}

/// Goes through what a brick had and what it has, side by side.
class RunWalk {
 public:
  /// Numbers of the first of both.
  RunWalk(std::uint64_t from, std::uint64_t to, std::vector<KeptRun>& runs)
      : from_(from), to_(to), runs_(runs) {}

  /// Passes one for each bit of a slice: `before` was there, `now` is, and `kept` is where both
  /// are the same. `count_before(bits)` tells how many there were of some of them.
  template <class CountBefore, class CountNow>
  void pass(std::uint64_t before,
            std::uint64_t now,
            std::uint64_t kept,
            const CountBefore& count_before,
            const CountNow& count_now) {
    for (std::uint64_t rest = before | now; rest != 0;) {
      const bool keeps = (kept & rest & (~rest + 1)) != 0;
      const std::uint64_t others = rest & (keeps ? ~kept : kept);
      const std::uint64_t alike = rest & ((others & (~others + 1)) - 1);  // below the first
      const std::uint64_t had = count_before(alike & before), has = count_now(alike & now);
      if (keeps) add_run(runs_, {from_, to_, has});
      from_ += had;
      to_ += has;
      rest &= ~alike;
    }
  }

  /// Passes `each` for each bit of these.
  void pass(const BrickMask& before,
            const BrickMask& now,
            const BrickMask& kept,
            std::uint64_t each = 1) {
    const auto count = [each](std::uint64_t bits) {
      return each * static_cast<std::uint64_t>(std::popcount(bits));
    };
    for (std::size_t x = 0; x < before.slice.size(); ++x) {
      pass(before.slice[x], now.slice[x], kept.slice[x], count, count);
    }
  }

 private:
  std::uint64_t from_, to_;
  std::vector<KeptRun>& runs_;
};

}  // namespace tet
