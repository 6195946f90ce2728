#include "core/files/write_vtkhdf.h"

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_replace.h>
#include <hdf5.h>

#include "core/files/hdf5_outline.h"
#include "core/files/mesh_columns.h"

namespace tet {
namespace {

/// Where HDF5 has put the columns; nothing for a column without bytes.
struct Layout {
  haddr_t points = HADDR_UNDEF, connectivity = HADDR_UNDEF, offsets = HADDR_UNDEF;
  haddr_t types = HADDR_UNDEF, regions = HADDR_UNDEF, parts = HADDR_UNDEF;
  haddr_t labels = HADDR_UNDEF;
  std::vector<haddr_t> fields = {};
};

/// VTK 9.1 wants the type as a string of fixed length.
void write_type_attribute(Hdf5Outline& outline) {
  constexpr std::string_view kType = "UnstructuredGrid";
  const Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), kType.size());
  outline.attribute("Type", type.get(), {}, kType.data());
}

/// Which number the part of each grid has, as arrays called like the grids.
void add_part_names(Hdf5Outline& outline, const MeshHeader& mesh) {
  outline.group("FieldData");
  for (std::size_t i = 0; i < mesh.parts.size(); ++i) {
    const std::string name = absl::StrReplaceAll(mesh.parts[i].name, {{"/", "_"}});
    outline.number(absl::StrCat("FieldData/", name).c_str(), i + 1);
  }
}

std::optional<Layout> lay_out(const std::string& path,
                              const MeshHeader& mesh,
                              const FileShape& shape,
                              const ColumnTypes& types) {
  const hid_t real =
      types.coordinates == CoordinateType::kFloat64 ? H5T_IEEE_F64LE : H5T_IEEE_F32LE;
  const hid_t id = types.ids == IndexType::kUint64 ? H5T_STD_I64LE : H5T_STD_I32LE;
  const std::array<std::int64_t, 2> version{1, 0};

  Hdf5Outline outline(path, "VTKHDF");
  outline.attribute("Version", H5T_STD_I64LE, {2}, version.data());
  write_type_attribute(outline);
  outline.number("NumberOfPoints", shape.nodes);
  outline.number("NumberOfCells", mesh.tet_count);
  outline.number("NumberOfConnectivityIds", shape.nodes_per_tet * mesh.tet_count);
  Layout layout{.points = outline.column("Points", real, {shape.nodes, 3}),
                .connectivity =
                    outline.column("Connectivity", id, {shape.nodes_per_tet * mesh.tet_count}),
                .offsets = outline.column("Offsets", id, {mesh.tet_count + 1}),
                .types = outline.column("Types", H5T_STD_U8LE, {mesh.tet_count})};
  if (mesh.has_regions) {
    outline.group("CellData");
    layout.regions = outline.column("CellData/region", H5T_STD_U8LE, {mesh.tet_count});
  }
  if (!mesh.labels.empty()) {
    outline.group("CellData");
    const bool narrow = label_value_bytes(mesh) == sizeof(std::int32_t);
    layout.labels = outline.column("CellData/label", narrow ? H5T_STD_I32LE : H5T_STD_I64LE,
                                   {mesh.tet_count});
  }
  if (!mesh.parts.empty()) {
    outline.group("CellData");
    layout.parts = outline.column("CellData/part", H5T_STD_U8LE, {mesh.tet_count});
    add_part_names(outline, mesh);
  }
  if (!mesh.fields.empty()) outline.group("PointData");
  for (const FieldArray& field : mesh.fields) {
    const std::string name = absl::StrCat("PointData/", field.name);
    layout.fields.push_back(
        field.components == 1
            ? outline.column(name.c_str(), H5T_IEEE_F32LE, {shape.nodes})
            : outline.column(name.c_str(), H5T_IEEE_F32LE, {shape.nodes, field.components}));
  }
  if (!outline.close()) return std::nullopt;
  return layout;
}

}  // namespace

struct VtkHdfWriter::Impl {
  ColumnTypes types;
  Layout layout;
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
  auto impl =
      std::unique_ptr<Impl>(new Impl{types, {}, BlockWriter(file, column_bytes, control)});
  BlockWriter& writer = impl->writer;
  std::optional<Layout> layout;
  const absl::Status status =
      put_outline(file, writer, column_bytes, mesh.fields.size() + mesh.parts.size(),
                  [&](const std::string& path) {
                    layout = lay_out(path, mesh, shape, types);
                    return layout.has_value();
                  });
  if (!status.ok()) return status;
  impl->layout = *layout;
  write_at(writer, place_of(layout->offsets, 0, 0),
           [&] { write_offsets(writer, shape.nodes_per_tet, 0, tets + 1, types.ids); });
  write_at(writer, place_of(layout->types, 0, 0),
           [&] { write_types(writer, shape.nodes_per_tet, tets); });
  write_at(writer, place_of(layout->parts, 0, 0), [&] { write_part_numbers(writer, mesh); });
  if (!writer.status().ok()) return writer.status();
  return VtkHdfWriter(std::move(impl));
}

absl::Status VtkHdfWriter::put(const FileMesh& nodes, const ChunkExtent& place) {
  const TetMesh& part = nodes.mesh;
  const ColumnTypes& as = impl_->types;
  const Layout& layout = impl_->layout;
  BlockWriter& to = impl_->writer;
  write_at(to, place_of(layout.points, place.first_vertex, 3 * size_of(as.coordinates)),
           [&] { write_points(to, nodes, as.coordinates); });
  write_at(to,
           place_of(layout.connectivity, place.first_tet,
                    nodes.shape().nodes_per_tet * size_of(as.ids)),
           [&] { write_connectivity(to, nodes, as.ids); });
  write_at(to, place_of(layout.regions, place.first_tet, 1),
           [&] { to.bytes(part.regions.bytes()); });
  if (!part.header.labels.empty()) {
    const std::size_t bytes = label_value_bytes(part.header);
    write_at(to, place_of(layout.labels, place.first_tet, bytes),
             [&] { write_label_values(to, part, bytes); });
  }
  for (std::size_t i = 0; i < layout.fields.size(); ++i) {
    const std::size_t row_bytes = part.header.fields[i].components * sizeof(float);
    write_at(to, place_of(layout.fields[i], place.first_vertex, row_bytes),
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
