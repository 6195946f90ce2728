#include "core/pipeline/mesh_plan.h"

#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include "core/mesh/boundary.h"
#include "core/mesh/conformity.h"
#include "core/pipeline/mesher.h"
#include "tests/support/volume_fixtures.h"

namespace tet {
namespace {

MeshResult mesh(const Volume& v, int levels, int threads = 2) {
  TaskPool pool(threads);
  MeshRequest r;
  r.levels = levels;
  auto result = mesh_volume(pool, std::make_shared<Volume>(v), r, {}, Cancellation(), nullptr);
  if (!result.ok()) { printf("%s\n", result.status().ToString().c_str()); abort(); }
  return *std::move(result);
}

void report(const char* name, const MeshResult& r) {
  auto c = check_conformity(r.mesh);
  auto b = measure_boundary(r.mesh);
  auto q = measure_quality(r.mesh);
  printf("%s: v %zu t %zu levels %d angles %.3f %.3f (full %.3f %.3f) vol %.4f/%.4f  plan %.1f ms fill %.1f ms  b: comp %zu euler %ld nme %zu nmv %zu tris %zu\n", name, r.mesh.header.vertex_count,
    r.mesh.header.tet_count, r.mesh.header.levels, r.quality.min_dihedral_deg, r.quality.max_dihedral_deg, q.min_dihedral_deg, q.max_dihedral_deg, r.quality.volume, q.volume, r.plan_seconds*1e3, r.fill_seconds*1e3, b.components, b.euler_characteristic, b.non_manifold_edges, b.non_manifold_vertices, b.triangles);
  printf("  conform %d %s\n", c.conforming(), c.describe().c_str());
}

TEST(Mesh, Ball) {
  auto ball = [](double R) { return test::narrow_band_volume({{-40,-40,-40},{40,40,40}}, 3, [=](VoxelCoord v){ return float(std::sqrt(double(v.x)*v.x+double(v.y)*v.y+double(v.z)*v.z)-R);}); };
  auto b = ball(27.13);
  report("uniform", mesh(b, 0));
  report("graded", mesh(b, 24));
  report("graded1", mesh(b, 1));
  report("graded2", mesh(b, 2));
  auto rnd = test::dense_volume({{0,0,0},{31,31,31}}, 1, [](VoxelCoord){ return float(rand()%2000-1000)/1000.f;});
  report("random u", mesh(rnd, 0));
  report("random g", mesh(rnd, 24));
}
}  // namespace
}  // namespace tet
