// The second pass: every vertex and tet counted, brick by brick, and given its place.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/lattice/background.h"
#include "core/lattice/node_numbers.h"
#include "core/mesh/tet_mesh.h"
#include "core/octree/octree.h"
#include "core/plan/brick/kept_bricks.h"
#include "core/plan/brick/survey.h"
#include "core/stuffing/cell_nodes.h"
#include "core/stuffing/domain_faces.h"
#include "core/stuffing/local_vertices.h"
#include "core/stuffing/stuffed_brick.h"

namespace tet {

class CountedMesh;

/// A brick of the mesh: its octree level and its place among that level's bricks.
struct BrickPlace {
  int level = 0;
  std::size_t brick = 0;
};

/// Where a finest brick's signs are: which of the surveyed ones it is, or one of these.
inline constexpr std::uint32_t kAllOutside = ~std::uint32_t{0};
inline constexpr std::uint32_t kAllInside = kAllOutside - 1;

/// A counted mesh and the field that it was counted from.
struct ComparedMesh {
  const CountedMesh& mesh;
  const PhiField& field;
};

/// Bricks of a mesh in the order of ids, the last one excluded.
struct BrickRange {
  std::size_t begin = 0, end = 0;
};

/// What a mesh is counted from here.
struct SurveyedMesh {
  const PhiField& field;
  Survey survey;
  Octree tree;
  StuffingRules rules = {};
  bool uniform = false;   ///< all leaves are finest
  bool faces = false;     ///< those of the boundary are counted, too
  bool complete = false;  ///< every brick that owns a corner is in the tree already
  /// What this mesh, which may be null, counted is not counted again: it has the same rules and
  /// the same lattice.
  const ComparedMesh* earlier = nullptr;
};

/// What a mesh is counted from that was surveyed elsewhere.
struct MeshStructure {
  Octree tree;                         ///< with every brick that owns a corner
  std::vector<std::uint32_t> stuffed;  ///< where the signs of each finest brick are
  Survey survey;
};

/// The octree with the vertices and tets of each brick, finest level first: a mesh but for its
/// bytes.
class CountedMesh {
 public:
  /// The mesh is of no use once it is cancelled.
  explicit CountedMesh(SurveyedMesh surveyed, const Cancellation& cancellation = {});

  /// The kept geometry of `structure` has only cut points that tets use.
  /// Counts the faces of the boundary, too, if they are wanted.
  CountedMesh(MeshStructure structure, const StuffingRules& rules, bool faces = false);

  const StuffingRules& rules() const noexcept { return rules_; }
  const RestoredNodes* restored() const noexcept { return survey_.restored.get(); }
  /// What is meshed, in the order in which a brick's tets come.
  std::span<const MeshRegion> regions() const noexcept;

  const Octree& tree() const noexcept { return tree_; }
  const LevelNodes& nodes(int level) const noexcept {
    return nodes_[static_cast<std::size_t>(level)];
  }
  NodeNumbers numbers() const noexcept { return {tree_, nodes_}; }

  std::size_t brick_count() const noexcept { return first_vertex_.size() - 1; }
  BrickPlace place(std::size_t brick) const noexcept;
  /// The number of a level's first brick.
  std::size_t first_brick(int level) const noexcept {
    return first_brick_[static_cast<std::size_t>(level)];
  }
  std::uint64_t first_vertex(std::size_t brick) const noexcept { return first_vertex_[brick]; }
  std::uint64_t first_tet(std::size_t brick) const noexcept { return first_tet_[brick]; }

  /// 0 unless faces were counted.
  std::uint64_t first_face(std::size_t brick) const noexcept {
    return first_face_.empty() ? 0 : first_face_[brick];
  }
  /// A brick's cells at the domain's end; none where the mesh has no domain. They are known
  /// once faces were counted.
  OuterCells outer(BrickPlace place) const noexcept;
  /// Where some bricks lie in the mesh.
  ChunkExtent extent(const BrickRange& bricks) const noexcept;
  /// What the survey kept of the bricks around a finest one.
  BrickSurroundings surroundings(const PlacesAround& around) const noexcept;

