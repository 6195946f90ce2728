#include "tests/support/surfaces.h"

#include <cmath>
#include <map>
#include <utility>

#include "core/surface/orient_surface.h"

namespace tet::test {
namespace {

/// Adds quads by the numbers of their corners, in a lattice of so many points.
class LatticeQuads {
 public:
  explicit LatticeQuads(const Blocks& blocks) : blocks_(blocks) {}

  /// The side of block `at` towards `axis`, upwards or downwards.
  void add(std::array<std::ptrdiff_t, 3> at, std::size_t axis, bool up) {
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    if (up) ++at[axis];
    std::array<std::uint32_t, 4> ids;
    for (std::size_t i = 0; i < 4; ++i) {
      std::array<std::ptrdiff_t, 3> corner = at;
      corner[u] += i == 1 || i == 2 ? 1 : 0;
      corner[v] += i >= 2 ? 1 : 0;
      ids[i] = vertex(corner);
    }
    if (!up) std::swap(ids[1], ids[3]);
    surface.triangles.push_back({ids[0], ids[1], ids[2]});
    surface.triangles.push_back({ids[0], ids[2], ids[3]});
  }

  TriangleSurface surface;

 private:
  std::uint32_t vertex(const std::array<std::ptrdiff_t, 3>& at) {
    const auto [it, added] =
        ids_.try_emplace(at, static_cast<std::uint32_t>(surface.vertices.size()));
    if (added) {
      surface.vertices.push_back({blocks_.planes[0][static_cast<std::size_t>(at[0])],
                                  blocks_.planes[1][static_cast<std::size_t>(at[1])],
                                  blocks_.planes[2][static_cast<std::size_t>(at[2])]});
    }
    return it->second;
  }

  const Blocks& blocks_;
  std::map<std::array<std::ptrdiff_t, 3>, std::uint32_t> ids_;
};

std::ptrdiff_t count(const Blocks& blocks, std::size_t axis) {
  return static_cast<std::ptrdiff_t>(blocks.planes[axis].size()) - 1;
}

template <class Visit>
void for_each_full(const Blocks& blocks, const Visit& visit) {
  for (std::ptrdiff_t i = 0; i < count(blocks, 0); ++i) {
    for (std::ptrdiff_t j = 0; j < count(blocks, 1); ++j) {
      for (std::ptrdiff_t k = 0; k < count(blocks, 2); ++k) {
        if (blocks.is_full(i, j, k)) visit(std::array<std::ptrdiff_t, 3>{i, j, k});
      }
    }
  }
}

}  // namespace

bool Blocks::is_full(std::ptrdiff_t i, std::ptrdiff_t j, std::ptrdiff_t k) const {
  const std::ptrdiff_t nx = count(*this, 0), ny = count(*this, 1), nz = count(*this, 2);
  if (i < 0 || j < 0 || k < 0 || i >= nx || j >= ny || k >= nz) return false;
  return full[static_cast<std::size_t>((i * ny + j) * nz + k)] != 0;
}

double Blocks::volume() const {
  double sum = 0;
  for_each_full(*this, [&](const std::array<std::ptrdiff_t, 3>& at) {
    double edges = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<std::size_t>(at[axis]);
      edges *= planes[axis][i + 1] - planes[axis][i];
    }
    sum += edges;
  });
  return sum;
}

TriangleSurface Blocks::surface() const {
  LatticeQuads quads(*this);
  for_each_full(*this, [&](const std::array<std::ptrdiff_t, 3>& at) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const int step : {-1, 1}) {
        std::array<std::ptrdiff_t, 3> beside = at;
        beside[axis] += step;
        if (!is_full(beside[0], beside[1], beside[2])) quads.add(at, axis, step > 0);
      }
    }
  });
  return std::move(quads.surface);
}

