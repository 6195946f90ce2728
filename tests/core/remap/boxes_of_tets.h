// Boxes filled with tets, as different from each other as one likes.
#pragma once

#include <cstdint>
#include <functional>
#include <random>

#include "core/remap/data_mesh.h"

namespace tet::test {

/// A box of edge^3 cells of six tets each from `min` on, `size` long; inner points are moved at
/// random by up to `shake` cells, and every other tet is turned over where `turned` says so.
inline DataMesh box_of_tets(std::uint32_t edge,
                            double size,
                            double shake = 0,
                            const WorldPoint& min = {},
                            bool turned = false) {
  DataMesh mesh;
  std::mt19937 random(edge);
  const auto dice = [&] { return shake * (static_cast<double>(random()) / 2147483648.0 - 1); };
  const double step = size / edge;
  const auto is_inner = [&](std::uint32_t i) { return i > 0 && i < edge; };
  for (std::uint32_t x = 0; x <= edge; ++x) {
    for (std::uint32_t y = 0; y <= edge; ++y) {
      for (std::uint32_t z = 0; z <= edge; ++z) {
        const auto at = [&](std::uint32_t i) {
          return step * (i + (is_inner(i) ? dice() : 0));
        };
        mesh.points.push_back({min.x + at(x), min.y + at(y), min.z + at(z)});
      }
    }
  }
  constexpr std::array<std::array<std::uint32_t, 4>, 6> kTets{
      {{0, 4, 6, 7}, {0, 6, 2, 7}, {0, 2, 3, 7}, {0, 3, 1, 7}, {0, 1, 5, 7}, {0, 5, 4, 7}}};
  const auto id = [&](std::uint32_t x, std::uint32_t y, std::uint32_t z, std::uint32_t corner) {
    return ((x + (corner >> 2)) * (edge + 1) + y + (corner >> 1 & 1)) * (edge + 1) + z +
           (corner & 1);
  };
  for (std::uint32_t x = 0; x < edge; ++x) {
    for (std::uint32_t y = 0; y < edge; ++y) {
      for (std::uint32_t z = 0; z < edge; ++z) {
        for (const auto& [a, b, c, d] : kTets) {
          mesh.tets.push_back({id(x, y, z, a), id(x, y, z, b), id(x, y, z, c), id(x, y, z, d)});
          auto& tet = mesh.tets.back();
          if (turned && mesh.tets.size() % 2 == 0) std::swap(tet[0], tet[1]);
        }
      }
    }
  }
  return mesh;
}

/// Values of a function at a mesh's points.
inline DataArray at_points(const DataMesh& mesh,
                           const std::string& name,
                           const std::function<double(const WorldPoint&)>& value) {
  DataArray array{.name = name, .values = {}};
  for (const WorldPoint& p : mesh.points) array.values.push_back(value(p));
  return array;
}

/// Values of a function at the middles of a mesh's cells.
inline DataArray at_cells(const DataMesh& mesh,
                          const std::string& name,
                          const std::function<double(const WorldPoint&)>& value) {
  DataArray array{.name = name, .values = {}};
  for (std::size_t i = 0; i < mesh.tets.size(); ++i) {
    WorldPoint middle;
    for (const WorldPoint& p : mesh.places(i)) {
      middle = {middle.x + p.x / 4, middle.y + p.y / 4, middle.z + p.z / 4};
    }
    array.values.push_back(value(middle));
  }
  return array;
}

}  // namespace tet::test
