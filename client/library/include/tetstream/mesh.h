// A tetrahedral mesh as arrays: the whole of it, or chunk by chunk.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tetstream/export.h"

namespace tetstream {

/// World coordinates.
using Point = std::array<double, 3>;

/// World coordinates; `min` is below `max` along every axis.
struct Box {
  Point min{}, max{};
};

/// A named array of values at the vertices.
struct FieldArray {
  std::string name;
  std::uint32_t components = 1;  ///< of each value: 1, or 3 of a vector
  std::uint32_t offset = 0;      ///< of its first component in a vertex's row of values
};

/// One grid's mesh within a mesh of several grids: runs of the vertices and of the tets.
struct MeshPart {
  std::string name;  ///< of the grid
  std::uint64_t first_vertex = 0, vertex_count = 0;
  std::uint64_t first_tet = 0, tet_count = 0;
};

/// A name that boundary faces have; each face has one.
struct FaceLabel {
  enum class Kind : std::uint8_t {
    kSurface = 1,    ///< between the inside and what is not meshed
    kInterface = 2,  ///< between the inside and the outside, where both are meshed
    kBox = 3,        ///< in a face of the box that the mesh ends at
    kRegion = 4,     ///< a piece of one of the others that the request names
  };
  std::string name;  ///< no other label of the mesh has it
  Kind kind = Kind::kSurface;
  std::uint32_t part = 0;  ///< the part of a mesh of several grids, from 1 on; else 0
};

/// A label of a segmentation, and what it is called, if it is.
struct MeshLabel {
  std::int64_t value = 0;  ///< as the image has it
  std::string name = {};
};

/// What is known of a mesh before its first vertex: enough to allocate all of it.
struct MeshHeader {
  std::uint64_t vertex_count = 0;
  std::uint64_t tet_count = 0;
  std::uint64_t chunk_count = 0;
  bool float64 = false;            ///< coordinates are double, else float
  bool uint64 = false;             ///< vertex ids have 64 bits, else 32
  bool has_regions = false;        ///< both sides are meshed: every tet has a region
  Point origin{};                  ///< to be added to stored coordinates
  Box bounds;                      ///< holds every vertex; not always tight
  double spacing = 0;              ///< of the finest leaves, world units
  int levels = 0;                  ///< coarser octree levels that the mesh uses
  std::vector<FieldArray> fields;  ///< that every vertex has values of
  std::uint32_t field_values = 0;  ///< floats that a vertex has, of all fields together
  std::vector<MeshPart> parts;     ///< of a mesh of several grids; else empty
  /// For people: which side of a grid's surface was taken for the inside, and why, where
  /// neither its class nor the request says it; a line for each such grid.
  std::string inside_guess;
  std::string id;  ///< from a server: the same id is the same bytes
  /// Where the request asks for faces: their names, whether or not a face has them.
  std::vector<FaceLabel> face_labels = {};
  std::uint64_t face_count = 0;
  /// What the tets of a segmentation's mesh are of, by ascending value, and last the
  /// background where it is meshed; else empty.
  std::vector<MeshLabel> labels = {};
};

/// What is told of a whole mesh beside itself.
struct Statistics {
  /// Dihedral angles, degrees, and volume; nothing where the request leaves statistics out, and
  /// where a stream of chunks was resumed after a connection broke.
  struct Quality {
    double min_dihedral_deg = 0, max_dihedral_deg = 0;
    double volume = 0;                           ///< world units cubed
    std::array<std::uint64_t, 180> histogram{};  ///< six angles a tet, by whole degrees
  };
  /// Topology of the boundary of the inside.
  struct Boundary {
    std::uint64_t triangles = 0, vertices = 0, components = 0;
    std::int64_t euler_characteristic = 0;
    std::uint64_t non_manifold_edges = 0, non_manifold_vertices = 0;
  };
  /// What the request's `improve` did.
  struct Improvement {
    double min_dihedral_before_deg = 0, max_dihedral_before_deg = 0;
    std::uint64_t moved_vertices = 0;
  };
  /// Places where the lattice is too coarse for the surface's walls.
  struct ThinWalls {
    std::uint64_t inside = 0, outside = 0;
    double suggested_spacing = 0;  ///< that would resolve them; 0 where none is known
  };

  /// Distances from points on one surface to another one, world units.
  struct SurfaceDistance {
    double max = 0, rms = 0;
    Point at{};  ///< where the largest was found
    std::uint64_t samples = 0;
  };
  /// How far the mesh's surface is from the zero surface, and back: docs/report.md.
  struct Fidelity {
    double spacing = 0;  ///< of the finest leaves
    SurfaceDistance mesh_to_surface, surface_to_mesh;
    double mesh_area = 0, surface_area = 0;
    double mesh_volume = 0;  ///< of the tets inside
    /// What the zero surface encloses; nothing where the request has a box.
    std::optional<double> enclosed_volume = {};

    double hausdorff() const noexcept {
      return mesh_to_surface.max < surface_to_mesh.max ? surface_to_mesh.max
                                                       : mesh_to_surface.max;
    }
  };
  /// A ratio that is 1 for the regular tet, of all tets.
  struct Ratio {
    double min = 0, mean = 0, max = 0;
    /// Tets in each fiftieth of 0 to 1; what is below counts in the first.
    std::array<std::uint64_t, 50> histogram{};
  };
  /// Shapes of all tets: docs/report.md has the formulas.
  struct Shapes {
    Ratio scaled_jacobian, radius_ratio, edge_ratio;
    double shortest_edge = 0, longest_edge = 0;
    std::uint64_t not_positive = 0;  ///< tets whose volume is zero or less
  };

