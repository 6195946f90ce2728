// A set of numbers that says how many of its own lie below any: new numbers for what is kept of
// a column, in two bits each.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

namespace tet {

/// Set bits first, then count_ranks, and only then ask.
class RankMask {
 public:
  RankMask() = default;
  /// An empty set of numbers below `size`.
  explicit RankMask(std::uint64_t size) : words_(size / 64 + 1) {}

  bool empty() const noexcept { return words_.empty(); }
  void set(std::uint64_t i) noexcept { words_[i / 64] |= std::uint64_t{1} << (i % 64); }
  bool has(std::uint64_t i) const noexcept { return (words_[i / 64] >> (i % 64) & 1U) != 0; }
  void clear() noexcept { words_.assign(words_.size(), 0); }

  void count_ranks() {
    before_.resize(words_.size());
    count_ = 0;
    for (std::size_t w = 0; w < words_.size(); ++w) {
      before_[w] = count_;
      count_ += static_cast<std::uint64_t>(std::popcount(words_[w]));
    }
  }

  /// How many there are.
  std::uint64_t count() const noexcept { return count_; }
  /// How many there are below i.
  std::uint64_t rank(std::uint64_t i) const noexcept {
    const std::uint64_t below = words_[i / 64] & ((std::uint64_t{1} << (i % 64)) - 1);
    return before_[i / 64] + static_cast<std::uint64_t>(std::popcount(below));
  }
  /// The least one that is `from` or more; there is one.
  std::uint64_t next(std::uint64_t from) const noexcept {
    std::uint64_t w = from / 64;
    std::uint64_t word = words_[w] >> (from % 64) << (from % 64);
    while (word == 0) word = words_[++w];
    return 64 * w + static_cast<std::uint64_t>(std::countr_zero(word));
  }

 private:
  std::vector<std::uint64_t> words_, before_;
  std::uint64_t count_ = 0;
};

}  // namespace tet
