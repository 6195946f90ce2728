#include "core/files/write_vtu.h"

#include <string>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_replace.h>

#include "core/files/mesh_columns.h"
#include "core/mesh/label_faces.h"

namespace tet {
namespace {

/// Every appended column starts with its size in bytes.
constexpr std::uint64_t kSizeBytes = sizeof(std::uint64_t);

std::string data_array(const std::string& attributes, std::uint64_t offset) {
  return absl::StrCat("        <DataArray ", attributes, " format=\"appended\" offset=\"",
                      offset, "\"/>\n");
}

std::uint64_t field_bytes(const FileShape& shape, const FieldArray& field) {
  return shape.nodes * field.components * sizeof(float);
}

/// Meshes of one side of one grid have no data of cells, and no mesh has labels of both kinds.
std::string cell_data(const MeshHeader& mesh, std::uint64_t offset) {
  if (!mesh.has_regions && mesh.parts.empty() && mesh.labels.empty()) return "";
  const char* const label = !mesh.labels.empty() ? "label"
                            : mesh.has_regions   ? "region"
                                                 : "part";
  const char* const type = mesh.labels.empty()                               ? "UInt8"
                           : label_value_bytes(mesh) == sizeof(std::int32_t) ? "Int32"
                                                                             : "Int64";
  return absl::StrCat(
      "      <CellData Scalars=\"", label, "\">\n",
      data_array(absl::StrCat("type=\"", type, "\" Name=\"", label, "\""), offset),
      "      </CellData>\n");
}

std::string xml_text(const std::string& name) {
  return absl::StrReplaceAll(name, {{"&", "&amp;"}, {"<", "&lt;"}, {">", "&gt;"}});
}

std::string named_number(const char* type, const std::string& name, std::int64_t number) {
  return absl::StrCat("      <DataArray type=\"", type, "\" Name=\"",
                      absl::StrReplaceAll(xml_text(name), {{"\"", "&quot;"}}),
                      "\" NumberOfTuples=\"1\" format=\"ascii\">", number, "</DataArray>\n");
}

/// Which number the part of each grid has, or each label that has a name, as arrays called
/// like the grids and labels.
std::string field_data(const MeshHeader& mesh) {
  std::string text;
  for (std::size_t i = 0; i < mesh.parts.size(); ++i) {
    text += named_number("Int32", mesh.parts[i].name, static_cast<std::int64_t>(i) + 1);
  }
  const std::vector<std::string> names = distinct_names(mesh.labels);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const MeshLabel& label = mesh.labels[i];
    if (!label.name.empty()) text += named_number("Int64", names[i], label.value);
  }
  if (text.empty()) return "";
  return absl::StrCat("    <FieldData>\n", text, "    </FieldData>\n");
}

/// What a viewer shows before it is told what to: the first field of so many components.
std::string shown_first(const MeshHeader& mesh,
                        const char* attribute,
                        std::uint32_t components) {
  for (const FieldArray& field : mesh.fields) {
    if (field.components != components) continue;
    return absl::StrCat(" ", attribute, "=\"", xml_text(field.name), "\"");
  }
  return "";
}

std::string point_data(const MeshHeader& mesh, const FileShape& shape, std::uint64_t offset) {
  if (mesh.fields.empty()) return "";
  std::string text = absl::StrCat("      <PointData", shown_first(mesh, "Scalars", 1),
                                  shown_first(mesh, "Vectors", 3), ">\n");
  for (const FieldArray& field : mesh.fields) {
    // Not of scalars: readers make a matrix of one column of those that say so.
    const char* const components = field.components == 3 ? " NumberOfComponents=\"3\"" : "";
    const std::string attributes =
        absl::StrCat("type=\"Float32\" Name=\"", xml_text(field.name), "\"", components);
    absl::StrAppend(&text, data_array(attributes, offset));
    offset += kSizeBytes + field_bytes(shape, field);
  }
  return absl::StrCat(text, "      </PointData>\n");
}

std::string header_text(const MeshHeader& mesh,
                        const FileShape& shape,
                        const ColumnTypes& types,
                        const ColumnSizes& sizes) {
  const bool wide = types.coordinates == CoordinateType::kFloat64;
  const std::string ids = types.ids == IndexType::kUint64 ? "Int64" : "Int32";
  const std::uint64_t connectivity = kSizeBytes + sizes.points;
  const std::uint64_t offsets = connectivity + kSizeBytes + sizes.connectivity;
  const std::uint64_t cell_types = offsets + kSizeBytes + sizes.offsets;
  const std::uint64_t labels = cell_types + kSizeBytes + sizes.types;
  const std::uint64_t label_bytes = sizes.regions + sizes.parts;
  const std::uint64_t fields = label_bytes > 0 ? labels + kSizeBytes + label_bytes : labels;
  return absl::StrCat(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n"
      "  <UnstructuredGrid>\n",
      field_data(mesh), "    <Piece NumberOfPoints=\"", shape.nodes, "\" NumberOfCells=\"",
      mesh.tet_count,
      "\">\n"
      "      <Points>\n",
      data_array(absl::StrCat("type=\"", wide ? "Float64" : "Float32",
                              "\" Name=\"Points\" NumberOfComponents=\"3\""),
                 0),
      "      </Points>\n"
      "      <Cells>\n",
      data_array(absl::StrCat("type=\"", ids, "\" Name=\"connectivity\""), connectivity),
      data_array(absl::StrCat("type=\"", ids, "\" Name=\"offsets\""), offsets),
      data_array("type=\"UInt8\" Name=\"types\"", cell_types), "      </Cells>\n",
      point_data(mesh, shape, fields), cell_data(mesh, labels),
      "    </Piece>\n"
      "  </UnstructuredGrid>\n"
      "  <AppendedData encoding=\"raw\">\n_");
}

}  // namespace

