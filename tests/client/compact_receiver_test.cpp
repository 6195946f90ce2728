// Headers of compact meshes, by whoever sent them.
#include "client/library/compact_receiver.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

namespace tet {
namespace {

using Columns = std::array<std::array<double, 3>, 3>;

v1::MeshHeader header_on(const Columns& linear, double spacing) {
  v1::MeshHeader header;
  header.mutable_canonical_request()->set_preset(v1::PRESET_DEFAULT);
  header.set_spacing(spacing);
  for (const auto& row : linear) {
    for (const double entry : row) header.mutable_lattice()->add_linear(entry);
  }
  return header;
}

Columns cubes_of(double edge) { return {{{edge, 0, 0}, {0, edge, 0}, {0, 0, edge}}}; }

bool is_taken(const Columns& linear, double spacing) {
  const auto begun = CompactReceiver::begin(header_on(linear, spacing));
  if (begun.ok()) return true;
  EXPECT_EQ(begun.status().code(), absl::StatusCode::kDataLoss);
  return false;
}

TEST(CompactReceiver, TakesTheLatticesThatServersMake) {
  for (const double edge : {1e-27, 0.1, 1.0, 1e27}) {
    EXPECT_TRUE(is_taken(cubes_of(edge), edge)) << edge;
  }
  const double c = 0.5 * std::cos(0.3), s = 0.5 * std::sin(0.3);
  EXPECT_TRUE(is_taken({{{c, -s, 0}, {s, c, 0}, {0, 0, -0.5}}}, 0.5)) << "turned and mirrored";
}

TEST(CompactReceiver, RefusesLatticesOnWhichPositionsAreNoNumbers) {
  for (const double edge : {0.0, 1e-46, 1e50}) {
    EXPECT_FALSE(is_taken(cubes_of(edge), edge)) << edge;
  }
  EXPECT_FALSE(is_taken(cubes_of(1), 1e-3)) << "of another spacing";
  EXPECT_FALSE(is_taken({{{1, 0, 0}, {0, 1, 0}, {0, 1, 0}}}, 1)) << "flat";
  EXPECT_FALSE(is_taken({{{1, 0, 0}, {0, 1e40, 0}, {0, 0, 1}}}, 1)) << "no cubes";
}

}  // namespace
}  // namespace tet
