#include "core/files/parts_file.h"

#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <sys/resource.h>
#include <vector>

#include <gtest/gtest.h>

#include "core/plan/make/fill_mesh.h"
#include "core/plan/make/mesher.h"
#include "core/plan/make/plan_mesh.h"
#include "core/plan/mesh_workspace.h"
#include "tests/support/sanitized.h"
#include "tests/support/solids.h"
#include "tests/support/volume_fixtures.h"

namespace tet::parts_file_test {
namespace {

namespace fs = std::filesystem;

const Cancellation kNever;
constexpr std::array kEndings{".vtu", ".vtkhdf"};

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Every way in which meshes have their columns, with two sizes of coordinates.
std::vector<MeshRequest> kinds_of_meshes() {
  MeshRequest uniform, wide, improved, both, cut;
  uniform.levels = 0;
  wide.coordinates = CoordinateType::kFloat64;
  improved.improve = true;
  both.preset = Preset::kBothSides;
  both.box = {{-40, -40, -40}, {40, 40, 40}};
  cut.box = {{-40, -40, -40}, {40, 40, 2}};
  return {{}, uniform, wide, improved, both, cut};
}

Shape solid() {
  static const auto made = std::make_shared<const Volume>(test::ball(24));
  return made;
}

std::shared_ptr<const MeshPlan> plan(const MeshRequest& request) {
  auto made = plan_mesh({.shape = solid(), .request = request});
  EXPECT_TRUE(made.ok()) << made.status();
  return made.ok() ? *std::move(made) : nullptr;
}

class PartsFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "parts_file_XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    directory_ = pattern;
  }
  void TearDown() override { fs::remove_all(directory_); }

  std::string path(const std::string& name) const { return directory_ / name; }
  auto files() const {
    return std::distance(fs::directory_iterator(directory_), fs::directory_iterator());
  }

  /// Writes the mesh while it is made, and calls `after` behind each part.
  template <class After>
  absl::Status write(const std::string& out,
                     const MeshPlan& plan,
                     const Cancellation& cancellation,
                     const After& after) {
    auto file = PartsFile::create(*mesh_output(out), plan.header(), cancellation);
    if (!file.ok()) return file.status();
    TaskPool pool(2);
    absl::StatusOr<QualityStats> quality = absl::UnknownError("not started");
    pool.run([&] {
      quality = fill_parts(plan, cancellation, nullptr,
                           [&](const TetMesh& part, const ChunkExtent& place) {
                             const absl::Status status = file->put(part, place);
                             after();
                             return status;
                           });
    });
    return quality.ok() ? file->commit() : quality.status();
  }

  fs::path directory_;
};

TEST_F(PartsFileTest, HasTheBytesOfOneOfTheWholeMesh) {
  for (const MeshRequest& request : test::few_of(kinds_of_meshes(), 3)) {
    const auto planned = plan(request);
    ASSERT_NE(planned, nullptr);
    const auto whole = fill_mesh(*planned, {}, nullptr);
    ASSERT_TRUE(whole.ok());
    for (const std::string ending : kEndings) {
      ASSERT_TRUE(write_mesh_file(path("whole" + ending), whole->mesh).ok());
      ASSERT_TRUE(write(path("parts" + ending), *planned, {}, [] {}).ok());
      EXPECT_TRUE(bytes_of(path("whole" + ending)) == bytes_of(path("parts" + ending)));
    }
  }
}

/// Values that a vertex can have: a scalar and a vector.
std::vector<VertexField> fields() {
  const auto component = [](VolumeKind kind, float slope) {
    Volume made = test::dense_volume({{-30, -30, -30}, {30, 30, 30}}, 0, [&](VoxelCoord v) {
      return slope * static_cast<float>(v.x + v.y);
    });
    made.kind = kind;
    return std::make_shared<const Volume>(std::move(made));
  };
  const auto of_vector = [&](float slope) {
    return component(VolumeKind::kVectorField, slope);
  };
  return {{"heat", "", "", {component(VolumeKind::kField, 2)}},
          {"flow", "", "", {of_vector(1), of_vector(-1), of_vector(0.5)}}};
}

// The file of a mesh whose faces come with its parts is the one of a mesh that has none, where
// they are found in all of its tets.
TEST_F(PartsFileTest, CountsTheFacesOfAnMshFileThatComeWithTheParts) {
  MeshRequest uniform, wide, with_fields;
  uniform.levels = 0;
  wide.coordinates = CoordinateType::kFloat64;
  with_fields.fields = fields();
  for (const MeshRequest& request : {MeshRequest{}, uniform, wide, with_fields}) {
    const auto without = plan(request);
    MeshRequest asked = request;
    asked.faces = true;
    const auto planned = plan(asked);
    ASSERT_TRUE(without != nullptr && planned != nullptr);
    EXPECT_FALSE(PartsFile::takes(MeshFormat::kMsh, without->header()));
    ASSERT_TRUE(PartsFile::takes(MeshFormat::kMsh, planned->header()));
    ASSERT_GT(planned->header().face_count, 0U);
    const auto whole = fill_mesh(*without, {}, nullptr);
    ASSERT_TRUE(whole.ok());
    ASSERT_TRUE(write_mesh_file(path("whole.msh"), whole->mesh).ok());
    ASSERT_TRUE(write(path("parts.msh"), *planned, {}, [] {}).ok());
    EXPECT_TRUE(bytes_of(path("whole.msh")) == bytes_of(path("parts.msh")));
  }
}

