// Meshes with arrays come back as they were written, and files that lie are refused.
#include "core/files/read_vtu.h"

#include <fstream>
#include <limits>
#include <random>

#include <gmock/gmock.h>

#include "core/files/mesh_file.h"
#include "core/files/write_data_vtu.h"
#include "tests/core/mesh/small_meshes.h"
#include "tests/support/test_directory.h"

namespace tet {
namespace {

using ::testing::HasSubstr;

DataMesh two_tets() {
  DataMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1.0 / 3}};
  mesh.tets = {{0, 1, 2, 3}, {4, 3, 2, 1}};
  mesh.point_data = {
      {"heat <of> \"x\" & y", 1, NumberType::kFloat32, {1, 2, 3, 4, 5.5}},
      {"v", 3, NumberType::kFloat64, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 0.1}}};
  mesh.cell_data = {{"region", 1, NumberType::kUint8, {1, 2}},
                    {"big", 1, NumberType::kInt64, {-4e15, 4e15}}};
  return mesh;
}

class ReadVtu : public ::testing::Test {
 protected:
  std::string written() {
    const std::string path = folder_.file("mesh.vtu");
    EXPECT_TRUE(write_data_vtu(path, two_tets()).ok());
    return test::read_bytes(path);
  }
  absl::StatusOr<DataMesh> read(const std::string& bytes) {
    const std::string path = folder_.file("read.vtu");
    std::ofstream(path, std::ios::binary) << bytes;
    return read_vtu(path);
  }
  void expect_refused(const std::string& bytes, const char* why) {
    const auto mesh = read(bytes);
    EXPECT_EQ(mesh.status().code(), absl::StatusCode::kInvalidArgument) << why;
    EXPECT_THAT(std::string(mesh.status().message()), HasSubstr(why));
  }
  /// The file with one text in place of another.
  std::string with(const std::string& from, const std::string& to) {
    std::string bytes = written();
    const std::size_t at = bytes.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return at == std::string::npos ? bytes : bytes.replace(at, from.size(), to);
  }

  test::TestDirectory folder_;
};

TEST_F(ReadVtu, HasWhatWasWritten) {
  const auto mesh = read(written());
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  const DataMesh expected = two_tets();
  EXPECT_EQ(mesh->points, expected.points);
  EXPECT_EQ(mesh->tets, expected.tets);
  ASSERT_EQ(mesh->point_data.size(), 2U);
  ASSERT_EQ(mesh->cell_data.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(mesh->point_data[i].name, expected.point_data[i].name);
    EXPECT_EQ(mesh->point_data[i].components, expected.point_data[i].components);
    EXPECT_EQ(mesh->point_data[i].type, expected.point_data[i].type);
    EXPECT_EQ(mesh->point_data[i].values, expected.point_data[i].values);
    EXPECT_EQ(mesh->cell_data[i].type, expected.cell_data[i].type);
    EXPECT_EQ(mesh->cell_data[i].values, expected.cell_data[i].values);
  }
}

TEST_F(ReadVtu, ReadsMeshesAsTheMesherWritesThem) {
  const TetMesh mesh = with_regions(kuhn_mesh(2), [](std::uint64_t tet) { return tet < 5; });
  const std::string path = folder_.file("mesher.vtu");
  ASSERT_TRUE(write_mesh_file(path, mesh).ok());
  const auto read = read_vtu(path);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->points.size(), mesh.header.vertex_count);
  EXPECT_EQ(read->tets.size(), mesh.header.tet_count);
  EXPECT_EQ(read->tets[7][2], mesh.tet(7)[2]);
  ASSERT_EQ(read->cell_data.size(), 1U);
  EXPECT_EQ(read->cell_data[0].name, "region");
  EXPECT_EQ(read->cell_data[0].values[4], 1);
  EXPECT_EQ(read->cell_data[0].values[5], 2);
}

TEST_F(ReadVtu, KeepsArraysOfTheWholeMeshThatAreText) {
  const std::string femur =
      R"(<DataArray type="Int32" Name="femur" NumberOfTuples="1" format="ascii">1</DataArray>)";
  const std::string tibia =
      R"(<DataArray type="Int32" Name="tibia" NumberOfTuples="1" format="ascii">2</DataArray>)";
  const std::string time = R"(<DataArray type="Float64" Name="Time &amp; day" )"
                           R"(NumberOfTuples="1" format="appended" offset="0"/>)";
  const std::string grid = "  <UnstructuredGrid>\n";
  const auto mesh =
      read(with(grid, grid + "<FieldData>" + femur + time + tibia + "</FieldData>\n"));
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_EQ(mesh->of_whole.text, "      " + femur + "\n      " + tibia + "\n");
  EXPECT_THAT(mesh->of_whole.left_out, testing::ElementsAre("Time & day"));
  const std::string path = folder_.file("again.vtu");
  ASSERT_TRUE(write_data_vtu(path, *mesh).ok());
  const auto again = read_vtu(path);
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->of_whole.text, mesh->of_whole.text);
  EXPECT_THAT(again->of_whole.left_out, testing::IsEmpty());
  EXPECT_EQ(again->points, two_tets().points);
}