  std::optional<Quality> quality;
  std::optional<Boundary> boundary;
  std::optional<Improvement> improvement;
  ThinWalls thin_walls;
  /// Names of the request's face regions that took no face: nothing is there, or those before
  /// them took it. Not of a stream of chunks.
  std::vector<std::string> empty_face_regions = {};
  /// Where the request asks for it: one of a mesh of one grid, or of several one a part.
  std::vector<Fidelity> fidelity = {};
  std::optional<Shapes> shapes = {};  ///< where the request asks for fidelity
};

/// Vertices, tets and faces as arrays that somebody else holds. Of `points32` and `points64`
/// one is empty, and so is one of `tets32` and `tets64`: the header says which. Faces are
/// stored as tets are.
struct MeshColumns {
  std::span<const float> points32;        ///< x, y, z of each vertex, relative to the origin
  std::span<const double> points64;       ///< the same where the header says float64
  std::span<const std::uint32_t> tets32;  ///< four vertex ids of each tet, counted in the mesh
  std::span<const std::uint64_t> tets64;  ///< the same where the header says uint64
  std::span<const std::uint8_t> regions;  ///< of each tet: 1 inside, 2 outside; or empty
  std::span<const float> fields;          ///< `field_values` of each vertex; or empty
  std::span<const std::uint32_t> faces32 = {};  ///< three vertex ids of each boundary face
  std::span<const std::uint64_t> faces64 = {};
  std::span<const std::uint32_t> face_tets32 =
      {};  ///< the tet of each face, as the mesh counts
  std::span<const std::uint64_t> face_tets64 = {};
  std::span<const std::uint16_t> face_labels = {};  ///< places in the header's `face_labels`
  /// A place in the header's `labels` for each tet of a segmentation's mesh; else empty.
  std::span<const std::uint16_t> labels = {};

  std::size_t vertex_count() const noexcept { return (points32.size() + points64.size()) / 3; }
  std::size_t tet_count() const noexcept { return (tets32.size() + tets64.size()) / 4; }
  std::size_t face_count() const noexcept { return face_labels.size(); }
  /// Stored coordinates of the i-th vertex here, relative to the header's origin.
  Point point(std::size_t i) const noexcept {
    if (!points64.empty()) return {points64[3 * i], points64[3 * i + 1], points64[3 * i + 2]};
    return {points32[3 * i], points32[3 * i + 1], points32[3 * i + 2]};
  }
  /// Vertex ids of the i-th tet here. det(b - a, c - a, d - a) is positive.
  std::array<std::uint64_t, 4> tet(std::size_t i) const noexcept {
    if (!tets64.empty()) {
      return {tets64[4 * i], tets64[4 * i + 1], tets64[4 * i + 2], tets64[4 * i + 3]};
    }
    return {tets32[4 * i], tets32[4 * i + 1], tets32[4 * i + 2], tets32[4 * i + 3]};
  }
  /// Vertex ids of the i-th face here, counter-clockwise seen from outside its tet.
  std::array<std::uint64_t, 3> face(std::size_t i) const noexcept {
    if (!faces64.empty()) return {faces64[3 * i], faces64[3 * i + 1], faces64[3 * i + 2]};
    return {faces32[3 * i], faces32[3 * i + 1], faces32[3 * i + 2]};
  }
  std::uint64_t face_tet(std::size_t i) const noexcept {
    return face_tets64.empty() ? face_tets32[i] : face_tets64[i];
  }
};

/// A contiguous run of a mesh's vertices and tets. Chunks come in order and leave no gaps, so
/// `first_vertex` and `first_tet` are what earlier ones held. A tet may refer to vertices of
/// chunks before it and after it.
struct Chunk {
  std::uint64_t index = 0;  ///< from 0 to the header's chunk_count - 1
  std::uint64_t first_vertex = 0, vertex_count = 0;
  std::uint64_t first_tet = 0, tet_count = 0;
  MeshColumns columns;
  std::uint64_t first_face = 0, face_count = 0;  ///< boundary faces of the chunk's tets
};

/// A whole mesh. Copies share it; it is never changed, so any thread may read it. Spans live as
/// long as one of the copies does.
class TETSTREAM_API Mesh {
 public:
  const MeshHeader& header() const noexcept;
  const MeshColumns& columns() const noexcept;
  const Statistics& statistics() const noexcept;

  std::size_t vertex_count() const noexcept { return columns().vertex_count(); }
  std::size_t tet_count() const noexcept { return columns().tet_count(); }
  /// World coordinates of a vertex.
  Point vertex(std::size_t i) const noexcept;
  std::array<std::uint64_t, 4> tet(std::size_t i) const noexcept { return columns().tet(i); }
  std::size_t face_count() const noexcept { return columns().face_count(); }

  struct Impl;
  explicit Mesh(std::shared_ptr<const Impl> impl);
  const Impl& impl() const noexcept { return *impl_; }

 private:
  std::shared_ptr<const Impl> impl_;
};

}  // namespace tetstream
