#include "core/surface/close_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/tet_geometry.h"
#include "core/surface/cap_loops.h"
#include "core/surface/edge_runs.h"
#include "core/surface/orient_surface.h"
#include "core/surface/weld.h"
#include "core/surface/winding_tree.h"

namespace tet {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

/// Caps that take more than this part of the surface close an opening, not a fault.
constexpr double kSmallCaps = 0.01;

std::vector<Triangle> welded(const std::vector<Triangle>& triangles,
                             const std::vector<std::uint32_t>& first) {
  std::vector<Triangle> kept;
  kept.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    const Triangle v{first[t[0]], first[t[1]], first[t[2]]};
    if (v[0] != v[1] && v[1] != v[2] && v[2] != v[0]) kept.push_back(v);
  }
  return kept;
}

/// A triangle by its corners alone.
struct Corners {
  Triangle sorted;
  std::uint32_t triangle = 0;
  bool even = false;  ///< wound as the sorted corners are

  friend auto operator<=>(const Corners&, const Corners&) = default;
};

Corners corners_of(const Triangle& t, std::uint32_t id) {
  const auto lowest = std::min_element(t.begin(), t.end()) - t.begin();
  const auto at = [&](std::ptrdiff_t i) {
    return t[static_cast<std::size_t>((lowest + i) % 3)];
  };
  const bool even = at(1) < at(2);
  return {{at(0), std::min(at(1), at(2)), std::max(at(1), at(2))}, id, even};
}

/// Which of the triangles with the same corners stay: those wound one way and those wound the
/// other cancel each other, and one of what is left stays. `keep` keeps one of those that
/// cancel.
std::vector<Triangle> without_doubles(const std::vector<Triangle>& triangles,
                                      const std::vector<std::uint8_t>& keep) {
  std::vector<Corners> all(triangles.size());
  for_each_index(
      triangles.size(),
      [&](std::size_t i) { all[i] = corners_of(triangles[i], static_cast<std::uint32_t>(i)); },
      4096);
  std::sort(all.begin(), all.end());
  std::vector<std::uint8_t> stays(triangles.size(), 1);
  for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
    std::ptrdiff_t even = 0;
    for (; end < all.size() && all[end].sorted == all[begin].sorted; ++end) {
      even += all[end].even ? 1 : -1;
    }
    if (end - begin == 1) continue;
    bool missing = even != 0 || keep[all[begin].triangle] != 0;
    for (std::size_t i = begin; i < end; ++i) {
      const bool fits = even == 0 || all[i].even == (even > 0);
      stays[all[i].triangle] = missing && fits ? 1 : 0;
      if (fits) missing = false;
    }
  }
  std::vector<Triangle> kept;
  kept.reserve(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (stays[i] != 0) kept.push_back(triangles[i]);
  }
  return kept;
}

/// The triangles that hang together with `triangles[i]` by any edge, as numbers of groups.
std::vector<std::uint32_t> groups_of(const TriangleSurface& surface,
                                     std::span<const SurfaceSide> sides) {
  std::vector<SurfaceSide> pairs;  // each side with the next of its edge
  for_each_edge(sides, [&](std::span<const SurfaceSide> run) {
    for (std::size_t i = 1; i < run.size(); ++i) {
      const auto number = static_cast<std::uint32_t>(pairs.size());
      pairs.push_back({number, number + 1, run[i - 1].triangle, true});
      pairs.push_back({number, number + 1, run[i].triangle, false});
    }
  });
  return find_pieces(pairs, surface.triangles.size()).piece_of;
}

/// Marks triangles of groups of which nothing would be left: sheets that are doubled
/// throughout, once for each side of them.
std::vector<std::uint8_t> doubled_sheets(const TriangleSurface& surface,
                                         std::span<const SurfaceSide> sides,
                                         const std::vector<Triangle>& left) {
  const std::vector<std::uint32_t> group = groups_of(surface, sides);
  std::vector<std::uint8_t> survives(surface.triangles.size());
  std::vector<Triangle> sorted_left = left;
  std::sort(sorted_left.begin(), sorted_left.end());
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    if (std::binary_search(sorted_left.begin(), sorted_left.end(), surface.triangles[i])) {
      survives[group[i]] = 1;
    }
  }
  std::vector<std::uint8_t> keep(surface.triangles.size());
  for (std::size_t i = 0; i < keep.size(); ++i) keep[i] = survives[group[i]] != 0 ? 0 : 1;
  return keep;
}