TEST_F(PartsFileTest, TakesNoMshFileWhoseElementsAreOfSeveralNames) {
  MeshRequest both, cut;
  both.preset = Preset::kBothSides;
  both.box = {{-40, -40, -40}, {40, 40, 40}};
  cut.box = {{-40, -40, -40}, {40, 40, 2}};
  for (MeshRequest request : {both, cut}) {
    request.faces = true;
    const auto planned = plan(request);
    ASSERT_NE(planned, nullptr);
    EXPECT_FALSE(PartsFile::takes(MeshFormat::kMsh, planned->header()));
  }
}

TEST_F(PartsFileTest, DoesNotDependOnTheOrderOfParts) {
  const auto planned = plan({});
  const auto whole = fill_mesh(*planned, {}, nullptr);
  ASSERT_TRUE(whole.ok());
  ASSERT_GT(planned->header().chunk_count, 1U);
  for (const std::string ending : kEndings) {
    ASSERT_TRUE(write_mesh_file(path("whole" + ending), whole->mesh).ok());
    auto file =
        PartsFile::create(*mesh_output(path("parts" + ending)), planned->header(), kNever);
    ASSERT_TRUE(file.ok()) << file.status();
    for (std::uint64_t i = planned->header().chunk_count; i-- > 0;) {
      const ChunkExtent place = planned->chunk(i);
      TetMesh part(header_of_chunk(planned->header(), place));
      MeshWorkspace workspace;
      planned->fill_chunk(i, workspace, part.columns());
      ASSERT_TRUE(file->put(part, place).ok());
    }
    ASSERT_TRUE(file->commit().ok());
    EXPECT_TRUE(bytes_of(path("whole" + ending)) == bytes_of(path("parts" + ending)));
  }
}

TEST_F(PartsFileTest, LeavesNothingWhenCancelledInTheMiddle) {
  const auto planned = plan({});
  for (const std::string ending : kEndings) {
    Cancellation cancellation;
    const absl::Status status =
        write(path("out" + ending), *planned, cancellation, [&] { cancellation.cancel(); });
    EXPECT_EQ(status.code(), absl::StatusCode::kCancelled);
    EXPECT_EQ(files(), 0);
  }
}

TEST_F(PartsFileTest, LeavesTheOldFileOnAFullDisk) {
  const auto planned = plan({});
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit old_limit{};
  getrlimit(RLIMIT_FSIZE, &old_limit);
  for (const std::string ending : kEndings) {
    ASSERT_TRUE(write_text_file(path("out" + ending), "old").ok());
    for (const rlim_t bytes : {100U, 100'000U, 1'000'000U}) {
      const rlimit limit{bytes, old_limit.rlim_max};
      setrlimit(RLIMIT_FSIZE, &limit);
      const absl::Status status = write(path("out" + ending), *planned, {}, [] {});
      setrlimit(RLIMIT_FSIZE, &old_limit);
      EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted) << status;
    }
    EXPECT_EQ(bytes_of(path("out" + ending)), "old");
    fs::remove(path("out" + ending));
    EXPECT_EQ(files(), 0);
  }
  std::signal(SIGXFSZ, old_handler);
}

TEST_F(PartsFileTest, LeavesNothingUnlessItIsCommitted) {
  const auto planned = plan({});
  for (const std::string ending : kEndings) {
    {
      const auto file =
          PartsFile::create(*mesh_output(path("out" + ending)), planned->header(), kNever);
    }
    EXPECT_EQ(files(), 0);
  }
}

TEST(FillParts, MakesTheQualityOfTheWholeMeshAndEndsWithTheErrorOfWhoTakesIt) {
  for (const MeshRequest& request : kinds_of_meshes()) {
    const auto planned = plan(request);
    const auto whole = fill_mesh(*planned, {}, nullptr);
    const auto parts = fill_parts(*planned, {}, nullptr,
                                  [](auto&&...) -> absl::Status { return absl::OkStatus(); });
    ASSERT_TRUE(whole.ok() && parts.ok());
    EXPECT_EQ(parts->volume, whole->quality.volume);
    EXPECT_EQ(parts->min_dihedral_deg, whole->quality.min_dihedral_deg);
    EXPECT_EQ(parts->histogram, whole->quality.histogram);
    const auto failed = fill_parts(*planned, {}, nullptr, [](auto&&...) -> absl::Status {
      return absl::DataLossError("lost");
    });
    EXPECT_EQ(failed.status(), absl::DataLossError("lost"));
  }
}

}  // namespace
}  // namespace tet::parts_file_test
