// Which faces a region has, at its very borders.
#include "core/mesh/face_labeller.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/mesh/find_faces.h"

namespace tet {
namespace {

WorldPoint in_plane(double degrees) {
  const double radians = degrees * std::numbers::pi / 180;
  return {std::sin(radians), 0, std::cos(radians)};
}

/// Whether a face across `normal` faces `direction` within an angle.
bool is_facing(const WorldPoint& normal, const WorldPoint& direction, double angle_deg) {
  MeshHeader header;
  FaceRegion region{.name = "facing"};
  region.facing = FaceRegion::Facing{direction, angle_deg};
  header.face_regions = {region};
  header.face_labels = face_labels_of(false, false);
  add_region_labels(header.face_regions, header);
  // Across (x, 0, z) lie (z, 0, -x) and the second axis.
  const double edge = 0.3;
  const FacePlace face{{{0, 0, 0}, {-edge * normal.z, 0, edge * normal.x}, {0, -edge / 7, 0}}};
  return FaceLabeller(header, nullptr).label_of(face) != 0;
}

TEST(FaceLabeller, HasTheFacesAtTheVeryAngle) {
  for (int degrees = 0; degrees <= 180; ++degrees) {
    for (const double from : {0.0, 17.0, 45.0, 100.0}) {
      EXPECT_TRUE(is_facing(in_plane(from), in_plane(from + degrees), degrees))
          << degrees << " degrees from " << from;
    }
  }
}

TEST(FaceLabeller, HasNoFaceBeyondTheAngle) {
  for (int degrees = 5; degrees <= 175; ++degrees) {
    EXPECT_FALSE(is_facing(in_plane(0), in_plane(degrees + 1e-6), degrees)) << degrees;
    EXPECT_TRUE(is_facing(in_plane(0), in_plane(degrees - 1e-6), degrees)) << degrees;
  }
}

}  // namespace
}  // namespace tet