FileColumns begin_vtu(BlockWriter& writer, const MeshHeader& mesh, const FileShape& shape) {
  const ColumnTypes types = choose_column_types(mesh, shape);
  const ColumnSizes sizes = column_sizes(mesh, shape, types, mesh.tet_count);
  const std::string text = header_text(mesh, shape, types, sizes);
  writer.text(text);
  std::uint64_t end = text.size();
  // Begins a column behind the one before.
  const auto column = [&](std::uint64_t bytes) {
    writer.move_to(end);
    writer.number(bytes);
    end += kSizeBytes + bytes;
    return end - bytes;
  };
  FileColumns columns{.shape = shape, .types = types, .starts = {}};
  ColumnStarts& starts = columns.starts;
  starts.points = column(sizes.points);
  starts.connectivity = column(sizes.connectivity);
  column(sizes.offsets);
  write_offsets(writer, shape.nodes_per_tet, 1, mesh.tet_count, types.ids);  // each tet's end
  column(sizes.types);
  write_types(writer, shape.nodes_per_tet, mesh.tet_count);
  if (mesh.has_regions) {
    starts.regions = column(sizes.regions);
  } else if (!mesh.labels.empty()) {
    starts.labels = column(sizes.regions);
  } else if (sizes.parts > 0) {
    column(sizes.parts);
    write_part_numbers(writer, mesh);
  }
  for (const FieldArray& field : mesh.fields) {
    starts.fields.emplace_back(column(field_bytes(shape, field)));
  }
  writer.move_to(end);
  writer.text("\n  </AppendedData>\n</VTKFile>\n");
  return columns;
}

absl::Status write_vtu(AtomicFile& file, const FileMesh& mesh, const WriteControl& control) {
  const MeshHeader& header = mesh.mesh.header;
  const FileShape shape = mesh.shape();
  const ColumnTypes types = choose_column_types(header, shape);
  BlockWriter writer(file, column_sizes(header, shape, types, header.tet_count).total(),
                     control);
  const FileColumns columns = begin_vtu(writer, header, shape);
  write_columns(writer, columns, mesh, whole_of(header));
  return writer.status();
}

}  // namespace tet
