// A tetrahedral mesh in memory, and its header: what is known before the first vertex is.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/byte_buffer.h"
#include "core/base/types.h"
#include "core/mesh/face_regions.h"
#include "core/mesh/faces.h"

namespace tet {

/// How a coordinate is stored; the value is its size in bytes.
enum class CoordinateType : std::uint8_t { kFloat32 = 4, kFloat64 = 8 };
/// How a vertex id is stored; the value is its size in bytes.
enum class IndexType : std::uint8_t { kUint32 = 4, kUint64 = 8 };

constexpr std::size_t size_of(CoordinateType type) { return static_cast<std::size_t>(type); }
constexpr std::size_t size_of(IndexType type) { return static_cast<std::size_t>(type); }

/// A named array of values at the vertices.
struct FieldArray {
  std::string name;
  std::uint32_t components = 1;  ///< of each value: 1, or 3 of a vector
  friend bool operator==(const FieldArray&, const FieldArray&) = default;
};

/// The array that says in which faces of the box a vertex lies: CutFaces, as a number.
inline constexpr char kCutFaceArray[] = "cut_face";

/// One grid's mesh among those of several grids, which are joined: runs of the vertices and of
/// the tets. Its tets have no other vertices.
struct MeshPart {
  std::string name;  ///< of the grid
  std::uint64_t first_vertex = 0, vertex_count = 0;
  std::uint64_t first_tet = 0, tet_count = 0;
  double spacing = 0;  ///< as that of a header
  int levels = 0;
  friend bool operator==(const MeshPart&, const MeshPart&) = default;
};

/// Parts are numbered from 1 on where a tet has a label.
inline constexpr std::size_t kMaxMeshParts = 64;

/// What the faces of one label are.
enum class FaceKind : std::uint8_t {
  kSurface = 1,    ///< between the inside and what is not meshed
  kInterface = 2,  ///< between the inside and the outside, where both are meshed
  kBox = 3,        ///< in a face of the box that the mesh ends at
  kRegion = 4,     ///< a piece of one of the others that the request names
};

/// A name that boundary faces have; each face has one.
struct FaceLabel {
  std::string name;  ///< no other label of the mesh has it
  FaceKind kind = FaceKind::kSurface;
  std::uint32_t part = 0;  ///< the part of a mesh of several grids, from 1 on; else 0
  friend bool operator==(const FaceLabel&, const FaceLabel&) = default;
};

/// Labels of one mesh: a label's number has two bytes.
inline constexpr std::size_t kMaxFaceLabels = 1024;

/// One of the labels that a segmentation's mesh has, as its file has it and as people call it.
struct MeshLabel {
  std::int64_t value = 0;
  std::string name = {};
  friend bool operator==(const MeshLabel&, const MeshLabel&) = default;
};

/// Tets name their label by its place in the header's list, in two bytes; the last number is
/// kept free.
inline constexpr std::size_t kMaxMeshLabels = 65535;
using LabelNumber = std::uint16_t;

/// Totals and encodings of a mesh.
struct MeshHeader {
  std::uint64_t vertex_count = 0;
  std::uint64_t tet_count = 0;
  std::uint64_t chunk_count = 0;
  CoordinateType coordinate_type = CoordinateType::kFloat32;
  IndexType index_type = IndexType::kUint32;
  bool has_regions = false;  ///< both sides are meshed: every tet has a MeshRegion
  WorldPoint origin;         ///< add to every stored position to get world coordinates
  WorldBox bounds;           ///< world coordinates; holds every vertex, not always tightly
  double spacing = 0;        ///< lattice spacing h of the finest leaves, world units
  int levels = 0;            ///< coarser octree levels that the mesh really uses
  std::vector<FieldArray> fields;  ///< that every vertex has values of
  /// The grids' parts of a mesh of several grids, one behind the other; `spacing` is then the
  /// smallest of theirs, and `levels` the most. Empty for a mesh of one grid.
  std::vector<MeshPart> parts = {};
  /// World units: what the request's box was rounded outward to, along the lattice's axes; and
  /// where that is turned, what holds it.
  std::optional<WorldBox> box = {};
  /// For people: which side of the grid's surface was taken for the inside, and why, where
  /// neither its class nor the request says it.
  std::string inside_guess = {};
  /// The names of boundary faces, whether or not a face has them. Empty: the mesh has no faces.
  std::vector<FaceLabel> face_labels = {};
  std::uint64_t face_count = 0;
  /// What the last labels are of: see add_region_labels.
  std::vector<FaceRegion> face_regions = {};

  bool has_faces() const noexcept { return !face_labels.empty(); }

  /// The labels of a segmentation's mesh, by number: then the column of regions has a
  /// LabelNumber of each tet, and `has_regions` is false. Empty for any other mesh.
  std::vector<MeshLabel> labels = {};

