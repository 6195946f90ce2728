#include "core/files/mesh_file.h"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <sys/resource.h>
#include <unistd.h>
#include <vector>

#include <gmock/gmock.h>

#include "core/files/mesh_columns.h"
#include "tests/core/mesh/small_meshes.h"

namespace tet {
namespace {

namespace fs = std::filesystem;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kEndings[] = {".vtu", ".msh", ".vtkhdf"};

class MeshFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "mesh_file_XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    directory_ = pattern;
  }
  void TearDown() override { fs::remove_all(directory_); }

  std::string path(const std::string& name) const { return directory_ / name; }
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(fs::directory_iterator(directory_), fs::directory_iterator()));
  }

  fs::path directory_;
};

MeshHeader header_at(double coordinate, double spacing) {
  MeshHeader header;
  header.spacing = spacing;
  header.bounds = {{0, 0, -coordinate}, {1, 1, 1}};
  return header;
}

TEST(FileCoordinateType, IsFloat32NearTheOrigin) {
  EXPECT_EQ(file_coordinate_type(header_at(100, 0.1)), CoordinateType::kFloat32);
}

TEST(FileCoordinateType, IsFloat64WhereFloat32WouldBendAngles) {
  EXPECT_EQ(file_coordinate_type(header_at(20000, 0.04)), CoordinateType::kFloat64);
}

TEST(FileCoordinateType, IsFloat64WhenTheMeshIsStoredSo) {
  MeshHeader header = header_at(1, 1);
  header.coordinate_type = CoordinateType::kFloat64;
  EXPECT_EQ(file_coordinate_type(header), CoordinateType::kFloat64);
}

TEST(ColumnTypes, HaveLongIdsOnlyWhereAnIdOrAnOffsetNeedsThem) {
  MeshHeader header = header_at(1, 1);
  header.vertex_count = 2'147'483'647;
  header.tet_count = 536'870'911;
  EXPECT_EQ(choose_column_types(header).ids, IndexType::kUint32);
  ++header.tet_count;
  EXPECT_EQ(choose_column_types(header).ids, IndexType::kUint64);
  header.tet_count = 1;
  ++header.vertex_count;
  EXPECT_EQ(choose_column_types(header).ids, IndexType::kUint64);
}

TEST(MeshFormat, IsChosenByTheEndingInAnyCase) {
  EXPECT_EQ(*mesh_format_of("a.vtu"), MeshFormat::kVtu);
  EXPECT_EQ(*mesh_format_of("b.c/d.MSH"), MeshFormat::kMsh);
  EXPECT_EQ(*mesh_format_of("e.f.vtkhdf"), MeshFormat::kVtkHdf);
}

TEST(MeshFormat, OfAnotherEndingIsAnErrorThatListsTheThree) {
  for (const char* path : {"mesh.stl", "mesh", "mesh.vtu/", "vtu"}) {
    const absl::Status status = mesh_format_of(path).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << path;
    EXPECT_THAT(std::string(status.message()), HasSubstr(".vtu, .msh or .vtkhdf"));
  }
}

TEST_F(MeshFileTest, StopsWhenCancelledAndLeavesNothing) {
  Cancellation cancellation;
  const WriteControl control{.cancellation = &cancellation,
                             .progress = [&](double) { cancellation.cancel(); }};
  for (const char* ending : kEndings) {
    const absl::Status status = write_mesh_file(path("out") + ending, kuhn_mesh(40), control);
    EXPECT_EQ(status.code(), absl::StatusCode::kCancelled) << ending;
    EXPECT_EQ(files(), 0U) << ending;
  }
}

TEST_F(MeshFileTest, TellsItsProgressUpToOne) {
  for (const char* ending : kEndings) {
    std::vector<double> told;
    const WriteControl control{.progress = [&](double fraction) { told.push_back(fraction); }};
    ASSERT_TRUE(write_mesh_file(path("out") + ending, kuhn_mesh(30), control).ok());
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
    EXPECT_NEAR(told.back(), 1, 0.01) << ending;
  }
}

/// Files may not grow beyond a size, as on a full disk; until the end of the scope.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : old_handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &old_limit_);
    const rlimit limit{bytes, old_limit_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &old_limit_);
    std::signal(SIGXFSZ, old_handler_);
  }

 private:
  void (*old_handler_)(int);
  rlimit old_limit_{};
};

TEST_F(MeshFileTest, OnAFullDiskLeavesTheOldFileAsItWas) {
  for (const char* ending : kEndings) {
    const std::string out = path("out") + ending;
    ASSERT_TRUE(write_text_file(out, "old").ok());
    for (const rlim_t bytes : {0U, 100U, 5'000U, 1'000'000U}) {
      const FileSizeLimit limit(bytes);
      const absl::Status status = write_mesh_file(out, kuhn_mesh(30));
      EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted) << ending << " " << bytes;
    }
    EXPECT_EQ(fs::file_size(out), 3U);
    fs::remove(out);
    EXPECT_EQ(files(), 0U) << ending;
  }
}

}  // namespace
}  // namespace tet
