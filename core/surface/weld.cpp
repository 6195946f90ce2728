#include "core/surface/weld.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/base/union_find.h"

namespace tet {
namespace {

using Cell = std::array<double, 3>;

/// The cell of a lattice of `edge` that a point lies in; `shift` moves the lattice by half an
/// edge along the axes whose bit is set.
Cell cell_of(const WorldPoint& p, double edge, unsigned shift) {
  const auto along = [&](double x, unsigned axis) {
    return std::floor(x / edge + ((shift >> axis & 1U) != 0 ? 0.5 : 0));
  };
  return {along(p.x, 0), along(p.y, 1), along(p.z, 2)};
}

}  // namespace

std::vector<std::uint32_t> weld_equal(const std::vector<WorldPoint>& vertices) {
  const auto key = [&](std::uint32_t i) {
    return std::tie(vertices[i].x, vertices[i].y, vertices[i].z);
  };
  std::vector<std::uint32_t> order(vertices.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple_cat(key(a), std::tie(a)) < std::tuple_cat(key(b), std::tie(b));
  });
  std::vector<std::uint32_t> first(vertices.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && key(order[i]) == key(order[i - 1]);
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

std::vector<std::uint32_t> weld_near(const std::vector<WorldPoint>& vertices,
                                     const std::vector<std::uint32_t>& among,
                                     double tolerance,
                                     std::vector<std::uint32_t> first) {
  // Two points that are near share a cell of twice the tolerance in one of eight lattices.
  UnionFind same(among.size());
  std::vector<std::pair<Cell, std::size_t>> cells(among.size());
  for (unsigned shift = 0; shift < 8; ++shift) {
    for (std::size_t i = 0; i < among.size(); ++i) {
      cells[i] = {cell_of(vertices[among[i]], 2 * tolerance, shift), i};
    }
    std::sort(cells.begin(), cells.end());
    for (std::size_t i = 1; i < cells.size(); ++i) {
      if (cells[i].first == cells[i - 1].first)
        same.unite(cells[i].second, cells[i - 1].second);
    }
  }
  for (std::size_t i = 0; i < among.size(); ++i) first[among[i]] = among[same.find(i)];
  // What was welded to one that is welded now follows it.
  for (std::uint32_t& id : first) id = first[id];
  return first;
}

}  // namespace tet
