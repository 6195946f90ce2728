// Arrays from file to file by the public library.
#include <gtest/gtest.h>

#include "core/files/read_vtu.h"
#include "core/files/write_data_vtu.h"
#include "tests/core/remap/boxes_of_tets.h"
#include "tests/support/test_directory.h"
#include "tetstream/transfer.h"

namespace tetstream {
namespace {

using tet::test::box_of_tets;

double linear(const tet::WorldPoint& p) { return 1 + p.x - 2 * p.y + 3 * p.z; }

class LibraryTransfer : public ::testing::Test {
 protected:
  void SetUp() override {
    tet::DataMesh from = box_of_tets(5, 1, 0.2), to = box_of_tets(7, 1, 0.22);
    from.point_data = {tet::test::at_points(from, "heat", linear)};
    from.cell_data = {tet::test::at_cells(from, "load", linear)};
    ASSERT_TRUE(tet::write_data_vtu(old_, from).ok());
    ASSERT_TRUE(tet::write_data_vtu(new_, to).ok());
  }

  tet::test::TestDirectory folder_;
  const std::string old_ = folder_.file("old.vtu"), new_ = folder_.file("new.vtu"),
                    out_ = folder_.file("out.vtu");
};

TEST_F(LibraryTransfer, WritesTheNewMeshWithTheOldArrays) {
  const auto arrays = transfer_arrays(old_, new_, out_);
  ASSERT_TRUE(arrays.ok()) << arrays.status().to_string();
  ASSERT_EQ(arrays->size(), 2U);
  EXPECT_EQ(arrays->front().name, "heat");
  EXPECT_TRUE(arrays->front().at_points);
  const auto mesh = tet::read_vtu(out_);
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  for (std::size_t i = 0; i < mesh->points.size(); ++i) {
    EXPECT_NEAR(mesh->point_data[0].values[i], linear(mesh->points[i]), 1e-12);
  }
}

TEST_F(LibraryTransfer, ConservesIntegrals) {
  const auto arrays = transfer_arrays(old_, new_, out_, {.mode = TransferMode::kConservative});
  ASSERT_TRUE(arrays.ok()) << arrays.status().to_string();
  for (const TransferredArray& array : *arrays) {
    EXPECT_NEAR(array.new_integral, array.old_integral, 1e-10) << array.name;
  }
}

TEST_F(LibraryTransfer, TellsWhatIsWrong) {
  EXPECT_EQ(transfer_arrays(old_, new_, folder_.file("out.msh")).status().code(),
            StatusCode::kInvalidArgument);
  EXPECT_EQ(transfer_arrays(folder_.file("none.vtu"), new_, out_).status().code(),
            StatusCode::kNotFound);
  EXPECT_EQ(transfer_arrays(old_, new_, out_, {.arrays = {"cold"}}).status().code(),
            StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace tetstream
