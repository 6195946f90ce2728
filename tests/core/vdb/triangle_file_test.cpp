// Files of triangles in the place of grids: the decoder makes a solid of them, or says why not.
#include "core/vdb/walk/triangle_file.h"

#include <fstream>
#include <string>

#include <absl/strings/str_cat.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/surface/default_voxel.h"
#include "core/triangle_files/surface_file.h"
#include "core/vdb/openvdb/surface_to_volume.h"
#include "tests/core/vdb/decode_test_files.h"
#include "tests/support/surfaces.h"

namespace tet {
namespace {

using testing::HasSubstr;

class TriangleFileTest : public test::DecodeTest {
 protected:
  void write(const std::string& bytes) { std::ofstream(path_, std::ios::binary) << bytes; }
  void write(const TriangleSurface& surface) { write(obj_of(surface)); }

  static std::string obj_of(const TriangleSurface& surface) {
    std::string text = "# by a test\n";
    for (const auto& [x, y, z] : surface.vertices) {
      absl::StrAppend(&text, "v ", x, " ", y, " ", z, "\n");
    }
    for (const auto& [a, b, c] : surface.triangles) {
      absl::StrAppend(&text, "f ", a + 1, " ", b + 1, " ", c + 1, "\n");
    }
    return text;
  }

  FileRequest order(DecodeTask task = DecodeTask::kVolume,
                    const std::string& grid_name = "") const {
    FileRequest request = this->request(grid_name);
    request.task = task;
    request.max_bytes = std::uint64_t{1} << 30;
    return request;
  }

  absl::StatusOr<Volume> decoded(const FileRequest& request) const {
    return volume_of(decode_once(request, test::patient_settings(), nullptr), request);
  }

  std::string refusal() const {
    const absl::StatusOr<Volume> made = decoded(order());
    EXPECT_FALSE(made.ok());
    return std::string(made.status().message());
  }
};

TEST_F(TriangleFileTest, BecomesTheSolidThatConversionMakes) {
  write(test::sphere_surface({3, 4, 5}, 2));
  std::filesystem::rename(path_, path_ + ".obj");
  const auto surface = read_surface(path_ + ".obj");
  ASSERT_TRUE(surface.ok()) << surface.status();
  const auto here = surface_to_volume(*surface, default_voxel(*surface));
  ASSERT_TRUE(here.ok()) << here.status();
  std::filesystem::rename(path_ + ".obj", path_);
  for (const std::string name : {"", "surface"}) {
    const auto there = decoded(order(DecodeTask::kVolume, name));
    ASSERT_TRUE(there.ok()) << there.status();
    EXPECT_EQ(there->name, "surface");
    EXPECT_EQ(there->bricks, here->volume.bricks);
    EXPECT_EQ(there->values, here->volume.values);
  }
  const auto other = decoded(order(DecodeTask::kVolume, "other"));
  EXPECT_TRUE(absl::IsNotFound(other.status())) << other.status();
}

TEST_F(TriangleFileTest, IsListedAsAGridWithWhatItWasMadeOf) {
  const auto sphere = test::sphere_surface({}, 1, 64);
  write(test::without(sphere, 900, 1));
  const FileRequest list = order(DecodeTask::kGridList);
  const auto grids = grid_list_of(decode_once(list, test::patient_settings(), nullptr), list);
  ASSERT_TRUE(grids.ok()) << grids.status();
  ASSERT_EQ(grids->size(), 1U);
  EXPECT_EQ(grids->front().name, "surface");
  EXPECT_EQ(grids->front().grid_class, "level set");
  EXPECT_NEAR(grids->front().voxel_size, 2.0 / 128, 1e-3);
  EXPECT_THAT(grids->front().made_of, HasSubstr(absl::StrCat(sphere.triangles.size() - 1)));
  EXPECT_EQ(grids->front().not_meshable, "");
}

TEST_F(TriangleFileTest, IsRefusedWhereItHasNoInside) {
  const auto sphere = test::sphere_surface({}, 1, 24);
  write(test::without(sphere, 0, 300));
  EXPECT_THAT(refusal(), HasSubstr("'grids/abc': the surface is not closed"));
  EXPECT_THAT(refusal(), HasSubstr("`tetstream convert`"));
  write("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 3 2 1\n");
  EXPECT_THAT(refusal(), HasSubstr("grids/abc"));
}

TEST_F(TriangleFileTest, IsRefusedWithItsLineWhereItIsBroken) {
  write("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  EXPECT_THAT(refusal(), HasSubstr("'grids/abc' makes no solid: line 4"));
  write("v 0 0 0\nv 1e999 0 0\n");
  EXPECT_THAT(refusal(), HasSubstr("line 2"));
  write("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0\n");
  EXPECT_THAT(refusal(), HasSubstr("line 4"));
  write("ply\nformat ascii 1.0\nelement vertex 99999999999999999999\n");
  EXPECT_THAT(refusal(), HasSubstr("makes no solid"));
}

TEST_F(TriangleFileTest, IsRefusedBeforeItIsReadWhereItsGridWouldNotFit) {
  write(test::sphere_surface({}, 1));
  FileRequest small = order();
  small.max_bytes = std::uint64_t{16} << 20;
  const absl::Status status = decoded(small).status();
  EXPECT_TRUE(absl::IsResourceExhausted(status)) << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr("'grids/abc'"));
}

TEST_F(TriangleFileTest, IsMadeOfManyThinWallsAndOfBarsThatCross) {
  TriangleSurface plates;
  for (int i = 0; i < 8; ++i) {
    const double at = 0.08 * i;
    plates = test::joined(plates, test::box_surface({0, 0, at}, {1, 1, at + 0.01}));
  }
  const TriangleSurface bars =
      test::joined(test::joined(test::box_surface({0, 0.4, 0.4}, {1, 0.5, 0.5}),
                                test::box_surface({0.4, 0, 0.4}, {0.5, 1, 0.5})),
                   test::box_surface({0.4, 0.4, 0}, {0.5, 0.5, 1}));
  for (const TriangleSurface& surface : {plates, bars}) {
    write(surface);
    const auto made = decoded(order());
    ASSERT_TRUE(made.ok()) << made.status();
    EXPECT_LE(made->transform.voxel_size, 1.0 / 128);
  }
}

}  // namespace
}  // namespace tet
