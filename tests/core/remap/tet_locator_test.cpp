#include "core/remap/tet_locator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "core/mesh/triangle_distance.h"
#include "tests/core/remap/boxes_of_tets.h"

namespace tet {
namespace {

using test::box_of_tets;

bool lies_in(const DataMesh& mesh, std::size_t tet, const WorldPoint& p) {
  return least_of(shares_of(mesh.places(tet), p)) >= -1e-12;
}

bool lies_in_any(const DataMesh& mesh, const WorldPoint& p) {
  for (std::size_t tet = 0; tet < mesh.tets.size(); ++tet) {
    if (lies_in(mesh, tet, p)) return true;
  }
  return false;
}

/// The distance from every face of a tet, of which that of the tet is the least outside.
double distance_to(const DataMesh& mesh, std::size_t tet, const WorldPoint& p) {
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t corner = 0; corner < 4; ++corner) {
    least = std::min(
        least, squared_distance(p, places_of(mesh, {static_cast<std::uint32_t>(tet), corner})));
  }
  return std::sqrt(least);
}

double distance_to_all(const DataMesh& mesh, const WorldPoint& p) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t tet = 0; tet < mesh.tets.size(); ++tet) {
    least = std::min(least, distance_to(mesh, tet, p));
  }
  return least;
}

/// Points around a box of size 1: near each other, as on a walk, with jumps between.
std::vector<WorldPoint> some_points(std::size_t count) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-0.3, 1.3), step(-0.05, 0.05);
  std::vector<WorldPoint> points;
  WorldPoint at;
  for (std::size_t i = 0; i < count; ++i) {
    if (i % 16 == 0) at = {place(random), place(random), place(random)};
    at = {at.x + step(random), at.y + step(random), at.z + step(random)};
    points.push_back(at);
  }
  return points;
}

/// What is found is what looking at every tet finds, whatever was found before.
void expect_right_places(const DataMesh& mesh) {
  const TetLocator locator(mesh);
  std::uint32_t last = 0;
  for (const WorldPoint& p : some_points(400)) {
    const bool is_inside = lies_in_any(mesh, p);
    for (const TetLocator::Place& place : {locator.find(p), locator.find(p, last)}) {
      ASSERT_EQ(place.outside, !is_inside) << p.x << " " << p.y << " " << p.z;
      if (is_inside) {
        ASSERT_TRUE(lies_in(mesh, place.tet, p));
        continue;
      }
      ASSERT_NEAR(place.distance, distance_to_all(mesh, p), 1e-9);
      ASSERT_NEAR(place.distance, distance_to(mesh, place.tet, p), 1e-9);
      last = place.tet;
    }
  }
}

TEST(TetLocator, FindsTheTetAroundAPointOrTheNearest) {
  expect_right_places(box_of_tets(6, 1, 0.2));
  expect_right_places(box_of_tets(6, 1, 0.2, {}, true));
  expect_right_places(box_of_tets(1, 1));
}

TEST(TetLocator, FindsThemInMeshesOfSeveralPieces) {
  DataMesh mesh = box_of_tets(3, 0.4);
  const DataMesh other = box_of_tets(4, 0.4, 0.1, {0.6, 0.5, 0.3});
  const auto shift = static_cast<std::uint32_t>(mesh.points.size());
  mesh.points.insert(mesh.points.end(), other.points.begin(), other.points.end());
  for (auto tet : other.tets) {
    for (std::uint32_t& id : tet) id += shift;
    mesh.tets.push_back(tet);
  }
  expect_right_places(mesh);
}

TEST(TetLocator, FindsThemInMeshesThatOverlapThemselvesOrAreFlat) {
  DataMesh mesh = box_of_tets(3, 1, 0.2);
  mesh.tets.push_back(mesh.tets[7]);  // twice
  mesh.tets.push_back(mesh.tets[9]);  // thrice, once turned over
  mesh.tets.push_back(mesh.tets[9]);
  std::swap(mesh.tets.back()[0], mesh.tets.back()[1]);
  mesh.tets.push_back({0, 1, 2, 2});   // flat
  mesh.tets.push_back({0, 5, 9, 22});  // across others
  expect_right_places(mesh);

  DataMesh twice = box_of_tets(1, 1);
  twice.tets = {twice.tets[0], twice.tets[0]};  // every face has two tets, on one side
  expect_right_places(twice);
}

TEST(TetLocator, HoldsHolesForWhatTheyAre) {
  DataMesh mesh = box_of_tets(5, 1, 0.1);
  std::erase_if(mesh.tets, [&](const auto& tet) {
    const WorldPoint& p = mesh.points[tet[0]];
    return std::abs(p.x - 0.4) < 0.15 && std::abs(p.y - 0.4) < 0.3;
  });
  expect_right_places(mesh);
}

TEST(TetLocator, FindsTheTetsBeyondEachFace) {
  const DataMesh mesh = box_of_tets(3, 1, 0.2, {}, true);
  const TetNeighbors found = find_neighbors(mesh);
  EXPECT_EQ(found.border.size(), 6U * 9 * 2) << "two triangles a square";
  for (std::size_t tet = 0; tet < mesh.tets.size(); ++tet) {
    for (std::uint32_t corner = 0; corner < 4; ++corner) {
      const std::uint32_t other = found.across[tet][corner];
      if (other == TetNeighbors::kNone) continue;
      EXPECT_TRUE(std::ranges::find(found.across[other], tet) != found.across[other].end());
      std::size_t shared = 0;
      for (const std::uint32_t id : mesh.tets[tet]) {
        shared += static_cast<std::size_t>(std::ranges::count(mesh.tets[other], id));
      }
      EXPECT_EQ(shared, 3U);
    }
  }
}

}  // namespace
}  // namespace tet
