// A mesh that follows its shape in place: what is kept of it keeps its ids.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/mesh/stable/move_ids.h"
#include "core/mesh/stable/row_queue.h"
#include "core/mesh/stable/slot_layout.h"
#include "core/mesh/stable/splice.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Columns in which every vertex and every tet has a slot, which is its id for as long as it is
/// kept from one mesh to the next. New ones fill the slots of those that are gone; what is left
/// over is a hole: a vertex at the origin that no tet has, and a tet of four times vertex 0.
///
/// The bytes are a function of the meshes that it has followed and of what was kept from each
/// to the next, in their order. Not thread-safe.
class StableMesh {
 public:
  StableMesh() = default;
  StableMesh(const StableMesh&) = delete;
  StableMesh& operator=(const StableMesh&) = delete;

  /// The columns by slot; the totals of its header are numbers of slots.
  const TetMesh& slots() const noexcept { return *mesh_; }
  /// What keeps the memory of these columns for a reader that may outlive them. Whoever holds
  /// it sees what becomes of them, or what was there before they moved elsewhere: a next mesh
  /// is written to the same memory where that has room.
  std::shared_ptr<const TetMesh> memory() const noexcept { return mesh_; }
  /// The header of the mesh as it is in its own order.
  const MeshHeader& header() const noexcept { return header_; }
  /// Which slot each vertex and each tet has.
  const SlotLayout& vertices() const noexcept { return vertices_; }
  const SlotLayout& tets() const noexcept { return tets_; }
  /// Whether the last `begin` gave every vertex and tet the slot of its own number.
  bool renumbered() const noexcept { return renumbered_; }
  /// Slots that are not what they were before the last `begin`, empty ones with them: where it
  /// renumbered, all. Sorted, apart from each other.
  const std::vector<SlotRange>& changed_vertices() const noexcept { return changed_vertices_; }
  const std::vector<SlotRange>& changed_tets() const noexcept { return changed_tets_; }

  /// The mesh in its own order, byte for byte the one that is made as a whole. Parallel; run it
  /// on a TaskPool. Errors: kInvalidArgument (a kept tet has a vertex that is not kept),
  /// kResourceExhausted (no memory).
  absl::StatusOr<TetMesh> in_order() const;

  /// Begins the next mesh, which keeps `kept` of this one, or nothing where that is null. Where
  /// holes are more than an eighth, or runs many, this one is first put in order. Then all that
  /// is not kept comes chunk by chunk. Parallel; run it on a TaskPool. Errors: those of
  /// check_splice, and of in_order; then everything is as it was, but in order perhaps. Where
  /// there is no memory for the next mesh (kResourceExhausted), nothing is left of this one.
  absl::Status begin(const MeshHeader& header, const KeptParts* kept);
  /// Where the columns of a chunk are to be written; its ids are those of the mesh in its own
  /// order, all of them below `header().vertex_count`. Where nothing is kept, the columns of
  /// all chunks are apart from each other and final, so that any thread may write its own; else
  /// they are valid until the next call, and wait for `take`.
  ChunkColumns place(const ChunkExtent& chunk);
  /// The chunk has been written; those of kept parts that are loose in their order. Errors:
  /// kInvalidArgument (an id beyond the mesh; a loose chunk with more than is new).
  absl::Status take(const ChunkExtent& chunk);

 private:
  struct Totals {
    std::uint64_t vertices = 0, tets = 0;
  };

  bool writes_in_order() const noexcept;
  void put_vertices(std::uint64_t slot, std::uint64_t at, std::uint64_t count) noexcept;
  bool put_tets(std::uint64_t slot, std::uint64_t at, std::uint64_t count);
  bool is_worn(const MeshHeader& header) const noexcept;
  absl::Status put_in_order();
  absl::Status make_room(bool keeps);
  void move_elsewhere(const Totals& slots, bool keeps);
  MeshHeader header_of(const Totals& slots) const;
  void clear(const std::vector<SlotRange>& vertices,
             const std::vector<SlotRange>& tets) noexcept;

  MeshHeader header_;
  std::shared_ptr<TetMesh> mesh_ = std::make_shared<TetMesh>();
  SlotLayout vertices_, tets_;
  std::vector<SlotRange> changed_vertices_, changed_tets_;
  std::vector<KeptRun> new_ids_;  ///< of vertices, by their numbers
  std::optional<NewIds> ids_;     ///< refers to those
  TetMesh chunk_;                 ///< one that is being received, where slots are no numbers
  RowQueue new_vertices_, new_tets_;  ///< slots, where kept parts are loose
  bool loose_ = false;
  bool renumbered_ = false;
};

}  // namespace tet
