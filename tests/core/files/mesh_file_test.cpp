#include "core/files/mesh_file.h"

#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sys/resource.h>
#include <unistd.h>
#include <vector>

#include <gmock/gmock.h>

#include "core/files/face_groups.h"
#include "core/files/file_names.h"
#include "core/files/mesh_columns.h"
#include "core/files/tet_neighbours.h"
#include "core/files/text_numbers.h"
#include "tests/core/mesh/small_meshes.h"

namespace tet {
namespace {

namespace fs = std::filesystem;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> endings() {
  std::vector<std::string> endings;
  for (const MeshFormatRow& row : mesh_formats()) endings.emplace_back(row.ending);
  return endings;
}

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
  EXPECT_EQ(choose_column_types(header, shape_of(header)).ids, IndexType::kUint32);
  ++header.tet_count;
  EXPECT_EQ(choose_column_types(header, shape_of(header)).ids, IndexType::kUint64);
  header.tet_count = 1;
  ++header.vertex_count;
  EXPECT_EQ(choose_column_types(header, shape_of(header)).ids, IndexType::kUint64);
}

TEST(MeshFormat, IsChosenByTheEndingInAnyCase) {
  EXPECT_EQ(*mesh_format_of("a.vtu"), MeshFormat::kVtu);
  EXPECT_EQ(*mesh_format_of("b.c/d.MSH"), MeshFormat::kMsh);
  EXPECT_EQ(*mesh_format_of("e.f.vtkhdf"), MeshFormat::kVtkHdf);
  EXPECT_EQ(*mesh_format_of("boundary.stl"), MeshFormat::kStl);
}

TEST(MeshFormat, HasANameAndEndingsOfItsOwn) {
  std::set<std::string_view> names, endings;
  for (const MeshFormatRow& row : mesh_formats()) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_TRUE(endings.insert(row.ending).second) << row.ending;
    EXPECT_EQ(*mesh_format_named(row.name), row.format);
    EXPECT_EQ(*mesh_format_of("a" + std::string(row.ending)), row.format);
    EXPECT_EQ(&row_of(row.format), &row);
  }
}

TEST(MeshFormat, ThatIsNamedIsTakenWhateverTheEnding) {
  EXPECT_EQ(mesh_output("deck.txt", "inp")->format, MeshFormat::kInp);
  EXPECT_EQ(mesh_output("deck.vtu", "inp")->format, MeshFormat::kInp);
  EXPECT_EQ(mesh_output("deck.vtu")->format, MeshFormat::kVtu);
  const absl::Status status = mesh_output("deck.inp", "med").status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(status.message()), HasSubstr("no mesh format med; there are vtu,"));
}

TEST(MeshFormat, OfAnotherEndingIsAnErrorThatListsThem) {
  for (const char* path : {"mesh.med", "mesh", "mesh.vtu/", "vtu"}) {
    const absl::Status status = mesh_format_of(path).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << path;
    EXPECT_THAT(std::string(status.message()), HasSubstr("it must end in .vtu, .vtkhdf, "));
  }
}

TEST_F(MeshFileTest, StopsWhenCancelledAndLeavesNothing) {
  Cancellation cancellation;
  const WriteControl control{.cancellation = &cancellation,
                             .progress = [&](double) { cancellation.cancel(); }};
  for (const std::string& ending : endings()) {
    const absl::Status status = write_mesh_file(path("out") + ending, kuhn_mesh(40), control);
    EXPECT_EQ(status.code(), absl::StatusCode::kCancelled) << ending;
    EXPECT_EQ(files(), 0U) << ending;
  }
}

TEST_F(MeshFileTest, StopsAtAnyLookAndLeavesNothing) {
  for (const std::string& ending : endings()) {
    absl::Status status = absl::CancelledError("");
    for (int stop_at = 1; !status.ok(); stop_at += 1 + stop_at / 4) {
      std::atomic<int> looks = 0;
      const Cancellation cancellation(Cancellation::Clock::time_point::max(),
                                      [&] { return ++looks == stop_at; });
      const WriteControl control{.cancellation = &cancellation, .progress = {}};
      status = write_mesh_file(path("out") + ending, kuhn_mesh(6), control);
      if (status.ok()) continue;
      EXPECT_EQ(status.code(), absl::StatusCode::kCancelled) << ending << ": " << status;
      EXPECT_EQ(files(), 0U) << ending;
    }
    fs::remove_all(directory_);
    fs::create_directories(directory_);
  }
}

