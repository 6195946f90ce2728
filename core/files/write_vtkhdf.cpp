#include "core/files/write_vtkhdf.h"

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_replace.h>

#include "core/files/hdf5_outline.h"
#include "core/files/mesh_columns.h"

namespace tet {
namespace {

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
  for (std::size_t i = 0; i < mesh.parts.size(); ++i) {
    const std::string name = absl::StrReplaceAll(mesh.parts[i].name, {{"/", "_"}});
    outline.number(absl::StrCat("FieldData/", name), i + 1);
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

struct VtkHdfWriter::Impl {
  ColumnTypes types;
  Layout layout;
  Hdf5Places places;
  BlockWriter writer;
};

VtkHdfWriter::VtkHdfWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
VtkHdfWriter::VtkHdfWriter(VtkHdfWriter&&) noexcept = default;
VtkHdfWriter::~VtkHdfWriter() = default;

absl::StatusOr<VtkHdfWriter> VtkHdfWriter::begin(AtomicFile& file,
                                                 const MeshHeader& mesh,
                                                 const FileShape& shape,
                                                 const WriteControl& control) {
  const ColumnTypes types = choose_column_types(mesh, shape);
  const std::uint64_t tets = mesh.tet_count;
  const std::uint64_t column_bytes = column_sizes(mesh, shape, types, tets + 1).total();
  Hdf5Outline outline("VTKHDF");
  const Layout layout = lay_out(outline, mesh, shape, types);
  auto impl = std::unique_ptr<Impl>(
      new Impl{types, layout, {}, BlockWriter(file, column_bytes, control)});
  BlockWriter& writer = impl->writer;
  auto places =
      put_outline(file, writer, column_bytes, mesh.fields.size() + mesh.parts.size(), outline);
  if (!places.ok()) return places.status();
  impl->places = *std::move(places);
  write_at(writer, impl->places.of(layout.offsets, 0, 0),
           [&] { write_offsets(writer, shape.nodes_per_tet, 0, tets + 1, types.ids); });
  write_at(writer, impl->places.of(layout.types, 0, 0),
           [&] { write_types(writer, shape.nodes_per_tet, tets); });
  write_at(writer, impl->places.of(layout.parts, 0, 0),
           [&] { write_part_numbers(writer, mesh); });
  if (!writer.status().ok()) return writer.status();
  return VtkHdfWriter(std::move(impl));
}

absl::Status VtkHdfWriter::put(const FileMesh& nodes, const ChunkExtent& place) {
  const TetMesh& part = nodes.mesh;
  const ColumnTypes& as = impl_->types;
  const Layout& layout = impl_->layout;
  const Hdf5Places& places = impl_->places;
  BlockWriter& to = impl_->writer;
  write_at(to, places.of(layout.points, place.first_vertex, 3 * size_of(as.coordinates)),
           [&] { write_points(to, nodes, as.coordinates); });
  write_at(to,
           places.of(layout.connectivity, place.first_tet,
                     nodes.shape().nodes_per_tet * size_of(as.ids)),
           [&] { write_connectivity(to, nodes, as.ids); });
  write_at(to, places.of(layout.regions, place.first_tet, 1),
           [&] { to.bytes(part.regions.bytes()); });
  if (!part.header.labels.empty()) {
    const std::size_t bytes = label_value_bytes(part.header);
    write_at(to, places.of(layout.labels, place.first_tet, bytes),
             [&] { write_label_values(to, part, bytes); });
  }
  for (std::size_t i = 0; i < layout.fields.size(); ++i) {
    const std::size_t row_bytes = part.header.fields[i].components * sizeof(float);
    write_at(to, places.of(layout.fields[i], place.first_vertex, row_bytes),
             [&] { write_field(to, nodes, i); });
  }
  return to.status();
}

absl::Status write_vtkhdf(AtomicFile& file, const FileMesh& mesh, const WriteControl& control) {
  const MeshHeader& header = mesh.mesh.header;
  auto writer = VtkHdfWriter::begin(file, header, mesh.shape(), control);
  if (!writer.ok()) return writer.status();
  return writer->put(mesh, whole_of(header));
}

}  // namespace tet
