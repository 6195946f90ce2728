#include "core/files/mesh_columns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

namespace tet {
namespace {

/// Half a unit in the last place of a float32 just below 1, and how far a vertex may move.
constexpr double kFloat32Rounding = 0x1p-24;
constexpr double kMaxShiftPerSpacing = 1e-4;

double largest_coordinate(const WorldBox& box) noexcept {
  const auto largest = [](const WorldPoint& p) {
    return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  };
  return std::max(largest(box.min), largest(box.max));
}

template <class Number>
void write_points_as(BlockWriter& writer, const FileMesh& mesh) {
  writer.rows_side_by_side(mesh.shape().nodes, [&](std::uint64_t i) {
    const auto [x, y, z] = mesh.node(i);
    return std::array{static_cast<Number>(x), static_cast<Number>(y), static_cast<Number>(z)};
  });
}

/// Rows whose values follow from their numbers are made so many at a time: in vectors.
constexpr std::size_t kRowsAtOnce = 64;

/// Writes `value_of(i)` for each i below `count`.
template <class ValueOf>
void write_values_of(BlockWriter& writer, std::uint64_t count, const ValueOf& value_of) {
  using Value = std::invoke_result_t<ValueOf, std::uint64_t>;
  writer.rows_side_by_side(count / kRowsAtOnce, [&](std::uint64_t batch) {
    std::array<Value, kRowsAtOnce> values;
    for (std::size_t i = 0; i < kRowsAtOnce; ++i) values[i] = value_of(batch * kRowsAtOnce + i);
    return values;
  });
  const std::uint64_t done = count / kRowsAtOnce * kRowsAtOnce;
  writer.rows(count - done, [&](std::uint64_t i) { return value_of(done + i); });
}

template <class Number>
void write_offsets_as(BlockWriter& writer,
                      std::size_t nodes_per_tet,
                      std::uint64_t first,
                      std::uint64_t count) {
  write_values_of(writer, count, [&](std::uint64_t i) {
    return static_cast<Number>(nodes_per_tet * (first + i));
  });
}

template <class Id, std::size_t kNodes>
void write_connectivity_as(BlockWriter& writer, const FileMesh& mesh) {
  writer.rows_side_by_side(mesh.mesh.header.tet_count, [&](std::uint64_t i) {
    std::array<Id, kNodes> ids;
    std::ranges::transform(mesh.nodes_of<kNodes>(i), ids.begin(),
                           [](std::uint64_t id) { return static_cast<Id>(id); });
    return ids;
  });
}

/// Reads one field of rows that have the values of all.
template <std::size_t kComponents>
class FieldRows {
 public:
  FieldRows(const FileMesh& mesh, std::size_t field) : mesh_(mesh) {
    for (std::size_t i = 0; i < field; ++i) {
      before_ += mesh.mesh.header.fields[i].components * sizeof(float);
    }
  }

  std::array<float, kComponents> operator()(std::uint64_t node) const {
    std::array<float, kComponents> values;
    std::memcpy(values.data(), mesh_.field_row(node) + before_, sizeof(values));
    return values;
  }

