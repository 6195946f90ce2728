// The columns of a file, made from a mesh while they are written.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/files/block_writer.h"
#include "core/files/file_mesh.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// The coordinates a file of world coordinates needs: float32 where rounding the largest of
/// them (half a unit in 2^-23) moves a vertex by at most 1e-4 of the lattice spacing, which
/// bends no angle by more than about 0.02 degrees; else, or when the mesh is stored so,
/// float64.
CoordinateType file_coordinate_type(const MeshHeader& header) noexcept;

/// How the columns of one mesh are stored in a file.
struct ColumnTypes {
  CoordinateType coordinates = CoordinateType::kFloat32;
  /// Signed, as VTK's own ids are; int32 while every id and offset fits, so that VTK need not
  /// convert.
  IndexType ids = IndexType::kUint32;
};
ColumnTypes choose_column_types(const MeshHeader& header, const FileShape& shape) noexcept;

/// VTK's numbers for a tetrahedron of four nodes, and for one of ten.
inline constexpr std::uint8_t kVtkTetra = 10, kVtkQuadraticTetra = 24;

/// Bytes of each column.
struct ColumnSizes {
  std::uint64_t points = 0, connectivity = 0, offsets = 0, types = 0;
  std::uint64_t regions = 0;  ///< or labels; of a mesh without them none
  std::uint64_t parts = 0;    ///< of one grid's mesh none
  std::uint64_t fields = 0;   ///< of all fields together
  std::uint64_t total() const noexcept {
    return points + connectivity + offsets + types + regions + parts + fields;
  }
};
/// `offset_rows` is the number of tets, or one more where a format wants the leading zero.
ColumnSizes column_sizes(const MeshHeader& header,
                         const FileShape& shape,
                         const ColumnTypes& types,
                         std::uint64_t offset_rows) noexcept;

/// x, y, z of each node in world coordinates.
void write_points(BlockWriter& writer, const FileMesh& mesh, CoordinateType type);
/// The values of field number `field`, float32, 1 or 3 a node.
void write_field(BlockWriter& writer, const FileMesh& mesh, std::size_t field);
/// Writes a field as doubles, with each node's number in front of its values: an int32 that
/// counts from 1. The mesh's own nodes are the file's from `first` on.
void write_numbered_field(BlockWriter& writer,
                          const FileMesh& mesh,
                          std::size_t field,
                          std::uint64_t first);
/// Four or ten node ids a tet.
void write_connectivity(BlockWriter& writer, const FileMesh& mesh, IndexType type);
/// `first`, `first` + 1, ... `count` of them, each times the nodes of a tet.
void write_offsets(BlockWriter& writer,
                   std::size_t nodes_per_tet,
                   std::uint64_t first,
                   std::uint64_t count,
                   IndexType type);
/// Which part of a mesh of several grids each tet is of: one byte, from 1 on.
void write_part_numbers(BlockWriter& writer, const MeshHeader& header);
/// The value of each tet's label, as its segmentation has it: int32, or int64 where one of them
/// needs it (see label_value_bytes).
void write_label_values(BlockWriter& writer, const TetMesh& mesh, std::size_t value_bytes);
/// Bytes of a label's value in a file: 4 or 8.
std::size_t label_value_bytes(const MeshHeader& header) noexcept;
/// `count` times VTK's number for tets of so many nodes.
void write_types(BlockWriter& writer, std::size_t nodes_per_tet, std::uint64_t count);

/// Where the columns of a file begin; unset where it has none, or none of any bytes.
struct ColumnStarts {
  using Start = std::optional<std::uint64_t>;
  Start points = {}, connectivity = {}, regions = {}, labels = {};
  std::vector<Start> fields = {};
};

/// How a file has the columns that come with vertices and tets, and where. Everything else of
/// it is written already.
struct FileColumns {
  FileShape shape;
  ColumnTypes types;
  ColumnStarts starts;
};

/// Writes those rows of the columns that some vertices and tets have (their ids are those of
/// the whole mesh). A mesh of second order is written as a whole. Thread-safe, with a writer
/// for each thread.
void write_columns(BlockWriter& writer,
                   const FileColumns& columns,
                   const FileMesh& part,
                   const ChunkExtent& place);

}  // namespace tet