void drop_doubles(TriangleSurface& surface, ClosedSurface& result) {
  const std::size_t before = surface.triangles.size();
  const std::vector<std::uint8_t> none(before);
  std::vector<Triangle> left = without_doubles(surface.triangles, none);
  if (left.size() == before) return;
  const std::vector<SurfaceSide> sides = sorted_sides(surface);
  const auto keep = doubled_sheets(surface, sides, left);
  if (std::count(keep.begin(), keep.end(), 1) > 0) {
    left = without_doubles(surface.triangles, keep);
  }
  surface.triangles = std::move(left);
  result.doubled_triangles = before - surface.triangles.size();
}

void count_edges(std::span<const SurfaceSide> sides, ClosedSurface& result) {
  for_each_edge(sides, [&](std::span<const SurfaceSide> run) {
    result.open_edges += run.size() == 1 ? 1 : 0;
    result.non_manifold_edges += run.size() > 2 ? 1 : 0;
  });
}

double diagonal(const HoleLoop& loop, const TriangleSurface& surface) {
  WorldPoint low = surface.vertices[loop[0]], high = low;
  for (const std::uint32_t id : loop) {
    const WorldPoint& p = surface.vertices[id];
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Vector across = from_to(low, high);
  return std::sqrt(dot(across, across));
}

void measure_areas(ClosedSurface& result) {
  const auto& triangles = result.surface.triangles;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const double area = twice_area(result.surface, triangles[i]) / 2;
    (i < result.cap_begin ? result.area : result.cap_area) += area;
  }
}

double signed_volume(const TriangleSurface& surface) {
  if (surface.triangles.empty()) return 0;
  double six = 0;
  const WorldPoint apex = surface.vertices[surface.triangles[0][0]];
  for (const Triangle& t : surface.triangles) six += six_volume(surface, t, apex);
  return six / 6;
}

void turn_all(TriangleSurface& surface) {
  for (Triangle& t : surface.triangles) turn(t);
}

/// A piece of the surface, caps and all, for finding those that are wound inside out.
struct Piece {
  double volume = 0, largest = -1;
  std::size_t triangle = 0;  ///< the largest
  bool open = false;
};

/// Marks pieces that are not closed by themselves: they have edges that they pass more often
/// one way than the other.
std::vector<std::uint8_t> find_open_pieces(std::span<const SurfaceSide> sides,
                                           const SurfacePieces& pieces) {
  std::vector<std::uint8_t> open(pieces.count);
  std::vector<std::pair<std::uint32_t, std::ptrdiff_t>> ways;  // of an edge, by piece
  for_each_edge(sides, [&](std::span<const SurfaceSide> run) {
    if (run.size() == 2) return;
    ways.clear();
    for (const SurfaceSide& side : run) {
      ways.emplace_back(pieces.piece_of[side.triangle], side.upwards ? 1 : -1);
    }
    std::sort(ways.begin(), ways.end());
    for (std::size_t begin = 0, end = 0; begin < ways.size(); begin = end) {
      std::ptrdiff_t sum = 0;
      for (; end < ways.size() && ways[end].first == ways[begin].first; ++end) {
        sum += ways[end].second;
      }
      if (sum != 0) open[ways[begin].first] = 1;
    }
  });
  return open;
}

std::vector<Piece> measure_pieces(const ClosedSurface& result,
                                  std::span<const SurfaceSide> sides,
                                  const SurfacePieces& pieces) {
  const std::vector<std::uint8_t> open = find_open_pieces(sides, pieces);
  std::vector<Piece> measured(pieces.count);
  const WorldPoint apex = result.surface.vertices[result.surface.triangles[0][0]];
  for (std::size_t i = 0; i < result.surface.triangles.size(); ++i) {
    Piece& piece = measured[pieces.piece_of[i]];
    const Triangle& t = result.surface.triangles[i];
    piece.volume += six_volume(result.surface, t, apex);
    const double area = twice_area(result.surface, t);
    if (area > piece.largest) piece.triangle = i;
    piece.largest = std::max(piece.largest, area);
  }
  for (std::size_t i = 0; i < pieces.count; ++i) measured[i].open = open[i] != 0;
  return measured;
}

/// A point just behind the middle of a triangle: outside of a piece that is wound inwards.
WorldPoint behind(const TriangleSurface& surface, const Triangle& t) {
  const WorldPoint &a = surface.vertices[t[0]], &b = surface.vertices[t[1]],
                   &c = surface.vertices[t[2]];
  const Vector n = cross(from_to(a, b), from_to(a, c));
  const double step = 1e-4 / std::sqrt(std::sqrt(dot(n, n)));  // of the triangle's own size
  return {(a.x + b.x + c.x) / 3 - step * n.x, (a.y + b.y + c.y) / 3 - step * n.y,
          (a.z + b.z + c.z) / 3 - step * n.z};
}