TEST(TetNeighboursOfALargeMesh, AreNotLookedForOnceTheyAreCancelled) {
  int looks = 0;
  const Cancellation cancellation(Cancellation::Clock::time_point::max(),
                                  [&] { return ++looks == 2; });
  const TetNeighbours behind(kuhn_mesh(40), cancellation);
  EXPECT_EQ(looks, 2);
  EXPECT_EQ(behind.size(), 0U);
  EXPECT_EQ(behind.inner_faces(), 0U);
}

TEST(FacesOfAFile, AreNotLookedForOnceTheyAreCancelled) {
  Cancellation cancellation;
  cancellation.cancel();
  const TetMesh mesh = kuhn_mesh(4);
  EXPECT_EQ(FaceGroups(mesh).groups().size(), 1U);
  EXPECT_TRUE(FaceGroups(mesh, cancellation).groups().empty());
}

TEST_F(MeshFileTest, TellsItsProgressUpToOne) {
  for (const std::string& ending : endings()) {
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

/// An old mesh: "old" in the file, or in a file of the folder that a format is.
std::string write_old_mesh(const std::string& path, MeshFormat format) {
  if (format != MeshFormat::kPolyMesh) {
    EXPECT_TRUE(write_text_file(path, "old").ok());
    return path;
  }
  fs::create_directories(path);
  EXPECT_TRUE(write_text_file(path + "/points", "old").ok());
  return path + "/points";
}

TEST_F(MeshFileTest, OnAFullDiskLeavesTheOldFileAsItWas) {
  for (const MeshFormatRow& row : mesh_formats()) {
    const std::string out = path("out") + std::string(row.ending);
    const std::string old = write_old_mesh(out, row.format);
    for (const rlim_t bytes : {0U, 100U, 5'000U, 100'000U}) {
      const FileSizeLimit limit(bytes);
      const absl::Status status = write_mesh_file(out, kuhn_mesh(30));
      EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted) << out << " " << bytes;
    }
    EXPECT_EQ(fs::file_size(old), 3U);
    fs::remove_all(out);
    EXPECT_EQ(files(), 0U) << out;
  }
}

TEST_F(MeshFileTest, OfAFolderIsCalledLikeOneOfOpenFoams) {
  EXPECT_EQ(*mesh_format_of("case/constant/polyMesh"), MeshFormat::kPolyMesh);
  EXPECT_EQ(*mesh_format_of("bone.polymesh"), MeshFormat::kPolyMesh);
  EXPECT_FALSE(mesh_format_of("case/constant").ok());
}

TEST_F(MeshFileTest, OfAFolderReplacesAnotherOfItsKindAlone) {
  const MeshOutput output{path("case"), MeshFormat::kPolyMesh};
  ASSERT_TRUE(write_mesh_file(output, {kuhn_mesh(2)}).ok());
  ASSERT_TRUE(write_mesh_file(output, {kuhn_mesh(3)}).ok());
  EXPECT_EQ(files(), 1U);
  ASSERT_TRUE(write_text_file(path("case/thesis"), "words").ok());
  EXPECT_EQ(check_can_write(output).code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_FALSE(write_mesh_file(output, {kuhn_mesh(2)}).ok());
  EXPECT_TRUE(fs::exists(path("case/thesis")));
}

TEST(TetNeighbours, AreBehindEachFaceOfBoth) {
  const TetMesh mesh = kuhn_mesh(5);
  const TetNeighbours behind(mesh);
  std::uint64_t inner = 0;
  for (std::uint64_t face = 0; face < behind.size(); ++face) {
    if (behind[face] == TetNeighbours::kNone) continue;
    ++inner;
    const SortedFace seen = sort_face(face_of(mesh.tet(face / 4), face % 4));
    bool met = false;
    for (std::size_t k = 0; k < 4; ++k) {
      const SortedFace other = sort_face(face_of(mesh.tet(behind[face]), k));
      if (other.vertices != seen.vertices) continue;
      met = other.flipped != seen.flipped &&
            behind[4 * std::uint64_t{behind[face]} + k] == face / 4;
    }
    EXPECT_TRUE(met) << face;
  }
  EXPECT_EQ(inner, 2 * behind.inner_faces());
  EXPECT_EQ(behind.size() - inner, 6U * 2 * 5 * 5);
}

TEST_F(MeshFileTest, OfTwoFilesComesWithBothOrNone) {
  ASSERT_TRUE(write_mesh_file(path("m.xdmf"), kuhn_mesh(2)).ok());
  EXPECT_TRUE(fs::exists(path("m.h5")));
  EXPECT_EQ(files(), 2U);
  const auto size = fs::file_size(path("m.h5"));
  ASSERT_TRUE(write_mesh_file(path("m.xdmf"), kuhn_mesh(3)).ok());
  EXPECT_GT(fs::file_size(path("m.h5")), size);
  EXPECT_EQ(files(), 2U);
  fs::create_directories(path("n.h5"));
  EXPECT_EQ(check_can_write({path("n.xdmf"), MeshFormat::kXdmf}).code(),
            absl::StatusCode::kFailedPrecondition);
  EXPECT_FALSE(write_mesh_file(path("n.xdmf"), kuhn_mesh(2)).ok());
  EXPECT_FALSE(fs::exists(path("n.xdmf")));
}

TEST_F(MeshFileTest, OfTwoFilesIsNotCalledLikeItsSecond) {
  const MeshOutput output{path("m.h5"), MeshFormat::kXdmf};
  EXPECT_EQ(check_can_write(output).code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(write_mesh_file(output, {kuhn_mesh(2)}).code(), absl::StatusCode::kInvalidArgument);
  EXPECT_FALSE(check_can_write({path("m.hdf5"), MeshFormat::kXdmf}).ok());
  EXPECT_EQ(write_mesh_file(path("a:b.xdmf"), kuhn_mesh(2)).code(),
            absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(files(), 0U);
}

TEST_F(MeshFileTest, OfTwoFilesIsCalledLikeNoOtherMeshs) {
  std::size_t written = 0;
  for (const char* const name : {"m.0.04", "m.0.05", "m", "m.xdmf", "m.XDMF", "m.Xdmf"}) {
    ASSERT_TRUE(write_mesh_file({path(name), MeshFormat::kXdmf}, {kuhn_mesh(2)}).ok());
    EXPECT_EQ(files(), written += 2) << name;
  }
  EXPECT_TRUE(fs::exists(path("m.h5")));
  EXPECT_TRUE(fs::exists(path("m.0.04.hdf5")));
}

TEST_F(MeshFileTest, OfTwoFilesLiesWhereALinkLeads) {
  fs::create_directories(path("runs"));
  ASSERT_TRUE(write_mesh_file(path("runs/7.xdmf"), kuhn_mesh(2)).ok());
  const auto size = fs::file_size(path("runs/7.h5"));
  fs::create_symlink(path("runs/7.xdmf"), path("latest.xdmf"));
  ASSERT_TRUE(write_mesh_file(path("latest.xdmf"), kuhn_mesh(3)).ok());
  EXPECT_GT(fs::file_size(path("runs/7.h5")), size);
  EXPECT_EQ(files(), 2U);  // the link, and the folder
}

TEST(FileNames, AreCutBetweenCharacters) {
  const std::vector<std::string> names{"кость", "коса", "a\"b"};
  EXPECT_THAT(names_in_file(names, {.most_bytes = 7,
                                    .letter_first = false,
                                    .bad_characters = "\"",
                                    .in_their_place = '\''}),
              ElementsAre("кос", "ко_2", "a'b"));
}

TEST(FileNames, AreNotThoseOfTheFormat) {
  constexpr std::array<std::string_view, 2> kTaken{"eall", "nall"};
  const std::vector<std::string> names{"Nall", "EALL", "nall_2"};
  EXPECT_THAT(names_in_file(names, {.ignores_case = true, .taken = kTaken}),
              ElementsAre("Nall_2", "EALL_2", "nall_2_2"));
}

TEST(FileNames, OfArraysAreNotThoseOfOthersComponents) {
  constexpr std::array<std::string_view, 3> kAxes{"x", "y", "z"};
  const std::vector<std::string> names{"v", "v_x", "x", "v"};
  const std::vector<std::uint32_t> components{3, 1, 1, 3};
  EXPECT_THAT(array_names_in_file(names, components, {.taken = kAxes}),
              ElementsAre("v", "v_x_2", "x_2", "v_2"));
}

TEST(FileNames, AreShortPlainAndOfTheirOwn) {
  const std::vector<std::string> names{
      "femur \"left\"",      "femur (left)",       "Ünder", "2nd", "",
      std::string(100, 'a'), std::string(101, 'a')};
  EXPECT_THAT(names_in_file(names, {.most_bytes = 12}),
              ElementsAre("femur__left_", "femur__lef_2", "n_nder", "n2nd", "n", "aaaaaaaaaaaa",
                          "aaaaaaaaaa_2"));
}

TEST(FileNames, DifferByMoreThanCaseWhereAFormatReadsThemAsCapitals) {
  const std::vector<std::string> names{"Bone", "bone", "BONE_2"};
  EXPECT_THAT(names_in_file(names, {.ignores_case = true}),
              ElementsAre("Bone", "bone_2", "BONE_2_2"));
  EXPECT_THAT(names_in_file(names, {}), ElementsAre("Bone", "bone", "BONE_2"));
}

TEST(FileNames, ThatChangeAreTold) {
  MeshHeader header;
  header.parts = {{.name = "femur"}, {.name = "a/b"}};
  EXPECT_THAT(changed_names(MeshFormat::kInp, header),
              ElementsAre("the file calls the part \"a/b\" a_b",
                          "the file calls the faces \"a/b_surface\" a_b_surface"));
  EXPECT_THAT(changed_names(MeshFormat::kVtu, header), ElementsAre());
}

TEST(FileNames, ThatChangeAreToldOfPartsAloneWhereAFormatNamesNothingElse) {
  MeshHeader header;
  header.parts = {{.name = "femur"}, {.name = "a/b"}, {.name = "."}};
  EXPECT_THAT(
      changed_names(MeshFormat::kVtkHdf, header),
      ElementsAre("the file calls the part \"a/b\" a_b", "the file calls the part \".\" _"));
  MeshHeader labelled;
  labelled.labels = {{.name = "a/b"}};
  EXPECT_THAT(changed_names(MeshFormat::kVtkHdf, labelled), ElementsAre());
}

TEST_F(MeshFileTest, RefusesWhatAFormatCannotCount) {
  TetMesh mesh = kuhn_mesh(1);
  mesh.header.vertex_count = 1'000'000'000;
  const absl::Status status = write_mesh_file(path("m.inp"), mesh);
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(
      std::string(status.message()),
      HasSubstr("takes 999999999 vertices and the mesh has 1000000000: write a .vtkhdf"));
  EXPECT_EQ(files(), 0U);
}

TEST(ShortCoordinates, TakeTwentyCharactersAndKeepWhatTheyCan) {
  std::array<char, 64> text{};
  for (const double value : {-1.2345678901234567e-05, -0.012345678901234566, 1e300 / 3,
                             -1.2345678901234567e-300, 20000.400390625, -7.0, 0.0, 1.0 / 3}) {
    char* const end = put_short_coordinate(text.data(), value, CoordinateType::kFloat64);
    EXPECT_LE(end - text.data(), 20);
    *end = '\0';
    EXPECT_NEAR(std::strtod(text.data(), nullptr), value, std::abs(value) * 1e-12);
  }
}

}  // namespace
}  // namespace tet
