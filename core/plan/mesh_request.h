// What a caller asks of the mesher, and its canonical form.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/quality_stats.h"
#include "core/mesh/tet_mesh.h"
#include "core/octree/sizing.h"
#include "core/plan/label_choice.h"
#include "core/plan/shape.h"
#include "core/plan/vertex_field.h"
#include "core/stuffing/stuffing_rules.h"

namespace tet {

/// Goes up whenever the bytes of some mesh may change, or of the statistics that are stored
/// with its chunks: part of what names a mesh.
inline constexpr char kAlgorithmVersion[] = "6";

/// Warp limits with known angle bounds; see docs/algorithm.md.
enum class Preset : std::uint8_t { kDefault, kMinAngle, kBothSides };

inline constexpr std::array kPresets{Preset::kDefault, Preset::kMinAngle, Preset::kBothSides};

/// Enough for every volume: leaves stop coarsening long before.
inline constexpr int kMaxLevels = 24;

/// What users get who name no number of levels: one, so that tets inside are at most twice as
/// long as those at the surface, and what is solved on the mesh converges as the spacing falls
/// (docs/sizing.md has the table). A sizing that bounds every leaf (`coarsest`, `growth`,
/// `grid`) is taken at its word: as many as it leaves.

int default_levels(const Sizing& sizing) noexcept;

struct MeshRequest {
  /// World units; unless given the grid's voxel size, or a scene's longest extent / 128.
  std::optional<double> spacing;
  std::optional<double> iso;  ///< of grids; unless given their default_iso
  /// The side of the iso value that is inside, of grids; what their classes say unless given.
  std::optional<InsideSide> inside = {};
  int levels = kMaxLevels;  ///< octree levels above the finest; 0 is the uniform mesh
  Preset preset = Preset::kDefault;
  /// World units, rounded outward (see domain.h): what is meshed of both sides, all that the
  /// grid stores or the scene reaches unless given; or what the inside is cut off at.
  std::optional<WorldBox> box;
  /// The boundary is a manifold whatever the field: nodes where it would touch itself are put
  /// back in their places.
  bool manifold = false;
  /// Stored positions are relative to the lattice corner next to it, world units; the middle of
  /// what is meshed unless given.
  std::optional<WorldPoint> origin;
  bool improve =
      false;  ///< move vertices to better the worst angles: core/mesh/improve/improve.h
  /// Neither the tets are measured nor the boundary's topology is counted: the same mesh,
  /// sooner.
  bool skip_statistics = false;
  /// The mesh has its boundary faces, too: see TetMesh.
  bool faces = false;
  /// Pieces of the surface with names of their own; only of a mesh that has faces.
  std::vector<FaceRegion> face_regions = {};
  /// The surface is held against that of phi, and tets are measured, beside other statistics:
  /// core/fidelity. Only of a mesh that has faces.
  bool fidelity = false;
  /// A segmentation is meshed, all of its labels in one conforming mesh.
  std::optional<LabelChoice> labels = {};
  Sizing sizing;                         ///< of leaves away from the surface
  std::vector<VertexField> fields = {};  ///< whose values the vertices get, in this order
  /// float32 unless given, and float64 where float32 would bend the angle bounds.
  std::optional<CoordinateType> coordinates;
  /// uint32 unless given, and uint64 where there are more vertices than that can count.
  std::optional<IndexType> indices;
};

Statistics statistics_of(const MeshRequest& request);

/// Makes it ask for no more than has the same counts: to know the rest, the mesh would be made.
void ask_for_counts(MeshRequest& request);

/// Whether the inside ends at the request's box, with faces that are flat.
bool has_cut(const MeshRequest& request);

/// Whether the mesh is made as a whole while it is planned, by core/graded.
bool is_made_whole(const MeshRequest& request);

/// The labels of the faces that a request asks for, and its regions, behind the header's
/// has_regions; `in_box` where faces may lie in those of a box.
void set_face_labels(const MeshRequest& request, bool in_box, MeshHeader& header);

/// What ids of a mesh that is counted are stored as; numbers of tets, where it has faces, are
/// stored as they are.
IndexType index_type_of(const MeshHeader& header, const MeshRequest& request) noexcept;

/// The arrays of a mesh: those of the request's fields, which are loaded, then that of a cut.
std::vector<FieldArray> arrays_of(const MeshRequest& request);

/// A chunk's columns are cut to stay within this many bytes together, the size that travels
/// best: gRPC writes a message of more than 1 MiB in two pieces, which takes twice as long, and
/// the sender's, the kernel's and the reader's copy of half of that stay in a core's L2 cache.
inline constexpr std::size_t kChunkBytes = std::size_t{1} << 19;

/// Budget of one mesh; a request over it is refused before anything is allocated for it.
struct MeshLimits {
  std::uint64_t max_tets = 4'000'000'000;
  /// Memory for what is kept of the bricks near the surface while the mesh is counted and made;
  /// and, while it is improved for a plan, for the mesh.
  std::uint64_t max_plan_bytes = std::uint64_t{4} << 30;
  /// Cut points and warps that are kept from counting a mesh until it is made, bytes: about a
  /// tenth of the mesh. What does not fit is found again when it is filled.
  std::uint64_t kept_geometry_bytes = std::uint64_t{1} << 30;
  /// Not kChunkBytes in tests only: where a mesh is cut into chunks must not change it.
  std::size_t chunk_bytes = kChunkBytes;
};

/// A request with every default filled in.
struct CanonicalRequest {
  double spacing = 0;  ///< world units
  double iso = 0;
  InsideSide inside = InsideSide::kBelow;  ///< of a grid
  int levels = 0;                          ///< that the sizing leaves
  Preset preset = Preset::kDefault;
};

/// What a request without them means. No spacing is 0: a scene without an end has none.
double default_spacing(const Shape& shape);
double default_iso(const Shape& shape, const MeshRequest& request);

/// Errors: kInvalidArgument, naming the field, its value and its limit.
absl::StatusOr<CanonicalRequest> canonical(const MeshRequest& request, const Shape& shape);

StuffingRules stuffing_rules(Preset preset);

/// What every dihedral angle of a preset's meshes lies between, in degrees.
struct AngleBounds {
  double min_deg = 0, max_deg = 180;
};

/// Proven by tests/certificate: see docs/bounds.md. As float64 positions are the mesher's own;
/// as float32 they are rounded, at most 4096 spacings from their origin.
AngleBounds angle_bounds(Preset preset, CoordinateType coordinates);

/// `levels` of a request that names none. Labels with sizes are taken at their word, too.
int default_levels(const MeshRequest& request) noexcept;

std::optional<Preset> parse_preset(std::string_view name);
std::string_view preset_name(Preset preset);

}  // namespace tet