  /// A finest brick and those beyond its upper faces, with what the survey kept of each.
  BrickNeighbourhood neighbourhood(std::size_t brick) const noexcept;
  /// The vertices of these bricks; `geometry` is null where it was not kept.
  VerticesAround vertices_around(std::size_t brick) const noexcept;
  /// Those of one finest brick.
  OwnedVertices vertices_of_finest(std::size_t brick) const noexcept;
  /// Answers the same for a finest brick whose neighbours are known.
  VerticesAround vertices_around(const PlacesAround& places) const noexcept;
  /// What the survey kept of a finest brick: see MeshStructure::stuffed.
  std::uint32_t stuffed(std::size_t brick) const noexcept { return stuffed_[brick]; }
  const Survey& survey() const noexcept { return survey_; }
  /// What it keeps of an earlier mesh by find_kept_bricks; null unless it was counted after it.
  const std::vector<KeptBricks>* kept_of(const CountedMesh& earlier) const noexcept {
    return earlier.serial_ == earlier_serial_ ? &kept_ : nullptr;
  }
  /// Memory it takes.
  std::uint64_t bytes() const noexcept;

  /// True when a finest brick has warped nodes or cut points in reach.
  bool touches_surface(std::size_t brick) const noexcept;

 private:
  const StuffedBrick* stuffed_at(std::uint32_t place) const noexcept;
  void find_stuffed(const PhiField& field, const Cancellation& cancellation);
  /// `earlier` may be null; `unchanged` has the places there of the bricks that own the same.
  void find_vertices(const CountedMesh* earlier,
                     std::span<const BrickPlaces> unchanged,
                     const Cancellation& cancellation);
  void find_finest_vertices(const KnownNodes& known, const Cancellation& cancellation);
  NodeMasks find_vertices_inside(std::size_t brick, const PlacesAround& around) const;
  NodeMasks find_vertices_of_both_sides(std::size_t brick, const PlacesAround& around);
  void trim_cut_points(std::uint32_t stuffed, const UsedByTets& used);
  void find_cut_points();
  /// `earlier` may be null, and has the bricks in `kept`.
  void count_bricks(const Cancellation& cancellation,
                    const CountedMesh* earlier,
                    std::span<const KeptBricks> kept);
  std::uint64_t vertices_of(BrickPlace place) const noexcept;
  /// Tets of a brick, and their faces if those are counted.
  struct BrickCounts {
    std::uint64_t tets = 0, faces = 0;
  };
  BrickCounts counts_of(BrickPlace place, const PlacesAround& around) const noexcept;
  BrickCounts finest_counts_of(std::size_t brick, const PlacesAround& around) const noexcept;
  BrickCounts count_with_faces(std::size_t brick,
                               const PlacesAround& around,
                               bool at_surface,
                               CellNodes& nodes) const noexcept;
  void find_domain();
  static std::uint64_t next_serial() noexcept;

  StuffingRules rules_;
  bool has_faces_ = false;
  bool geometry_is_trimmed_ = false;  ///< packed after cut points that no tet uses were dropped
  Survey survey_;
  Octree tree_;
  StuffedBrick all_inside_ = StuffedBrick::all_inside();
  std::vector<std::uint32_t> stuffed_;  // of each finest brick: in survey_, or one of the above
  std::vector<LevelNodes> nodes_;
  std::vector<std::size_t> first_brick_;                 // of each level
  std::vector<std::uint64_t> first_vertex_, first_tet_;  // one more than bricks: totals
  std::vector<std::uint64_t> first_face_;                // the same, or empty
  /// Different from that of every other mesh of the process; names them where they may be gone.
  std::uint64_t serial_ = next_serial();
  std::uint64_t earlier_serial_ = 0;  ///< of the mesh that it was counted after; 0: of none
  std::vector<KeptBricks> kept_;      ///< of that one
  CellBox domain_;                    // of all leaves, where it is needed
};

}  // namespace tet
