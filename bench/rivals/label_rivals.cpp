// One labelled image, meshed by tetstream and by its rivals, with as many tets; one table.
//   label_rivals [EDGE [SPACING [LABELS]]]
//   an image of EDGE^3 voxels (64) with LABELS grains (20) in a ball, on a lattice of SPACING
//   voxels (2)
#include <cmath>
#include <cstdio>
#include <string>

#include "bench/rivals/contender.h"
#include "bench/rivals/grains.h"
#include "bench/rivals/mesh3.h"
#include "bench/rivals/tetstream.h"

namespace tet::rivals {
namespace {

/// The size of cells with which Mesh_3 makes about so many tets, and that mesh.
struct MatchedMesh3 {
  double cell_size;
  Result result;
};

MatchedMesh3 match_mesh3(const LabelCube& cube, double tets, double guess) {
  constexpr double kNearEnough = 0.05;
  constexpr int kTries = 6;
  MatchedMesh3 matched{guess, {}};
  for (int i = 0; i < kTries; ++i) {
    matched.result = measure([&] {
      return mesh_with_mesh3(cube, {.cell_size = matched.cell_size, .optimized = false});
    });
    const double ratio = static_cast<double>(matched.result.tets) / tets;
    std::fprintf(stderr, "cells of %g voxels: %.3g times as many tets\n", matched.cell_size,
                 ratio);
    if (std::abs(ratio - 1) < kNearEnough) break;
    matched.cell_size *= std::cbrt(ratio);
  }
  return matched;
}

void print_row(const char* name, const Result& result, const Result& ours) {
  const auto rate = [](const Result& r) { return static_cast<double>(r.tets) / r.cpu_seconds; };
  std::printf("| %s | %llu | %d | %.2f | %.3g | %.2f | %.2f | %.0f | %.3g |\n", name,
              static_cast<unsigned long long>(result.tets), result.labels, result.cpu_seconds,
              rate(result), result.min_deg, result.max_deg, result.peak_bytes / 1e6,
              rate(ours) / rate(result));
}

void compare(std::int32_t edge, double spacing, int labels) {
  const LabelCube cube = make_grains(edge, labels);
  const Result ours = measure([&] { return mesh_with_tetstream(cube, spacing); });
  const MatchedMesh3 plain = match_mesh3(cube, static_cast<double>(ours.tets), 1.1 * spacing);
  const Result optimized =
      measure([&] { return mesh_with_mesh3(cube, {.cell_size = plain.cell_size}); });
  std::printf("%d^3 voxels, %d grains in a ball, a lattice of %g voxels\n\n", edge, labels,
              spacing);
  std::printf(
      "| mesher | tets | labels | CPU s | tets/CPU s | least angle | greatest | peak MB | "
      "times |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  print_row("tetstream", ours, ours);
  print_row("CGAL Mesh_3 without optimization", plain.result, ours);
  print_row("CGAL Mesh_3 as in its manual", optimized, ours);
}

}  // namespace
}  // namespace tet::rivals

int main(int argc, char** argv) {
  const int edge = argc > 1 ? std::stoi(argv[1]) : 64;
  const double spacing = argc > 2 ? std::stod(argv[2]) : 2;
  const int labels = argc > 3 ? std::stoi(argv[3]) : 20;
  if (edge < 8 || edge > 512 || !(spacing >= 0.25) || labels < 1 || labels > 255) {
    std::fprintf(stderr, "EDGE is 8 to 512, SPACING at least 0.25, LABELS 1 to 255\n");
    return 2;
  }
  tet::rivals::compare(edge, spacing, labels);
}
