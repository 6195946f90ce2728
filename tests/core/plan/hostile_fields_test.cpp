// Every promise of a mesh, on random fields of every family, with every preset.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/mesh/boundary.h"
#include "core/plan/make/mesher.h"
#include "core/volume/volume_reader.h"
#include "tests/support/mesh_promises.h"
#include "tests/support/random_fields.h"
#include "tests/support/solids.h"
#include "tests/support/volume_fixtures.h"

namespace tet {
namespace {

class HostileFields : public testing::TestWithParam<std::string_view> {};

TEST_P(HostileFields, AreMeshedAsPromised) {
  TaskPool pool(2);
  const std::string family(GetParam());
  const int edge = family == "shapes" ? 64 : 32;  // in blocks of 32
  std::uint64_t tets = 0;
  constexpr std::uint64_t kEnough = 3'000'000;
  for (std::uint32_t seed = 1; tets < kEnough; ++seed) {
    for (const Preset preset : kPresets) {
      test::FieldCase given{family, seed, edge, preset};
      // Every fourth field on a lattice of its own.
      if (seed % 4 == 2) given.spacing = seed % 8 == 2 ? 1.4 : 0.7;
      const test::Outcome outcome = test::check_promises(given, pool);
      ASSERT_EQ(outcome.violation, "") << "field_trial --fields 1 " << arguments_of(given);
      tets += outcome.tets;
    }
    ASSERT_LT(seed, 200U) << "fields too small";
  }
}

INSTANTIATE_TEST_SUITE_P(Fields,
                         HostileFields,
                         testing::ValuesIn(test::field_families().begin(),
                                           test::field_families().end()),
                         [](const auto& family) { return std::string(family.param); });

/// One of the lattice's 48 symmetries about a corner.
struct Symmetry {
  std::array<std::size_t, 3> axis;
  std::array<int, 3> sign;

  VoxelCoord operator()(VoxelCoord v) const {
    const std::array<std::int32_t, 3> at{v.x, v.y, v.z};
    return {sign[0] * at[axis[0]], sign[1] * at[axis[1]], sign[2] * at[axis[2]]};
  }
};

std::vector<Symmetry> all_symmetries() {
  std::vector<Symmetry> all;
  std::array<std::size_t, 3> axis{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      all.push_back({axis, {signs & 1 ? -1 : 1, signs & 2 ? -1 : 1, signs & 4 ? -1 : 1}});
    }
  } while (std::ranges::next_permutation(axis).found);
  return all;
}

TEST(LatticeSymmetries, MapMeshesOfFieldsWithoutTiesOntoOneAnother) {
  constexpr int kHalf = 7;
  TaskPool pool(2);
  const auto mesh = [&](const Symmetry& map, VoxelCoord shift, Preset preset) {
    const VoxelBox box{{shift.x - kHalf, shift.y - kHalf, shift.z - kHalf},
                       {shift.x + kHalf, shift.y + kHalf, shift.z + kHalf}};
    const Volume source = test::random_signs(2 * kHalf + 1, 77);
    VolumeReader reader(source);
    Volume volume = test::dense_volume(box, 1, [&](VoxelCoord v) {
      const VoxelCoord from = map({v.x - shift.x, v.y - shift.y, v.z - shift.z});
      return reader.value({from.x + kHalf, from.y + kHalf, from.z + kHalf});
    });
    MeshRequest request;
    request.levels = 0;  // the octree's bricks do not move with the field
    request.preset = preset;
    return *mesh_volume(
        pool, {.shape = std::make_shared<const Volume>(std::move(volume)), .request = request});
  };
  for (const Preset preset : {Preset::kDefault, Preset::kMinAngle}) {
    const AngleBounds bounds = angle_bounds(preset, CoordinateType::kFloat64);
    const MeshResult plain = mesh(all_symmetries()[0], {0, 0, 0}, preset);
    const BoundaryTopology boundary = measure_boundary(plain.mesh);
    int turn = 0;
    for (const Symmetry& map : all_symmetries()) {
      ++turn;
      const MeshResult mapped = mesh(map, {turn % 8, turn % 5 - 20, 3 * turn}, preset);
      EXPECT_EQ(mapped.mesh.header.vertex_count, plain.mesh.header.vertex_count);
      EXPECT_EQ(mapped.mesh.header.tet_count, plain.mesh.header.tet_count);
      // Two secant steps on a wild cubic end elsewhere when they begin at its other end.
      EXPECT_NEAR(mapped.quality.volume, plain.quality.volume, 0.05);
      EXPECT_GT(mapped.quality.min_dihedral_deg, bounds.min_deg);
      EXPECT_LT(mapped.quality.max_dihedral_deg, bounds.max_deg);
      EXPECT_TRUE(measure_boundary(mapped.mesh) == boundary);
    }
  }
}

}  // namespace
}  // namespace tet
