#include "core/field/world_phi.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/nearly_cubic.h"
#include "tests/support/volume_fixtures.h"

namespace tet {
namespace {

TEST(WorldPhi, IsThatOfTheVoxelsFarOutInAGridThatIsNearlyCubic) {
  const VoxelCoord at = test::kFarVoxel;
  const auto value = [&](VoxelCoord v) {
    return static_cast<float>(0.25 * (v.x - at.x) - 0.5 * (v.y - at.y) + (v.z - at.z));
  };
  const Volume volume =
      test::dense_volume({{at.x - 8, at.y - 8, at.z - 8}, {at.x + 8, at.y + 8, at.z + 8}}, 0,
                         value, test::nearly_cubic());
  PhiField field;
  field.volume = &volume;
  WorldPhi phi(field, 1e-4);
  const WorldPoint p = volume.transform.to_world({at.x + 1.25, at.y - 2.0, at.z + 0.5});
  const auto [here, slope] = phi.slope_at(p);
  EXPECT_NEAR(here, 0.25 * 1.25 + 0.5 * 2 + 0.5, 1e-5);
  constexpr double kStep = 0.01;
  const double along_x = phi.at({p.x + kStep, p.y, p.z}) - phi.at({p.x - kStep, p.y, p.z});
  const double along_y = phi.at({p.x, p.y + kStep, p.z}) - phi.at({p.x, p.y - kStep, p.z});
  const double along_z = phi.at({p.x, p.y, p.z + kStep}) - phi.at({p.x, p.y, p.z - kStep});
  EXPECT_NEAR(slope.x, along_x / (2 * kStep), 1e-6);
  EXPECT_NEAR(slope.y, along_y / (2 * kStep), 1e-6);
  EXPECT_NEAR(slope.z, along_z / (2 * kStep), 1e-6);
}

}  // namespace
}  // namespace tet
