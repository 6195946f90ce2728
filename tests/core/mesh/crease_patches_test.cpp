#include "core/mesh/crease_patches.h"

#include <array>
#include <atomic>
#include <chrono>
#include <vector>

#include <gmock/gmock.h>

#include "tests/core/mesh/small_meshes.h"

namespace tet {
namespace {

/// A surface that all faces have one label of.
TetMesh surface_of(const std::vector<WorldPoint>& places, const std::vector<Triangle>& faces) {
  TetMesh surface = make_mesh(places, {});
  surface.header.face_labels = {{.name = "side"}};
  surface.header.face_count = faces.size();
  const ChunkSizes sizes(surface.header, whole_of(surface.header));
  surface.faces = ByteBuffer(sizes.faces);
  surface.face_labels = ByteBuffer(sizes.face_labels);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      internal::store(surface.faces.bytes(), 3 * i + k,
                      static_cast<std::uint32_t>(faces[i][k]));
    }
    internal::store(surface.face_labels.bytes(), i, std::uint16_t{0});
  }
  return surface;
}

constexpr std::uint64_t kPlateEdge = 8;
constexpr std::uint64_t kPlateFaces = 2 * kPlateEdge * kPlateEdge;

/// A plate of squares, and a wire of square section, as long as is asked for, that hangs from
/// one of them: nowhere on the wire is a face calm.
TetMesh plate_with_wire(std::uint64_t length) {
  std::vector<WorldPoint> places;
  std::vector<Triangle> faces;
  const auto add_square = [&](std::uint64_t a, std::uint64_t b, std::uint64_t c,
                              std::uint64_t d) {
    faces.push_back({a, b, c});
    faces.push_back({a, c, d});
  };
  const auto on_plate = [](std::uint64_t x, std::uint64_t y) {
    return x * (kPlateEdge + 1) + y;
  };
  for (std::uint64_t x = 0; x <= kPlateEdge; ++x) {
    for (std::uint64_t y = 0; y <= kPlateEdge; ++y) {
      places.push_back({static_cast<double>(x), static_cast<double>(y), 0});
    }
  }
  for (std::uint64_t x = 0; x < kPlateEdge; ++x) {
    for (std::uint64_t y = 0; y < kPlateEdge; ++y) {
      if (x == 0 && y == 0) continue;  // there the wire begins
      add_square(on_plate(x, y), on_plate(x + 1, y), on_plate(x + 1, y + 1),
                 on_plate(x, y + 1));
    }
  }
  std::array<std::uint64_t, 4> above{on_plate(0, 0), on_plate(1, 0), on_plate(1, 1),
                                     on_plate(0, 1)};
  for (std::uint64_t i = 1; i <= length; ++i) {
    std::array<std::uint64_t, 4> below{};
    for (std::size_t k = 0; k < 4; ++k) {
      const WorldPoint& p = places[above[k]];
      below[k] = places.size();
      places.push_back({p.x, p.y, -static_cast<double>(i)});
    }
    for (std::size_t k = 0; k < 4; ++k) {
      add_square(above[k], above[(k + 1) % 4], below[(k + 1) % 4], below[k]);
    }
    above = below;
  }
  return surface_of(places, faces);
}

TEST(CreasePatches, GrowAlongAWireThatIsNowhereCalm) {
  const CreasePatches found = find_crease_patches(plate_with_wire(50), 0, 35);
  EXPECT_EQ(found.count, 1U);
  EXPECT_THAT(found.patch, testing::Each(0U));
  EXPECT_EQ(found.patch.size(), kPlateFaces - 2 + 8 * 50);
}

/// It looks whether it is to stop before every 65536 faces that are gone over one after the
/// other, and once more a ring: three times a ring, were all faces that are left gone over.
TEST(CreasePatches, GoOverAFaceAFewTimesHoweverManyRingsTheyGrow) {
  constexpr std::uint64_t kLength = 25'000;
  const TetMesh surface = plate_with_wire(kLength);
  constexpr std::uint64_t kRings = 2 * kLength;
  std::atomic<std::uint64_t> looks = 0;
  const Cancellation cancellation(Cancellation::Clock::time_point::max(),
                                  [&] { return ++looks > 5 * kRings / 2; });
  const CreasePatches found = find_crease_patches(surface, 0, 35, cancellation);
  EXPECT_GT(looks, kRings) << "they grow along the wire";
  EXPECT_FALSE(cancellation.requested());
  EXPECT_EQ(found.count, 1U);
}

}  // namespace
}  // namespace tet