  /// Bytes of a tet in the column of regions; 0 where there is none.
  std::size_t region_bytes() const noexcept {
    return !labels.empty() ? sizeof(LabelNumber) : has_regions ? 1 : 0;
  }
  /// float32 values that a vertex has, of all fields together.
  std::size_t field_values() const noexcept;
  /// The spacing of the part that a tet belongs to.
  double spacing_at(std::uint64_t tet) const noexcept;
};

inline std::size_t MeshHeader::field_values() const noexcept {
  std::size_t values = 0;
  for (const FieldArray& field : fields) values += field.components;
  return values;
}

/// Vertices and tets of one chunk: contiguous runs of the mesh's own.
struct ChunkExtent {
  std::uint64_t first_vertex = 0, vertex_count = 0;
  std::uint64_t first_tet = 0, tet_count = 0;
  std::uint64_t first_face = 0, face_count = 0;  ///< of the chunk's tets
};

/// All of a mesh, as if it were one chunk.
inline ChunkExtent whole_of(const MeshHeader& header) noexcept {
  return {0, header.vertex_count, 0, header.tet_count, 0, header.face_count};
}

/// How many columns a chunk has, empty ones with them.
inline constexpr std::size_t kMeshColumns = 7;

/// Sizes of a chunk's columns, bytes.
struct ChunkSizes {
  std::size_t positions, tets, regions, fields;
  std::size_t faces, face_tets, face_labels;

  ChunkSizes(const MeshHeader& header,
             std::uint64_t vertices,
             std::uint64_t tet_count,
             std::uint64_t face_count = 0) noexcept
      : positions(vertices * 3 * size_of(header.coordinate_type)),
        tets(tet_count * 4 * size_of(header.index_type)),
        regions(tet_count * header.region_bytes()),
        fields(vertices * header.field_values() * sizeof(float)),
        faces(face_count * 3 * size_of(header.index_type)),
        face_tets(face_count * size_of(header.index_type)),
        face_labels(face_count * sizeof(std::uint16_t)) {}
  ChunkSizes(const MeshHeader& header, const ChunkExtent& chunk) noexcept
      : ChunkSizes(header, chunk.vertex_count, chunk.tet_count, chunk.face_count) {}
  /// All that lies before a chunk.
  static ChunkSizes before(const MeshHeader& header, const ChunkExtent& chunk) noexcept {
    return {header, chunk.first_vertex, chunk.first_tet, chunk.first_face};
  }

  std::size_t total() const noexcept {
    return positions + tets + regions + fields + faces + face_tets + face_labels;
  }
  /// In the order in which they are sent.
  std::array<std::size_t, kMeshColumns> all() const noexcept {
    return {positions, tets, regions, fields, faces, face_tets, face_labels};
  }
};

/// Where a chunk's columns are to be written.
struct ChunkColumns {
  std::span<std::byte> positions;
  std::span<std::byte> tets;
  std::span<std::byte> regions = {};  ///< empty unless the header has regions or labels
  std::span<std::byte> fields = {};   ///< empty unless the header has fields
  // Empty unless the header has labels of faces.
  std::span<std::byte> faces = {};
  std::span<std::byte> face_tets = {};
  std::span<std::byte> face_labels = {};

  /// In the order in which they are sent.
  std::array<std::span<std::byte>, kMeshColumns> all() const noexcept {
    return {positions, tets, regions, fields, faces, face_tets, face_labels};
  }
};

/// Columns that are only read.
struct ConstColumns {
  std::span<const std::byte> positions, tets;
  std::span<const std::byte> regions = {}, fields = {};
  std::span<const std::byte> faces = {}, face_tets = {}, face_labels = {};

  ConstColumns() = default;
  ConstColumns(const ChunkColumns& columns) noexcept
      : positions(columns.positions),
        tets(columns.tets),
        regions(columns.regions),
        fields(columns.fields),
        faces(columns.faces),
        face_tets(columns.face_tets),
        face_labels(columns.face_labels) {}
};

/// A header with the totals of one of the mesh's chunks, for memory of its size.
MeshHeader header_of_chunk(const MeshHeader& header, const ChunkExtent& chunk);

/// Whether every id of a column of tets is a vertex of the mesh.
bool ids_are_within(std::span<const std::byte> ids, const MeshHeader& header) noexcept;

/// Positions and tets that somebody else holds; tets may be some of the mesh only.
struct MeshView {
  CoordinateType coordinate_type = CoordinateType::kFloat32;
  IndexType index_type = IndexType::kUint32;
  std::span<const std::byte> positions;
  std::span<const std::byte> tets;