 private:
  const FileMesh& mesh_;
  std::size_t before_ = 0;  ///< bytes of a row
};

template <std::size_t kComponents>
void write_numbered(BlockWriter& writer,
                    const FileMesh& mesh,
                    std::size_t field,
                    std::uint64_t first) {
  const FieldRows<kComponents> rows(mesh, field);
  writer.rows_side_by_side(mesh.shape().nodes, [&](std::uint64_t i) {
    const auto number = static_cast<std::int32_t>(first + i + 1);
    std::array<double, kComponents> values;
    std::ranges::copy(rows(i), values.begin());
    std::array<std::byte, sizeof(number) + sizeof(values)> row;
    std::memcpy(row.data(), &number, sizeof(number));
    std::memcpy(row.data() + sizeof(number), values.data(), sizeof(values));
    return row;
  });
}

}  // namespace

CoordinateType file_coordinate_type(const MeshHeader& header) noexcept {
  const double rounding = largest_coordinate(header.bounds) * kFloat32Rounding;
  const bool fits = rounding <= kMaxShiftPerSpacing * header.spacing;
  return fits ? header.coordinate_type : CoordinateType::kFloat64;
}

ColumnTypes choose_column_types(const MeshHeader& header, const FileShape& shape) noexcept {
  constexpr auto kLargest =
      static_cast<std::uint64_t>(std::numeric_limits<std::int32_t>::max());
  const bool fits =
      shape.nodes <= kLargest && header.tet_count <= kLargest / shape.nodes_per_tet;
  return {file_coordinate_type(header), fits ? IndexType::kUint32 : IndexType::kUint64};
}

ColumnSizes column_sizes(const MeshHeader& header,
                         const FileShape& shape,
                         const ColumnTypes& types,
                         std::uint64_t offset_rows) noexcept {
  return {.points = shape.nodes * 3 * size_of(types.coordinates),
          .connectivity = header.tet_count * shape.nodes_per_tet * size_of(types.ids),
          .offsets = offset_rows * size_of(types.ids),
          .types = header.tet_count,
          .regions = header.tet_count * (header.has_regions      ? 1
                                         : header.labels.empty() ? 0
                                                                 : label_value_bytes(header)),
          .parts = header.parts.empty() ? 0 : header.tet_count,
          .fields = ChunkSizes(header, shape.nodes, 0).fields};
}

void write_points(BlockWriter& writer, const FileMesh& mesh, CoordinateType type) {
  const MeshHeader& header = mesh.mesh.header;
  const bool as_stored = header.origin == WorldPoint{} && header.coordinate_type == type;
  if (as_stored) {
    writer.bytes(mesh.mesh.positions.bytes());
    if (mesh.middles != nullptr) writer.bytes(mesh.middles->positions.bytes());
  } else if (type == CoordinateType::kFloat32) {
    write_points_as<float>(writer, mesh);
  } else {
    write_points_as<double>(writer, mesh);
  }
}

void write_field(BlockWriter& writer, const FileMesh& mesh, std::size_t field) {
  const std::uint64_t nodes = mesh.shape().nodes;
  if (mesh.mesh.header.fields.size() == 1) {
    writer.bytes(mesh.mesh.fields.bytes());
    if (mesh.middles != nullptr) writer.bytes(mesh.middles->fields.bytes());
  } else if (mesh.mesh.header.fields[field].components == 1) {
    writer.rows_side_by_side(nodes, FieldRows<1>(mesh, field));
  } else {
    writer.rows_side_by_side(nodes, FieldRows<3>(mesh, field));
  }
}

void write_numbered_field(BlockWriter& writer,
                          const FileMesh& mesh,
                          std::size_t field,
                          std::uint64_t first) {
  if (mesh.mesh.header.fields[field].components == 1) {
    write_numbered<1>(writer, mesh, field, first);
  } else {
    write_numbered<3>(writer, mesh, field, first);
  }
}

void write_connectivity(BlockWriter& writer, const FileMesh& mesh, IndexType type) {
  if (mesh.middles == nullptr && mesh.mesh.header.index_type == type) {
    writer.bytes(mesh.mesh.tets.bytes());
    return;
  }
  with_nodes_per_tet(mesh, [&](auto nodes) {
    constexpr std::size_t kNodes = decltype(nodes)::value;
    if (type == IndexType::kUint64) {
      write_connectivity_as<std::uint64_t, kNodes>(writer, mesh);
    } else {
      write_connectivity_as<std::uint32_t, kNodes>(writer, mesh);
    }
  });
}

void write_offsets(BlockWriter& writer,
                   std::size_t nodes_per_tet,
                   std::uint64_t first,
                   std::uint64_t count,
                   IndexType type) {
  if (type == IndexType::kUint64) {
    write_offsets_as<std::uint64_t>(writer, nodes_per_tet, first, count);
  } else {
    write_offsets_as<std::uint32_t>(writer, nodes_per_tet, first, count);
  }
}

void write_part_numbers(BlockWriter& writer, const MeshHeader& header) {
  std::size_t part = 0;  // rows are made in order
  writer.rows(header.tet_count, [&](std::uint64_t tet) {
    while (tet - header.parts[part].first_tet >= header.parts[part].tet_count) ++part;
    return static_cast<std::uint8_t>(part + 1);
  });
}

std::size_t label_value_bytes(const MeshHeader& header) noexcept {
  using Narrow = std::numeric_limits<std::int32_t>;
  const bool fits = std::ranges::all_of(header.labels, [](const MeshLabel& label) {
    return label.value >= Narrow::min() && label.value <= Narrow::max();
  });
  return fits ? sizeof(std::int32_t) : sizeof(std::int64_t);
}

void write_label_values(BlockWriter& writer, const TetMesh& mesh, std::size_t value_bytes) {
  const auto value = [&](std::uint64_t tet) {
    return mesh.header.labels[mesh.label(tet)].value;
  };
  if (value_bytes == sizeof(std::int64_t)) {
    writer.rows_side_by_side(mesh.header.tet_count, value);
  } else {
    writer.rows_side_by_side(mesh.header.tet_count, [&](std::uint64_t tet) {
      return static_cast<std::int32_t>(value(tet));
    });
  }
}

void write_types(BlockWriter& writer, std::size_t nodes_per_tet, std::uint64_t count) {
  const std::uint8_t type = nodes_per_tet == 4 ? kVtkTetra : kVtkQuadraticTetra;
  write_values_of(writer, count, [&](std::uint64_t) { return type; });
}

void write_columns(BlockWriter& writer,
                   const FileColumns& columns,
                   const FileMesh& part,
                   const ChunkExtent& place) {
  const ColumnTypes& types = columns.types;
  const ColumnStarts& starts = columns.starts;
  const std::size_t nodes_per_tet = columns.shape.nodes_per_tet;
  const MeshHeader& header = part.mesh.header;
  // Has `write` write from a row of a column on, where there is that column.
  const auto at = [&](const ColumnStarts::Start& column, std::uint64_t row,
                      std::size_t row_bytes, const auto& write) {
    if (!column) return;
    writer.move_to(*column + row * row_bytes);
    write();
  };
  at(starts.points, place.first_vertex, 3 * size_of(types.coordinates),
     [&] { write_points(writer, part, types.coordinates); });
  at(starts.connectivity, place.first_tet, nodes_per_tet * size_of(types.ids),
     [&] { write_connectivity(writer, part, types.ids); });
  at(starts.regions, place.first_tet, 1, [&] { writer.bytes(part.mesh.regions.bytes()); });
  const std::size_t label_bytes = header.labels.empty() ? 0 : label_value_bytes(header);
  at(starts.labels, place.first_tet, label_bytes,
     [&] { write_label_values(writer, part.mesh, label_bytes); });
  for (std::size_t i = 0; i < starts.fields.size(); ++i) {
    at(starts.fields[i], place.first_vertex, header.fields[i].components * sizeof(float),
       [&] { write_field(writer, part, i); });
  }
}

}  // namespace tet
