#include "core/files/write_data_vtu.h"

#include <array>
#include <cstdint>
#include <utility>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_replace.h>

#include "core/files/vtu_header.h"

namespace tet {
namespace {

constexpr std::uint64_t kColumnSizeBytes = sizeof(std::uint64_t);

std::string attribute_text(const std::string& name) {
  return absl::StrReplaceAll(name,
                             {{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}});
}

/// Columns one behind the other, each with its size in front.
class ColumnPlaces {
 public:
  /// The tag of a column of so many bytes.
  std::string add(const std::string& attributes, std::uint64_t bytes) {
    const std::uint64_t offset = std::exchange(next_, next_ + kColumnSizeBytes + bytes);
    return absl::StrCat("        <DataArray ", attributes, " format=\"appended\" offset=\"",
                        offset, "\"/>\n");
  }
  std::uint64_t total() const noexcept { return next_; }

 private:
  std::uint64_t next_ = 0;
};

std::uint64_t bytes_of(const DataArray& array) {
  return array.values.size() * size_of(array.type);
}

std::string section(const char* name,
                    const std::vector<DataArray>& arrays,
                    ColumnPlaces& places) {
  if (arrays.empty()) return "";
  std::string text = absl::StrCat("      <", name, ">\n");
  for (const DataArray& array : arrays) {
    // Not of scalars: readers make a matrix of one column of those that say so.
    const std::string components =
        array.components == 1 ? ""
                              : absl::StrCat(" NumberOfComponents=\"", array.components, "\"");
    text += places.add(absl::StrCat("type=\"", vtu_name_of(array.type), "\" Name=\"",
                                    attribute_text(array.name), "\"", components),
                       bytes_of(array));
  }
  return absl::StrCat(text, "      </", name, ">\n");
}

template <class Number>
void write_values(BlockWriter& writer, const DataArray& array) {
  writer.rows(array.values.size(),
              [&](std::uint64_t i) { return static_cast<Number>(array.values[i]); });
}

void write_array(BlockWriter& writer, const DataArray& array) {
  writer.number(bytes_of(array));
  switch (array.type) {
    case NumberType::kInt8:
      return write_values<std::int8_t>(writer, array);
    case NumberType::kUint8:
      return write_values<std::uint8_t>(writer, array);
    case NumberType::kInt16:
      return write_values<std::int16_t>(writer, array);
    case NumberType::kUint16:
      return write_values<std::uint16_t>(writer, array);
    case NumberType::kInt32:
      return write_values<std::int32_t>(writer, array);
    case NumberType::kUint32:
      return write_values<std::uint32_t>(writer, array);
    case NumberType::kInt64:
      return write_values<std::int64_t>(writer, array);
    case NumberType::kUint64:
      return write_values<std::uint64_t>(writer, array);
    case NumberType::kFloat32:
      return write_values<float>(writer, array);
    case NumberType::kFloat64:
      return write_values<double>(writer, array);
  }
}

void write_columns(BlockWriter& writer, const DataMesh& mesh) {
  const std::uint64_t tets = mesh.tets.size();
  writer.number(mesh.points.size() * 3 * sizeof(double));
  writer.rows(mesh.points.size(), [&](std::uint64_t i) {
    const auto& [x, y, z] = mesh.points[i];
    return std::array{x, y, z};
  });
  writer.number(tets * 4 * sizeof(std::int64_t));
  writer.rows(tets, [&](std::uint64_t i) {
    const auto& [a, b, c, d] = mesh.tets[i];
    return std::array<std::int64_t, 4>{a, b, c, d};
  });
  writer.number(tets * sizeof(std::int64_t));
  writer.rows(tets, [](std::uint64_t i) { return static_cast<std::int64_t>(4 * (i + 1)); });
  writer.number(tets);
  writer.rows(tets, [](std::uint64_t) { return kVtuTetra; });
  for (const auto* arrays : {&mesh.point_data, &mesh.cell_data}) {
    for (const DataArray& array : *arrays) write_array(writer, array);
  }
}

/// The XML, and how many bytes follow it.
std::pair<std::string, std::uint64_t> header_of(const DataMesh& mesh) {
  ColumnPlaces places;
  const std::uint64_t tets = mesh.tets.size();
  const std::string points =
      places.add("type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"",
                 mesh.points.size() * 3 * sizeof(double));
  const std::string connectivity =
      places.add("type=\"Int64\" Name=\"connectivity\"", tets * 4 * sizeof(std::int64_t));
  const std::string offsets =
      places.add("type=\"Int64\" Name=\"offsets\"", tets * sizeof(std::int64_t));
  const std::string types = places.add("type=\"UInt8\" Name=\"types\"", tets);
  const std::string point_data = section("PointData", mesh.point_data, places);
  const std::string cell_data = section("CellData", mesh.cell_data, places);
  const std::string& text = mesh.of_whole.text;
  const std::string whole =
      text.empty() ? "" : absl::StrCat("    <FieldData>\n", text, "    </FieldData>\n");
  return {absl::StrCat(
              "<?xml version=\"1.0\"?>\n"
              "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
              "header_type=\"UInt64\">\n"
              "  <UnstructuredGrid>\n",
              whole, "    <Piece NumberOfPoints=\"", mesh.points.size(), "\" NumberOfCells=\"",
              tets, "\">\n      <Points>\n", points, "      </Points>\n      <Cells>\n",
              connectivity, offsets, types, "      </Cells>\n", point_data, cell_data,
              "    </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"raw\">\n_"),
          places.total()};
}

}  // namespace

absl::Status write_data_vtu(const std::string& path,
                            const DataMesh& mesh,
                            const WriteControl& control) {
  absl::StatusOr<AtomicFile> file = AtomicFile::create(path);
  if (!file.ok()) return file.status();
  const auto [header, bytes] = header_of(mesh);
  BlockWriter writer(*file, bytes, control);
  writer.text(header);
  write_columns(writer, mesh);
  writer.text("\n  </AppendedData>\n</VTKFile>\n");
  if (!writer.status().ok()) return writer.status();
  return file->commit();
}

}  // namespace tet