TEST_F(ReadVtu, RefusesAFileThatEndsTooSoonWhereverItEnds) {
  const std::string whole = written();
  const std::size_t needed = whole.rfind("\n  </AppendedData>");
  for (std::size_t size = 0; size < needed; size += size < 1700 ? 7 : 1) {
    const auto mesh = read(whole.substr(0, size));
    EXPECT_EQ(mesh.status().code(), absl::StatusCode::kInvalidArgument) << size << " bytes";
  }
}

TEST_F(ReadVtu, SurvivesAnyByteThatChanges) {
  const std::string whole = written();
  std::mt19937 random(11);
  for (int i = 0; i < 4000; ++i) {
    std::string bytes = whole;
    for (int change = 0; change <= i % 3; ++change) {
      bytes[random() % bytes.size()] = static_cast<char>(random());
    }
    const auto mesh = read(bytes);
    if (!mesh.ok()) continue;
    for (const auto& tet : mesh->tets) {
      for (const std::uint32_t point : tet) ASSERT_LT(point, mesh->points.size());
    }
    for (const DataArray& array : mesh->point_data) {
      ASSERT_EQ(array.rows(), mesh->points.size());
    }
  }
}

TEST_F(ReadVtu, SaysWhatIsWrong) {
  expect_refused("", "XML");
  expect_refused("solid ball", "XML");
  expect_refused("<html><body>", "VTKFile");
  expect_refused(with("type=\"UnstructuredGrid\"", "type=\"PolyData\""), "PolyData");
  expect_refused(with("LittleEndian", "BigEndian"), "byte order");
  expect_refused(with("encoding=\"raw\"", "encoding=\"base64\""), "Encode Appended Data off");
  expect_refused(with("header_type", "compressor=\"vtkZLibDataCompressor\" header_type"),
                 "compressed");
  expect_refused(with("format=\"appended\"", "format=\"ascii\""), "ascii");
  expect_refused(with("NumberOfPoints=\"5\"", "NumberOfPoints=\"4000000000\""), "rows");
  expect_refused(with("NumberOfPoints=\"5\"", "NumberOfPoints=\"-5\""), "no count");
  expect_refused(with("NumberOfCells=\"2\"", "NumberOfCells=\"3\""), "rows");
  expect_refused(with("NumberOfComponents=\"3\" format", "NumberOfComponents=\"4\" format"),
                 "components");
  expect_refused(with("Name=\"v\"", "Name=\"heat &lt;of&gt; &quot;x&quot; &amp; y\""),
                 "two arrays");
  expect_refused(with("Name=\"types\"", "Name=\"faces\""), "faces");
  const auto huge = read(with("NumberOfPoints=\"5\"", "NumberOfPoints=\"99999999999\""));
  EXPECT_EQ(huge.status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(read_vtu(folder_.file("none.vtu")).status().code(), absl::StatusCode::kNotFound);
}

TEST_F(ReadVtu, RefusesArraysThatLieUponEachOther) {
  const std::string bytes = written();
  const std::size_t name = bytes.find("Name=\"v\"");
  const std::size_t begin = bytes.rfind('<', name), end = bytes.find("/>", name) + 2;
  ASSERT_NE(end, std::string::npos + 2);
  std::string many;
  for (int i = 0; i < 100; ++i) {
    std::string one = bytes.substr(begin, end - begin);
    many += one.replace(one.find("\"v\""), 3, "\"v" + std::to_string(i) + "\"");
  }
  expect_refused(std::string(bytes).replace(begin, end - begin, many),
                 "they lie upon each other");
}

/// Writes a mesh that is wrong in itself.
TEST_F(ReadVtu, RefusesNumbersThatCannotBe) {
  const auto refuse = [&](const DataMesh& mesh, const char* why) {
    const std::string path = folder_.file("wrong.vtu");
    ASSERT_TRUE(write_data_vtu(path, mesh).ok());
    EXPECT_THAT(std::string(read_vtu(path).status().message()), HasSubstr(why));
  };
  DataMesh mesh = two_tets();
  mesh.tets[1][2] = 5;
  refuse(mesh, "connectivity");
  mesh = two_tets();
  mesh.points[3].y = std::numeric_limits<double>::quiet_NaN();
  refuse(mesh, "row 3");
  mesh = two_tets();
  mesh.points[3].y = 1e31;
  refuse(mesh, "1e+31");
  mesh = two_tets();
  mesh.point_data[1].values[4] = std::numeric_limits<double>::infinity();
  refuse(mesh, "inf in row 1");
  mesh = two_tets();
  mesh.cell_data[1].values[0] = 1e17;
  refuse(mesh, "\"big\"");
}

}  // namespace
}  // namespace tet