Blocks bottle(double outer, double wall, double neck) {
  const double half = outer / 2, side = half - wall;
  const std::vector<double> across{-half, -side, -neck / 2, neck / 2, side, half};
  Blocks blocks{{across, across, {-half, -side, side, half}}, {}};
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < 5; ++j) {
      const bool within = i > 0 && i < 4 && j > 0 && j < 4, middle = i == 2 && j == 2;
      blocks.full.push_back(1);
      blocks.full.push_back(within ? 0 : 1);
      blocks.full.push_back(middle ? 0 : 1);
    }
  }
  return blocks;
}

TriangleSurface box_surface(const WorldPoint& low, const WorldPoint& high) {
  return Blocks{{{{low.x, high.x}, {low.y, high.y}, {low.z, high.z}}}, {1}}.surface();
}

TriangleSurface sphere_surface(const WorldPoint& centre, double radius, int rings) {
  TriangleSurface surface;
  const int sides = rings;
  const auto point = [&](double polar, double around) {
    surface.vertices.push_back({centre.x + radius * std::sin(polar) * std::cos(around),
                                centre.y + radius * std::sin(polar) * std::sin(around),
                                centre.z + radius * std::cos(polar)});
  };
  point(0, 0);
  for (int i = 1; i < rings; ++i) {
    for (int j = 0; j < sides; ++j) point(M_PI * i / rings, 2 * M_PI * j / sides);
  }
  point(M_PI, 0);
  const auto id = [&](int ring, int side) {
    return static_cast<std::uint32_t>(1 + (ring - 1) * sides + side % sides);
  };
  const auto last = static_cast<std::uint32_t>(surface.vertices.size() - 1);
  for (int j = 0; j < sides; ++j) {
    surface.triangles.push_back({0, id(1, j), id(1, j + 1)});
    for (int i = 1; i + 1 < rings; ++i) {
      surface.triangles.push_back({id(i, j), id(i + 1, j), id(i + 1, j + 1)});
      surface.triangles.push_back({id(i, j), id(i + 1, j + 1), id(i, j + 1)});
    }
    surface.triangles.push_back({id(rings - 1, j), last, id(rings - 1, j + 1)});
  }
  return surface;
}

TriangleSurface joined(const TriangleSurface& a, const TriangleSurface& b) {
  TriangleSurface all = a;
  const auto first = static_cast<std::uint32_t>(a.vertices.size());
  all.vertices.insert(all.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& t : b.triangles) {
    all.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  return all;
}

TriangleSurface inside_out(TriangleSurface surface) {
  for (auto& t : surface.triangles) turn(t);
  return surface;
}

TriangleSurface without(TriangleSurface surface, std::size_t first, std::size_t count) {
  const auto begin = surface.triangles.begin() + static_cast<std::ptrdiff_t>(first);
  surface.triangles.erase(begin, begin + static_cast<std::ptrdiff_t>(count));
  return surface;
}

TriangleSurface torn(const TriangleSurface& surface) {
  TriangleSurface result;
  for (const auto& t : surface.triangles) {
    const auto first = static_cast<std::uint32_t>(result.vertices.size());
    for (const std::uint32_t id : t) result.vertices.push_back(surface.vertices[id]);
    result.triangles.push_back({first, first + 1, first + 2});
  }
  return result;
}

TriangleSurface placed(TriangleSurface surface, double scale, const WorldPoint& offset) {
  for (WorldPoint& p : surface.vertices) {
    p = {scale * p.x + offset.x, scale * p.y + offset.y, scale * p.z + offset.z};
  }
  return surface;
}

TriangleSurface rotated(TriangleSurface surface, double radians) {
  const double c = std::cos(radians), s = std::sin(radians);
  for (WorldPoint& p : surface.vertices) {
    p = {c * p.x - s * p.y, s * p.x + c * p.y, p.z};
    p = {p.x, c * p.y - s * p.z, s * p.y + c * p.z};
  }
  return surface;
}

double volume_of(const TriangleSurface& surface) {
  double six = 0;
  for (const auto& t : surface.triangles) six += six_volume(surface, t, surface.vertices[0]);
  return six / 6;
}

}  // namespace tet::test
