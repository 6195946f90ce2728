// What a file of triangles is, by its bytes alone.
#include "core/triangle_files/surface_format.h"

#include <cstring>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/triangle_files/surface_file.h"

namespace tet {
namespace {

SurfaceFormat format_of(const std::string& bytes) {
  return surface_format(bytes.substr(0, kSurfaceMagicBytes), bytes.size());
}

std::string binary_stl(std::uint32_t claimed,
                       std::uint32_t held,
                       const std::string& title = "") {
  std::string bytes(84 + 50 * std::size_t{held}, '\0');
  title.copy(bytes.data(), 80);
  std::memcpy(bytes.data() + 80, &claimed, sizeof(claimed));
  for (std::uint32_t i = 0; i < held; ++i) {
    const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, static_cast<float>(i)};
    std::memcpy(bytes.data() + 84 + 50 * i + 12, corners, sizeof(corners));
  }
  return bytes;
}

TEST(SurfaceFormat, IsToldByTheFirstLine) {
  EXPECT_EQ(format_of("ply\nformat ascii 1.0\n"), SurfaceFormat::kPly);
  EXPECT_EQ(format_of("ply\r\nformat binary_little_endian 1.0\r\n" + std::string(9, '\0')),
            SurfaceFormat::kPly);
  EXPECT_EQ(format_of("solid part\nfacet normal 0 0 1\n"), SurfaceFormat::kStl);
  EXPECT_EQ(format_of("# by hand\n\n  v 0 0 1\n"), SurfaceFormat::kObj);
  EXPECT_EQ(format_of("\xEF\xBB\xBFmtllib a.mtl\n"), SurfaceFormat::kObj);
}

TEST(SurfaceFormat, OfBinaryStlIsToldByItsSize) {
  EXPECT_EQ(format_of(binary_stl(3, 3)), SurfaceFormat::kStl);
  EXPECT_EQ(format_of(binary_stl(3, 3, "solid as some programs begin")), SurfaceFormat::kStl);
  EXPECT_EQ(format_of(binary_stl(3, 3, "v 1 2 3")), SurfaceFormat::kStl);
  EXPECT_EQ(format_of(binary_stl(4, 3)), SurfaceFormat::kNone);
  EXPECT_EQ(format_of(binary_stl(0xFFFFFFFF, 0)), SurfaceFormat::kNone);
  EXPECT_EQ(format_of(binary_stl(0, 0)), SurfaceFormat::kNone);
}

TEST(SurfaceFormat, IsNoneOfOtherFiles) {
  for (const std::string other :
       {"", "#", "# only a comment\n", "NRRD0004\ntype: float\n", "ObjectType = Image\n",
        "<?xml version=\"1.0\"?>\n", "value 1 2\n", "v", "plywood\n", "ply of wood\n"}) {
    EXPECT_EQ(format_of(other), SurfaceFormat::kNone) << other;
  }
  EXPECT_EQ(format_of(std::string(" BDV\0\0\0\0", 8)), SurfaceFormat::kNone);
  EXPECT_EQ(format_of(std::string("v 1 2 3\n\0", 9)), SurfaceFormat::kNone);
}

TEST(SurfaceFormat, ChoosesTheReader) {
  const auto obj = read_surface_bytes("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  ASSERT_TRUE(obj.ok()) << obj.status();
  EXPECT_EQ(obj->triangles.size(), 1U);
  const auto stl = read_surface_bytes(binary_stl(2, 2));
  ASSERT_TRUE(stl.ok()) << stl.status();
  EXPECT_EQ(stl->triangles.size(), 2U);
  EXPECT_THAT(std::string(read_surface_bytes("something").status().message()),
              testing::HasSubstr("no OBJ, STL or PLY"));
}

}  // namespace
}  // namespace tet
