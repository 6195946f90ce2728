#include "core/files/write_vtkhdf.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <absl/strings/str_cat.h>

#include "core/files/file_names.h"
#include "core/files/hdf5_outline.h"
#include "core/files/mesh_columns.h"

namespace tet {
namespace {

constexpr NameRule kPartNames{.most_bytes = 4096, .letter_first = false, .bad_characters = "/"};

using Column = Hdf5Outline::Column;
constexpr Column kNoColumn = Hdf5Outline::kNoColumn;

struct Layout {
  Column points = kNoColumn, connectivity = kNoColumn, offsets = kNoColumn;
  Column types = kNoColumn, regions = kNoColumn, parts = kNoColumn;
  Column labels = kNoColumn;
  std::vector<Column> fields = {};
};

/// Which number the part of each grid has, as arrays called like the grids.
void add_part_names(Hdf5Outline& outline, const MeshHeader& mesh) {
  outline.group("FieldData");
  const std::vector<std::string> names = part_names_in_vtkhdf(mesh);
  for (std::size_t i = 0; i < names.size(); ++i) {
    outline.number(absl::StrCat("FieldData/", names[i]), i + 1);
  }
}

Layout lay_out(Hdf5Outline& outline,
               const MeshHeader& mesh,
               const FileShape& shape,
               const ColumnTypes& types) {
  const Hdf5Type real =
      types.coordinates == CoordinateType::kFloat64 ? Hdf5Type::kFloat64 : Hdf5Type::kFloat32;
  const Hdf5Type id = types.ids == IndexType::kUint64 ? Hdf5Type::kInt64 : Hdf5Type::kInt32;
  outline.attribute("Version", std::array<std::int64_t, 2>{1, 0});
  outline.attribute("Type", "UnstructuredGrid");  // of fixed length, as VTK 9.1 wants it
  outline.number("NumberOfPoints", shape.nodes);
  outline.number("NumberOfCells", mesh.tet_count);
  outline.number("NumberOfConnectivityIds", shape.nodes_per_tet * mesh.tet_count);
  Layout layout{.points = outline.column("Points", real, {shape.nodes, 3}),
                .connectivity =
                    outline.column("Connectivity", id, {shape.nodes_per_tet * mesh.tet_count}),
                .offsets = outline.column("Offsets", id, {mesh.tet_count + 1}),
                .types = outline.column("Types", Hdf5Type::kUint8, {mesh.tet_count})};
  if (mesh.has_regions) {
    outline.group("CellData");
    layout.regions = outline.column("CellData/region", Hdf5Type::kUint8, {mesh.tet_count});
  }
  if (!mesh.labels.empty()) {
    outline.group("CellData");
    const bool narrow = label_value_bytes(mesh) == sizeof(std::int32_t);
    layout.labels = outline.column(
        "CellData/label", narrow ? Hdf5Type::kInt32 : Hdf5Type::kInt64, {mesh.tet_count});
  }
  if (!mesh.parts.empty()) {
    outline.group("CellData");
    layout.parts = outline.column("CellData/part", Hdf5Type::kUint8, {mesh.tet_count});
    add_part_names(outline, mesh);
  }
  if (!mesh.fields.empty()) outline.group("PointData");
  for (const FieldArray& field : mesh.fields) {
    const std::string name = absl::StrCat("PointData/", field.name);
    layout.fields.push_back(
        field.components == 1
            ? outline.column(name, Hdf5Type::kFloat32, {shape.nodes})
            : outline.column(name, Hdf5Type::kFloat32, {shape.nodes, field.components}));
  }
  return layout;
}

}  // namespace

std::vector<std::string> part_names_in_vtkhdf(const MeshHeader& mesh) {
  std::vector<std::string> names = names_of(mesh.parts);
  std::ranges::replace(names, ".", "_");
  return names_in_file(names, kPartNames);
}

absl::StatusOr<FileColumns> begin_vtkhdf(AtomicFile& file,
                                         BlockWriter& writer,
                                         const MeshHeader& mesh,
                                         const FileShape& shape) {
  const ColumnTypes types = choose_column_types(mesh, shape);
  const std::uint64_t bytes = column_sizes(mesh, shape, types, mesh.tet_count + 1).total();
  Hdf5Outline outline("VTKHDF");
  const Layout layout = lay_out(outline, mesh, shape, types);
  const auto places =
      put_outline(file, writer, bytes, mesh.fields.size() + mesh.parts.size(), outline);
  if (!places.ok()) return places.status();
  const auto of = [&](Column column) { return places->of(column, 0, 0); };
  FileColumns columns{.shape = shape,
                      .types = types,
                      .starts = {.points = of(layout.points),
                                 .connectivity = of(layout.connectivity),
                                 .regions = of(layout.regions),
                                 .labels = of(layout.labels)}};
  for (const Column field : layout.fields) columns.starts.fields.push_back(of(field));
  const std::uint64_t tets = mesh.tet_count;
  write_at(writer, of(layout.offsets),
           [&] { write_offsets(writer, shape.nodes_per_tet, 0, tets + 1, types.ids); });
  write_at(writer, of(layout.types), [&] { write_types(writer, shape.nodes_per_tet, tets); });
  write_at(writer, of(layout.parts), [&] { write_part_numbers(writer, mesh); });
  if (!writer.status().ok()) return writer.status();
  return columns;
}

absl::Status write_vtkhdf(AtomicFile& file, const FileMesh& mesh, const WriteControl& control) {
  const MeshHeader& header = mesh.mesh.header;
  const FileShape shape = mesh.shape();
  const ColumnTypes types = choose_column_types(header, shape);
  BlockWriter writer(file, column_sizes(header, shape, types, header.tet_count + 1).total(),
                     control);
  const absl::StatusOr<FileColumns> columns = begin_vtkhdf(file, writer, header, shape);
  if (!columns.ok()) return columns.status();
  write_columns(writer, *columns, mesh, whole_of(header));
  return writer.status();
}

}  // namespace tet
