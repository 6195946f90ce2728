// VTK's XML unstructured grid (.vtu) with quadratic tets.
#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <string>
#include <utility>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_replace.h>

#include "core/files/mesh_columns.h"
#include "core/files/write_second_order.h"

namespace tet {
namespace {

constexpr std::uint8_t kVtkQuadraticTetra = 24;
constexpr std::uint64_t kNodesPerTet = 10;

/// Columns one behind the other, each with its size in front.
class SecondOrderColumns {
 public:
  std::string add(const std::string& attributes, std::uint64_t bytes) {
    const std::uint64_t offset = std::exchange(next_, next_ + sizeof(std::uint64_t) + bytes);
    return absl::StrCat("        <DataArray ", attributes, " format=\"appended\" offset=\"",
                        offset, "\"/>\n");
  }
  std::uint64_t total() const noexcept { return next_; }

 private:
  std::uint64_t next_ = 0;
};

std::string name_attribute(const std::string& name) {
  return absl::StrCat(
      "Name=\"",
      absl::StrReplaceAll(name,
                          {{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}, {"\"", "&quot;"}}),
      "\"");
}

/// How the columns are stored.
struct SecondOrderTypes {
  std::uint64_t coordinate = 4, id = 4;  ///< bytes

  explicit SecondOrderTypes(const SecondOrderMesh& all)
      : coordinate(size_of(file_coordinate_type(all.mesh.header))) {
    constexpr auto kLargest =
        static_cast<std::uint64_t>(std::numeric_limits<std::int32_t>::max());
    const bool fits =
        all.node_count() <= kLargest && all.mesh.header.tet_count <= kLargest / kNodesPerTet;
    id = fits ? 4 : 8;
  }
  std::string ids() const {
    return absl::StrCat("type=\"", id == 4 ? "Int32" : "Int64", "\" ");
  }
};

/// "region" or "part", or nothing.
std::string label_name(const MeshHeader& header) {
  if (header.has_regions) return "region";
  return header.parts.empty() ? "" : "part";
}

std::string xml_of(const SecondOrderMesh& all,
                   const SecondOrderTypes& types,
                   SecondOrderColumns& columns) {
  const MeshHeader& header = all.mesh.header;
  const std::uint64_t nodes = all.node_count(), tets = header.tet_count;
  std::string text = absl::StrCat(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n"
      "  <UnstructuredGrid>\n    <Piece NumberOfPoints=\"",
      nodes, "\" NumberOfCells=\"", tets, "\">\n      <Points>\n");
  text += columns.add(absl::StrCat("type=\"", types.coordinate == 8 ? "Float64" : "Float32",
                                   "\" Name=\"Points\" NumberOfComponents=\"3\""),
                      nodes * 3 * types.coordinate);
  text += "      </Points>\n      <Cells>\n";
  text +=
      columns.add(types.ids() + name_attribute("connectivity"), tets * kNodesPerTet * types.id);
  text += columns.add(types.ids() + name_attribute("offsets"), tets * types.id);
  text += columns.add("type=\"UInt8\" Name=\"types\"", tets);
  text += "      </Cells>\n";
  if (const std::string label = label_name(header); !label.empty()) {
    absl::StrAppend(&text, "      <CellData Scalars=\"", label, "\">\n",
                    columns.add("type=\"UInt8\" " + name_attribute(label), tets),
                    "      </CellData>\n");
  }
  if (!header.fields.empty()) text += "      <PointData>\n";
  for (const FieldArray& field : header.fields) {
    const char* const components = field.components == 3 ? " NumberOfComponents=\"3\"" : "";
    text +=
        columns.add(absl::StrCat("type=\"Float32\" ", name_attribute(field.name), components),
                    nodes * field.components * sizeof(float));
  }
  if (!header.fields.empty()) text += "      </PointData>\n";
  return absl::StrCat(text,
                      "    </Piece>\n  </UnstructuredGrid>\n"
                      "  <AppendedData encoding=\"raw\">\n_");
}

template <class Number>
void write_nodes_as(BlockWriter& writer, const SecondOrderMesh& all) {
  writer.number(all.node_count() * 3 * sizeof(Number));
  writer.rows(all.node_count(), [&](std::uint64_t i) {
    const auto [x, y, z] = all.node(i);
    return std::array{static_cast<Number>(x), static_cast<Number>(y), static_cast<Number>(z)};
  });
}

template <class Id>
void write_cells_as(BlockWriter& writer, const SecondOrderMesh& all) {
  const std::uint64_t tets = all.mesh.header.tet_count;
  writer.number(tets * kNodesPerTet * sizeof(Id));
  writer.rows(tets, [&](std::uint64_t tet) {
    std::array<Id, kNodesPerTet> ids;
    std::ranges::transform(all.nodes_of(tet), ids.begin(),
                           [](std::uint64_t id) { return static_cast<Id>(id); });
    return ids;
  });
  writer.number(tets * sizeof(Id));
  writer.rows(tets, [](std::uint64_t i) { return static_cast<Id>(kNodesPerTet * (i + 1)); });
}

template <std::size_t kComponents>
void write_field_rows(BlockWriter& writer, const SecondOrderMesh& all, std::size_t first) {
  const std::uint64_t vertices = all.mesh.header.vertex_count;
  const std::size_t row = all.mesh.header.field_values() * sizeof(float);
  writer.number(all.node_count() * kComponents * sizeof(float));
  writer.rows(all.node_count(), [&](std::uint64_t i) {
    const bool is_vertex = i < vertices;
    const std::byte* const rows =
        is_vertex ? all.mesh.fields.bytes().data() : all.middles.fields.bytes().data();
    std::array<float, kComponents> values;
    std::memcpy(values.data(), rows + (is_vertex ? i : i - vertices) * row + first,
                sizeof(values));
    return values;
  });
}

}  // namespace

absl::Status write_second_order_vtu(AtomicFile& file,
                                    const SecondOrderMesh& all,
                                    const WriteControl& control) {
  const MeshHeader& header = all.mesh.header;
  const SecondOrderTypes types(all);
  SecondOrderColumns columns;
  const std::string xml = xml_of(all, types, columns);
  BlockWriter writer(file, columns.total(), control);
  writer.text(xml);
  types.coordinate == 8 ? write_nodes_as<double>(writer, all)
                        : write_nodes_as<float>(writer, all);
  types.id == 8 ? write_cells_as<std::int64_t>(writer, all)
                : write_cells_as<std::int32_t>(writer, all);
  writer.number(header.tet_count);
  writer.rows(header.tet_count, [](std::uint64_t) { return kVtkQuadraticTetra; });
  if (!label_name(header).empty()) writer.number(header.tet_count);
  if (header.has_regions) {
    writer.bytes(all.mesh.regions.bytes());
  } else if (!header.parts.empty()) {
    write_part_numbers(writer, header);
  }
  std::size_t first = 0;
  for (const FieldArray& field : header.fields) {
    field.components == 3 ? write_field_rows<3>(writer, all, first)
                          : write_field_rows<1>(writer, all, first);
    first += field.components * sizeof(float);
  }
  writer.text("\n  </AppendedData>\n</VTKFile>\n");
  return writer.status();
}

}  // namespace tet
