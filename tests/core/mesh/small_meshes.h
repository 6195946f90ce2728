// Meshes small enough to be right by eye.
#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <span>
#include <vector>

#include "core/mesh/tet_mesh.h"

namespace tet {

using Corners = std::array<std::uint64_t, 4>;

/// How a small mesh is stored.
struct Storage {
  CoordinateType coordinates = CoordinateType::kFloat32;
  IndexType ids = IndexType::kUint32;
  WorldPoint origin{};
};

namespace internal {
template <class Number>
void store(std::span<std::byte> column, std::size_t i, Number number) {
  std::memcpy(column.data() + i * sizeof(Number), &number, sizeof(Number));
}
}  // namespace internal

/// `positions` are relative to the storage's origin.
inline TetMesh make_mesh(const std::vector<WorldPoint>& positions,
                         const std::vector<Corners>& tets,
                         const Storage& storage = {}) {
  MeshHeader header;
  header.vertex_count = positions.size();
  header.tet_count = tets.size();
  header.coordinate_type = storage.coordinates;
  header.index_type = storage.ids;
  header.origin = storage.origin;
  header.spacing = 1;
  TetMesh mesh(header);
  const auto store_coordinate = [&](std::size_t i, double value) {
    if (storage.coordinates == CoordinateType::kFloat64) {
      internal::store(mesh.positions.bytes(), i, value);
    } else {
      internal::store(mesh.positions.bytes(), i, static_cast<float>(value));
    }
  };
  for (std::size_t v = 0; v < positions.size(); ++v) {
    store_coordinate(3 * v, positions[v].x);
    store_coordinate(3 * v + 1, positions[v].y);
    store_coordinate(3 * v + 2, positions[v].z);
  }
  for (std::size_t i = 0; i < 4 * tets.size(); ++i) {
    const std::uint64_t id = tets[i / 4][i % 4];
    if (storage.ids == IndexType::kUint64) {
      internal::store(mesh.tets.bytes(), i, id);
    } else {
      internal::store(mesh.tets.bytes(), i, static_cast<std::uint32_t>(id));
    }
  }
  return mesh;
}

/// Gives the mesh's tets regions: tet i lies inside where `is_inside(i)`.
template <class IsInside>
TetMesh with_regions(TetMesh mesh, const IsInside& is_inside) {
  mesh.header.has_regions = true;
  mesh.regions = ByteBuffer(mesh.header.tet_count);
  for (std::uint64_t i = 0; i < mesh.header.tet_count; ++i) {
    const MeshRegion region = is_inside(i) ? MeshRegion::kInside : MeshRegion::kOutside;
    mesh.regions.bytes()[i] = static_cast<std::byte>(region);
  }
  return mesh;
}

inline std::vector<WorldPoint> unit_corner() {
  return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
}

/// One tet at a corner of the unit cube; volume 1/6.
inline TetMesh one_tet(const Storage& storage = {}) {
  return make_mesh(unit_corner(), {{0, 1, 2, 3}}, storage);
}

/// Lattice points 0 .. n in each direction; the id of (x, y, z) is (x * (n+1) + y) * (n+1) + z.
inline std::vector<WorldPoint> lattice_points(int n) {
  std::vector<WorldPoint> points;
  for (int x = 0; x <= n; ++x) {
    for (int y = 0; y <= n; ++y) {
      for (int z = 0; z <= n; ++z) points.push_back({double(x), double(y), double(z)});
    }
  }
  return points;
}

/// The six tets of one unit cube around its main diagonal (Kuhn's), which fit those of its
/// neighbours; `corner` is the id of its lowest corner, `dx, dy, dz` the steps between ids.
inline void add_kuhn_cube(std::vector<Corners>& tets,
                          std::uint64_t corner,
                          std::array<std::uint64_t, 3> step) {
  const std::array<std::array<std::size_t, 3>, 6> orders{
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  for (std::size_t i = 0; i < orders.size(); ++i) {
    const std::uint64_t first = corner + step[orders[i][0]];
    const std::uint64_t second = first + step[orders[i][1]];
    Corners tet{corner, first, second, second + step[orders[i][2]]};
    if (i >= 3) std::swap(tet[1], tet[2]);  // odd permutations are mirror images
    tets.push_back(tet);
  }
}

/// The cubes of an n x n x n lattice that `keep(x, y, z)` keeps; unused lattice points stay in.
template <class Keep>
TetMesh kuhn_mesh(int n, const Keep& keep, const Storage& storage = {}) {
  std::vector<Corners> tets;
  const auto edge = static_cast<std::uint64_t>(n) + 1;
  for (int x = 0; x < n; ++x) {
    for (int y = 0; y < n; ++y) {
      for (int z = 0; z < n; ++z) {
        const std::uint64_t corner =
            (static_cast<std::uint64_t>(x) * edge + static_cast<std::uint64_t>(y)) * edge +
            static_cast<std::uint64_t>(z);
        if (keep(x, y, z)) add_kuhn_cube(tets, corner, {edge * edge, edge, 1});
      }
    }
  }
  return make_mesh(lattice_points(n), tets, storage);
}

inline TetMesh kuhn_mesh(int n) {
  return kuhn_mesh(n, [](int, int, int) { return true; });
}

/// Gives the mesh fields, whose values all differ.
inline TetMesh with_fields(TetMesh mesh, const std::vector<FieldArray>& fields) {
  mesh.header.fields = fields;
  const std::size_t row = mesh.header.field_values();
  std::vector<float> values(mesh.header.vertex_count * row);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = 0.5F * static_cast<float>(i) - 7;
  mesh.fields = ByteBuffer(values.size() * sizeof(float));
  const std::span<const std::byte> bytes = std::as_bytes(std::span(values));
  std::ranges::copy(bytes, mesh.fields.bytes().begin());
  return mesh;
}

}  // namespace tet
