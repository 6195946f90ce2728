#include "core/remap/common_part.h"

#include <utility>

#include "core/base/tet_geometry.h"
#include "core/remap/tet_coordinates.h"

namespace tet {
namespace {

/// The face opposite each corner, turned away from it in a tet that is not turned over.
constexpr std::array<std::array<std::size_t, 3>, 4> kFaces{
    {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

/// Where the plane cuts the edge from a place above it to one below.
WorldPoint crossing(const WorldPoint& above,
                    const WorldPoint& below,
                    double height_above,
                    double height_below) noexcept {
  const double t = height_above / (height_above - height_below);
  return {above.x + t * (below.x - above.x), above.y + t * (below.y - above.y),
          above.z + t * (below.z - above.z)};
}

/// The corners in an order of the same orientation that has those above the plane first.
struct SortedTet {
  TetPlaces place;
  std::array<double, 4> height{};
  std::size_t above = 0;

  SortedTet(const TetPlaces& tet, const std::array<double, 4>& heights) noexcept {
    std::array<std::size_t, 4> order{};
    std::size_t at = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      if (heights[i] > 0) order[at++] = i;
    }
    above = at;
    for (std::size_t i = 0; i < 4; ++i) {
      if (!(heights[i] > 0)) order[at++] = i;
    }
    // An odd order is made even by two corners of the same side.
    int swaps = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = i + 1; j < 4; ++j) swaps += order[i] > order[j] ? 1 : 0;
    }
    if (swaps % 2 != 0) {
      const std::size_t first = above >= 2 ? 0 : 2;
      std::swap(order[first], order[first + 1]);
    }
    for (std::size_t i = 0; i < 4; ++i) {
      place[i] = tet[order[i]];
      height[i] = heights[order[i]];
    }
  }

  WorldPoint cut(std::size_t from, std::size_t to) const noexcept {
    return crossing(place[from], place[to], height[from], height[to]);
  }
};

}  // namespace

/// Keeps what lies above.
void CommonPart::cut(const TetPlaces& tet,
                     const std::array<double, 4>& height,
                     Pieces& kept) noexcept {
  const SortedTet s(tet, height);
  const auto keep = [&](const WorldPoint& a, const WorldPoint& b, const WorldPoint& c,
                        const WorldPoint& d) {
    kept.tet[kept.count++] = {a, b, c, d};
  };
  /// Between two triangles.
  const auto keep_prism = [&](const std::array<WorldPoint, 3>& a,
                              const std::array<WorldPoint, 3>& b) {
    keep(a[0], a[1], a[2], b[0]);
    keep(a[1], a[2], b[0], b[1]);
    keep(a[2], b[0], b[1], b[2]);
  };
  const auto& p = s.place;
  switch (s.above) {
    case 4:
      return keep(p[0], p[1], p[2], p[3]);
    case 3:
      return keep_prism({p[0], p[1], p[2]}, {s.cut(0, 3), s.cut(1, 3), s.cut(2, 3)});
    case 2:
      return keep_prism({p[0], s.cut(0, 2), s.cut(0, 3)}, {p[1], s.cut(1, 2), s.cut(1, 3)});
    case 1:
      return keep(p[0], s.cut(0, 1), s.cut(0, 2), s.cut(0, 3));
    default:
      return;
  }
}

std::span<const TetPlaces> CommonPart::of(const TetPlaces& one,
                                          const TetPlaces& other) noexcept {
  Pieces *now = pieces_.data(), *next = now + 1;
  now->tet[0] = one;
  now->count = 1;
  // All faces turn inward, or none does: where each said it for itself, those of a tet that is
  // all rounding could agree on half of space.
  const double six = six_volumes(other);
  if (is_flat(other, six)) return {};
  const double sign = six > 0 ? -1 : 1;
  for (const auto& [i, j, k] : kFaces) {
    const WorldPoint& on = other[i];
    const Vector normal = cross(from_to(on, other[j]), from_to(on, other[k]));
    next->count = 0;
    for (std::size_t piece = 0; piece < now->count; ++piece) {
      std::array<double, 4> height{};
      for (std::size_t c = 0; c < 4; ++c) {
        height[c] = sign * dot(normal, from_to(on, now->tet[piece][c]));
      }
      cut(now->tet[piece], height, *next);
    }
    std::swap(now, next);
  }
  return {now->tet.data(), now->count};
}

}  // namespace tet
