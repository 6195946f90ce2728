#include "core/surface/orient_surface.h"

#include <array>
#include <cmath>
#include <limits>

#include "core/base/tet_geometry.h"
#include "core/base/union_find.h"

namespace tet {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

/// With less than this part of the area on its side no way of winding is a piece's own.
constexpr double kMajority = 0.6;

/// The triangles that a triangle meets in edges of two, and whether they are wound alike.
struct Neighbours {
  std::array<std::uint32_t, 3> triangle{kNone, kNone, kNone};
  std::array<bool, 3> alike{};

  void add(std::uint32_t other, bool is_alike) {
    for (std::size_t i = 0; i < 3; ++i) {
      if (triangle[i] != kNone) continue;
      triangle[i] = other;
      alike[i] = is_alike;
      return;
    }
  }
};

bool is_alike(std::span<const SurfaceSide> pair) { return pair[0].upwards != pair[1].upwards; }

bool all_alike(std::span<const SurfaceSide> sides) {
  bool alike = true;
  for_each_edge(sides, [&](std::span<const SurfaceSide> run) {
    if (run.size() == 2) alike = alike && is_alike(run);
  });
  return alike;
}

std::vector<Neighbours> find_neighbours(std::span<const SurfaceSide> sides, std::size_t count) {
  std::vector<Neighbours> neighbours(count);
  for_each_edge(sides, [&](std::span<const SurfaceSide> run) {
    if (run.size() != 2) return;
    neighbours[run[0].triangle].add(run[1].triangle, is_alike(run));
    neighbours[run[1].triangle].add(run[0].triangle, is_alike(run));
  });
  return neighbours;
}

/// Which triangles have to be turned to be wound like the first of their piece.
std::vector<std::uint8_t> find_turns(const std::vector<Neighbours>& neighbours) {
  std::vector<std::uint8_t> turned(neighbours.size()), seen(neighbours.size());
  std::vector<std::uint32_t> waiting;
  for (std::size_t seed = 0; seed < neighbours.size(); ++seed) {
    if (seen[seed] != 0) continue;
    seen[seed] = 1;
    waiting.push_back(static_cast<std::uint32_t>(seed));
    while (!waiting.empty()) {
      const std::uint32_t t = waiting.back();
      waiting.pop_back();
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t other = neighbours[t].triangle[i];
        if (other == kNone || seen[other] != 0) continue;
        seen[other] = 1;
        turned[other] = neighbours[t].alike[i] ? turned[t] : std::uint8_t(1 - turned[t]);
        waiting.push_back(other);
      }
    }
  }
  return turned;
}

/// What a piece would be if the triangles that `find_turns` names were turned.
struct PieceSides {
  double kept_area = 0, turned_area = 0, volume = 0;

  bool turn_the_others() const {
    const double area = kept_area + turned_area;
    if (turned_area == 0) return false;
    if (kept_area > kMajority * area) return false;
    if (turned_area > kMajority * area) return true;
    return volume < 0;
  }
};

}  // namespace

SurfacePieces find_pieces(std::span<const SurfaceSide> sides, std::size_t triangles) {
  UnionFind joined(triangles);
  for_each_edge(sides, [&](std::span<const SurfaceSide> run) {
    if (run.size() == 2) joined.unite(run[0].triangle, run[1].triangle);
  });
  SurfacePieces pieces;
  pieces.piece_of.resize(triangles);
  for (std::size_t t = 0; t < triangles; ++t) {
    const std::size_t first = joined.find(t);  // the lowest of its set
    pieces.piece_of[t] = first == t ? pieces.count++ : pieces.piece_of[first];
  }
  return pieces;
}

double twice_area(const TriangleSurface& surface, const std::array<std::uint32_t, 3>& t) {
  const auto& v = surface.vertices;
  const Vector n = cross(from_to(v[t[0]], v[t[1]]), from_to(v[t[0]], v[t[2]]));
  return std::sqrt(dot(n, n));
}

double six_volume(const TriangleSurface& surface,
                  const std::array<std::uint32_t, 3>& t,
                  const WorldPoint& apex) {
  const auto& v = surface.vertices;
  return dot(from_to(apex, v[t[0]]), cross(from_to(apex, v[t[1]]), from_to(apex, v[t[2]])));
}

std::uint64_t wind_alike(std::span<const SurfaceSide> sides,
                         const SurfacePieces& pieces,
                         TriangleSurface& surface) {
  if (all_alike(sides)) return 0;
  const std::vector<std::uint8_t> turned =
      find_turns(find_neighbours(sides, surface.triangles.size()));
  std::vector<PieceSides> piece(pieces.count);
  const WorldPoint apex = surface.vertices[surface.triangles[0][0]];
  for (std::size_t t = 0; t < turned.size(); ++t) {
    PieceSides& its = piece[pieces.piece_of[t]];
    const bool is_turned = turned[t] != 0;
    (is_turned ? its.turned_area : its.kept_area) += twice_area(surface, surface.triangles[t]);
    its.volume += (is_turned ? -1 : 1) * six_volume(surface, surface.triangles[t], apex);
  }
  std::uint64_t count = 0;
  for (std::size_t t = 0; t < turned.size(); ++t) {
    if ((turned[t] != 0) == piece[pieces.piece_of[t]].turn_the_others()) continue;
    turn(surface.triangles[t]);
    ++count;
  }
  return count;
}

}  // namespace tet