  std::uint64_t tet_count() const noexcept { return tets.size() / 4 / size_of(index_type); }
  /// The position as it is stored, relative to the mesh's origin.
  WorldPoint stored_position(std::uint64_t i) const noexcept;
  std::array<std::uint64_t, 4> tet(std::uint64_t i) const noexcept;
  /// Stored positions of a tet's corners.
  std::array<WorldPoint, 4> stored_places(std::uint64_t i) const noexcept;

 private:
  template <class Number, std::size_t N>
  static std::array<Number, N> read_row(std::span<const std::byte> column,
                                        std::uint64_t row) noexcept {
    std::array<Number, N> numbers;
    std::memcpy(numbers.data(), column.data() + row * sizeof(numbers), sizeof(numbers));
    return numbers;
  }
};

inline WorldPoint MeshView::stored_position(std::uint64_t i) const noexcept {
  if (coordinate_type == CoordinateType::kFloat64) {
    const auto [x, y, z] = read_row<double, 3>(positions, i);
    return {x, y, z};
  }
  const auto [x, y, z] = read_row<float, 3>(positions, i);
  return {x, y, z};
}

inline std::array<std::uint64_t, 4> MeshView::tet(std::uint64_t i) const noexcept {
  if (index_type == IndexType::kUint64) return read_row<std::uint64_t, 4>(tets, i);
  const auto [a, b, c, d] = read_row<std::uint32_t, 4>(tets, i);
  return {a, b, c, d};
}

inline std::array<WorldPoint, 4> MeshView::stored_places(std::uint64_t i) const noexcept {
  const auto [a, b, c, d] = tet(i);
  return {stored_position(a), stored_position(b), stored_position(c), stored_position(d)};
}

/// A whole mesh as columns, in exactly the bytes that chunks carry (little-endian).
///
/// positions: vertex_count * 3 coordinates (x, y, z), relative to `header.origin`.
/// tets: tet_count * 4 vertex ids, each tet positive: det(b-a, c-a, d-a) > 0.
/// regions: tet_count MeshRegions of one byte, or LabelNumbers of two, or nothing.
/// fields: vertex_count rows of float32, in each the values of one field after the other; or
/// nothing.
/// faces: face_count * 3 vertex ids, or nothing: the boundary triangles, counter-clockwise seen
/// from outside the tet that each belongs to, in the order of those tets and, within one, of
/// the corners opposite them (see kFaceCorners, which says where each begins). Where both sides
/// are meshed, what lies between them is there once, as the inside's.
///
/// face_tets: face_count numbers of tets, stored as ids are: of a mesh with faces no number of
/// a tet is too large for that.
///
/// face_labels: face_count uint16, places in header.face_labels.
struct TetMesh {
  MeshHeader header;
  ByteBuffer positions;
  ByteBuffer tets;
  ByteBuffer regions;
  ByteBuffer fields;
  ByteBuffer faces;
  ByteBuffer face_tets;
  ByteBuffer face_labels;

  TetMesh() = default;
  /// Columns sized for the header's totals, not filled.
  explicit TetMesh(const MeshHeader& mesh_header);
  /// Takes the memory of a mesh that is no longer needed for its columns, as far as that is
  /// enough.
  TetMesh(const MeshHeader& mesh_header, TetMesh&& used);

  /// World coordinates, in double whatever the storage.
  WorldPoint vertex(std::uint64_t i) const noexcept;
  /// The position as it is stored, relative to `header.origin`: angles keep every bit however
  /// far that is from zero.
  WorldPoint stored_position(std::uint64_t i) const noexcept;
  /// Moves a vertex; `position` is relative to `header.origin` and rounded as it is stored.
  void store_position(std::uint64_t i, const WorldPoint& position) noexcept;
  std::array<std::uint64_t, 4> tet(std::uint64_t i) const noexcept;

  Triangle face(std::uint64_t i) const noexcept;
  /// The tet that a face belongs to.
  std::uint64_t face_tet(std::uint64_t i) const noexcept;
  std::uint16_t face_label(std::uint64_t i) const noexcept;

  MeshView view() const noexcept;

  /// Inside, unless the mesh has regions.
  MeshRegion region(std::uint64_t i) const noexcept;
  /// The number of a tet's label, where the mesh has labels.
  LabelNumber label(std::uint64_t i) const noexcept;

  /// All of its columns.
  ChunkColumns columns() noexcept { return columns_of(whole_of(header)); }
  ConstColumns columns() const noexcept;
  /// Where a chunk's columns lie within the mesh's.
  ChunkColumns columns_of(const ChunkExtent& chunk) noexcept;
};

inline MeshView TetMesh::view() const noexcept {
  return {header.coordinate_type, header.index_type, positions.bytes(), tets.bytes()};
}

inline WorldPoint TetMesh::stored_position(std::uint64_t i) const noexcept {
  return view().stored_position(i);
}

inline std::array<std::uint64_t, 4> TetMesh::tet(std::uint64_t i) const noexcept {
  return view().tet(i);
}

}  // namespace tet
