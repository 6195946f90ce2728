// Whole meshes in tests, and what several of them ask of one.
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <gtest/gtest.h>

#include "core/mesh/boundary.h"
#include "core/mesh/quality.h"
#include "core/plan/make/fill_mesh.h"
#include "core/plan/make/mesher.h"
#include "core/plan/make/plan_mesh.h"
#include "core/plan/mesh_workspace.h"
#include "core/volume/volume_reader.h"
#include "tests/support/conformity.h"

namespace tet::test {

inline MeshRequest with_levels(int levels) {
  MeshRequest request;
  request.levels = levels;
  return request;
}

/// An empty result, and a failed test, where there is no mesh.
inline MeshResult mesh(const Volume& volume, const MeshRequest& request = {}, int threads = 2) {
  TaskPool pool(threads);
  auto result =
      mesh_volume(pool, {.shape = std::make_shared<const Volume>(volume), .request = request});
  EXPECT_TRUE(result.ok()) << result.status();
  return result.ok() ? *std::move(result) : MeshResult{};
}

inline bool same_bytes(const TetMesh& a, const TetMesh& b) {
  return std::ranges::equal(a.positions.bytes(), b.positions.bytes()) &&
         std::ranges::equal(a.tets.bytes(), b.tets.bytes()) &&
         std::ranges::equal(a.regions.bytes(), b.regions.bytes()) &&
         std::ranges::equal(a.fields.bytes(), b.fields.bytes()) &&
         std::ranges::equal(a.faces.bytes(), b.faces.bytes()) &&
         std::ranges::equal(a.face_tets.bytes(), b.face_tets.bytes()) &&
         std::ranges::equal(a.face_labels.bytes(), b.face_labels.bytes());
}

/// Totals, chunks, topology, thin walls and every byte.
inline void expect_same_plans(const MeshPlan& made, const MeshPlan& expected) {
  EXPECT_EQ(made.header().vertex_count, expected.header().vertex_count);
  EXPECT_EQ(made.header().tet_count, expected.header().tet_count);
  EXPECT_EQ(made.header().chunk_count, expected.header().chunk_count);
  EXPECT_EQ(made.boundary(), expected.boundary());
  EXPECT_EQ(made.thin_walls().inside, expected.thin_walls().inside);
  EXPECT_EQ(made.thin_walls().outside, expected.thin_walls().outside);
  EXPECT_EQ(made.thin_walls().thickness, expected.thin_walls().thickness);
  const auto mesh = fill_mesh(made, Cancellation(), nullptr);
  const auto same = fill_mesh(expected, Cancellation(), nullptr);
  ASSERT_TRUE(mesh.ok() && same.ok());
  EXPECT_TRUE(same_bytes(mesh->mesh, same->mesh));
}

/// Conforming, and within the preset's bounds on angles.
inline void expect_sound(const MeshResult& result, Preset preset = Preset::kDefault) {
  const ConformityReport report = check_conformity(result.mesh);
  EXPECT_TRUE(report.conforming()) << report.describe();
  const QualityStats measured = measure_quality(result.mesh);
  const auto [min, max] = angle_bounds(preset, CoordinateType::kFloat64);
  EXPECT_GT(measured.min_dihedral_deg, min);
  EXPECT_LT(measured.max_dihedral_deg, max);
}

/// Root mean square and largest |phi| over the boundary's vertices, in voxels.
inline std::pair<double, double> distance_from_surface(const Volume& volume,
                                                       const TetMesh& mesh) {
  VolumeReader reader(volume);
  double squares = 0, largest = 0, count = 0;
  for (const Triangle& triangle : boundary_triangles(mesh)) {
    for (const std::uint64_t id : triangle) {
      const WorldPoint p = mesh.vertex(id);
      const double phi = std::abs(reader.trilinear({p.x, p.y, p.z}));
      squares += phi * phi;
      largest = std::max(largest, phi);
      ++count;
    }
  }
  return {std::sqrt(squares / count), largest};
}

}  // namespace tet::test