/// Turns pieces round that are wound inwards with nothing around them that they could be the
/// cavity of.
void turn_lone_pieces(const SurfacePieces& pieces,
                      const std::vector<Piece>& measured,
                      ClosedSurface& result) {
  std::vector<std::uint8_t> turned(pieces.count);
  const bool any = std::any_of(measured.begin(), measured.end(),
                               [](const Piece& p) { return !p.open && p.volume < 0; });
  if (!any) return;
  const WindingTree tree(result.surface);
  for_each_index(measured.size(), [&](std::size_t i) {
    const Piece& piece = measured[i];
    if (piece.open || piece.volume >= 0 || !(piece.largest > 0)) return;
    const WorldPoint p = behind(result.surface, result.surface.triangles[piece.triangle]);
    turned[i] = tree.at(p) < 0.5 ? 1 : 0;
  });
  for (std::size_t i = 0; i < result.surface.triangles.size(); ++i) {
    if (turned[pieces.piece_of[i]] != 0) turn(result.surface.triangles[i]);
  }
  result.turned_bodies +=
      static_cast<std::uint64_t>(std::count(turned.begin(), turned.end(), 1));
}

void number_bodies(const SurfacePieces& pieces,
                   const std::vector<Piece>& measured,
                   ClosedSurface& result) {
  constexpr double kNothing = 1e-9;  // of what its triangles' size would give
  std::vector<std::uint32_t> body(pieces.count, ClosedSurface::kNoBody);
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const Piece& piece = measured[i];
    const bool encloses =
        std::abs(piece.volume) > kNothing * piece.largest * std::sqrt(piece.largest);
    if (!piece.open && encloses) body[i] = result.bodies++;
  }
  for (const std::uint32_t piece : pieces.piece_of) result.body_of.push_back(body[piece]);
}

/// What hangs together, caps and all.
void judge_pieces(std::span<const SurfaceSide> sides,
                  const SurfacePieces& pieces,
                  ClosedSurface& result) {
  const std::vector<Piece> measured = measure_pieces(result, sides, pieces);
  turn_lone_pieces(pieces, measured, result);
  number_bodies(pieces, measured, result);
}

/// Closes a surface whose equal vertices are one.
ClosedSurface close_welded(TriangleSurface surface) {
  ClosedSurface result;
  drop_doubles(surface, result);
  if (surface.triangles.empty()) {
    result.surface = std::move(surface);
    return result;
  }
  std::vector<SurfaceSide> sides = sorted_sides(surface);
  count_edges(sides, result);
  const SurfacePieces pieces = find_pieces(sides, surface.triangles.size());
  result.turned_triangles = wind_alike(sides, pieces, surface);
  if (result.turned_triangles > 0) sides = sorted_sides(surface);
  const std::vector<HoleLoop> holes = find_holes(sides);
  result.holes = holes.size();
  for (const HoleLoop& loop : holes) {
    result.widest_hole = std::max(result.widest_hole, diagonal(loop, surface));
  }
  result.cap_begin = surface.triangles.size();
  result.surface = std::move(surface);
  add_caps(holes, result.surface);
  measure_areas(result);
  if (signed_volume(result.surface) < 0) {
    turn_all(result.surface);
    result.turned_bodies = 1;
  }
  if (holes.empty()) {
    judge_pieces(sides, pieces, result);
  } else {
    const std::vector<SurfaceSide> all = sorted_sides(result.surface);
    judge_pieces(all, find_pieces(all, result.surface.triangles.size()), result);
  }
  result.volume = signed_volume(result.surface);
  return result;
}

std::vector<std::uint32_t> open_vertices(const TriangleSurface& surface) {
  std::vector<std::uint32_t> vertices;
  for_each_edge(sorted_sides(surface), [&](std::span<const SurfaceSide> run) {
    if (run.size() != 1) return;
    vertices.push_back(run[0].low);
    vertices.push_back(run[0].high);
  });
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

}  // namespace

bool ClosedSurface::nearly_closed(double width) const noexcept {
  return holes == 0 || cap_area <= kSmallCaps * area || widest_hole <= width;
}

ClosedSurface close_surface(const TriangleSurface& surface, double tolerance, double gap) {
  std::vector<std::uint32_t> first = weld_equal(surface.vertices);
  const auto welded_so = [&] {
    return TriangleSurface{surface.vertices, welded(surface.triangles, first)};
  };
  ClosedSurface exact = close_welded(welded_so());
  if (exact.holes == 0) return exact;
  ClosedSurface best = std::move(exact);
  for (double reach = tolerance;; reach = std::min(8 * reach, gap)) {
    const TriangleSurface so_far = welded_so();
    first = weld_near(surface.vertices, open_vertices(so_far), reach, std::move(first));
    ClosedSurface closer = close_welded(welded_so());
    if (closer.cap_area < best.cap_area || closer.holes < best.holes) best = std::move(closer);
    if (best.nearly_closed(0) || reach >= gap) break;
  }
  return best;
}

}  // namespace tet
