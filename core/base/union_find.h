// Disjoint sets, and what unites them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace tet {

/// Disjoint sets of 0 .. count-1.
class UnionFind {
 public:
  explicit UnionFind(std::size_t count) : parent_(count), sets_(count) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }

  std::size_t find(std::size_t i) noexcept {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  void unite(std::size_t i, std::size_t j) noexcept {
    i = find(i);
    j = find(j);
    if (i == j) return;
    parent_[std::max(i, j)] = std::min(i, j);
    --sets_;
  }

  std::size_t sets() const noexcept { return sets_; }

 private:
  std::vector<std::size_t> parent_;
  std::size_t sets_;
};

}  // namespace tet
