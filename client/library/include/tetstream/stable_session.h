// Meshes that follow their shapes under ids that do not move, patched in place.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "tetstream/export.h"
#include "tetstream/mesh.h"
#include "tetstream/request.h"
#include "tetstream/scene.h"
#include "tetstream/status.h"
#include "tetstream/volume.h"

namespace tetstream {

/// Slots from `begin` on, up to but without `end`.
struct SlotRange {
  std::uint64_t begin = 0, end = 0;
  friend bool operator==(const SlotRange&, const SlotRange&) = default;
};

/// Samples (i, j, k) of a volume with begin <= (i, j, k) < end along each axis: of one made of
/// an array its own numbers, and of a file those of OpenVDB's index space.
struct SampleBox {
  std::array<std::int32_t, 3> begin{}, end{};
};

/// A mesh by slots. A vertex or a tet that is kept from one frame to the next keeps its slot,
/// which is its id; new ones get the lowest that are empty. Lists of ranges are sorted, and
/// their ranges are apart from each other.
///
/// Spans are valid until the next update, which writes to the same memory, and until the
/// session is gone; whoever has to read them for longer holds `memory`.
struct StableMesh {
  /// The mesh in its own order: its totals count vertices and tets, and not slots.
  MeshHeader header;
  /// Arrays with a row for each slot: `columns.vertex_count()` and `columns.tet_count()` are
  /// numbers of slots. In an empty slot a vertex lies at the origin and belongs to no tet, and
  /// a tet is four times vertex 0, of volume 0, with region 0.
  MeshColumns columns;
  std::vector<SlotRange> empty_vertices, empty_tets;
  /// Slots that have another vertex or tet than in the frame before, or none any more: all that
  /// has to be read again. With the first frame, and where it is renumbered, all of them.
  std::vector<SlotRange> changed_vertices, changed_tets;
  /// Every vertex and tet has the id that it has in the mesh's own order, whatever it had
  /// before: in the first frame, where less than a sixteenth could be kept, where more than an
  /// eighth of the slots would be empty, and where the mesh would lie in too many runs of
  /// slots.
  bool renumbered = false;
  /// Keeps the memory of `columns`, whatever an update makes of what is there. An update that
  /// needs more room, or puts the mesh in order because of holes or runs, moves the columns
  /// elsewhere and leaves this as it was.
  std::shared_ptr<const void> memory;
};

/// A session whose mesh is patched in place: an update takes time in proportion to what is new,
/// and copies nothing else. Its ids depend on all of its frames in their order, and on nothing
/// else; they are the same here and on a server of the same version. `in_order` is the mesh
/// that `Session` has.
///
/// A frame that cannot be meshed leaves the mesh as it was, and the next may fare better. After
/// any other failure, of the connection for instance, the session is over, and its mesh is
/// empty, with `memory` null: begin another.
///
/// Not thread-safe. The options that it began with watch and stop all of it.
class TETSTREAM_API StableSession {
 public:
  const StableMesh& mesh() const noexcept;

  /// The mesh in its own order: another one, in memory of its own, byte for byte the one that
  /// is made as a whole. Takes time in proportion to all of it. Errors: kFailedPrecondition (a
  /// failure has ended the session), kResourceExhausted (no memory), kInvalidArgument (the
  /// server said that it keeps a tet, and not its vertices).
  Result<Mesh> in_order() const;

  /// The mesh becomes that of another volume, or scene. Errors: those of Session::update.
  Status update(const Volume& volume);
  Status update(const Scene& scene);
  /// Says where a volume may have samples that the one before it, of the frame that was taken
  /// last, has not: in `replaced`, and nowhere else. Then the two are not compared, which is a
  /// part of an update's time; boxes that are too large, or too many, do no harm.
  ///
  /// A list that leaves out what has changed is refused with kInvalidArgument, and the frame
  /// with it, where it is noticed: other samples in the blocks of 8 x 8 x 8 samples (from
  /// multiples of 8 on) around those that the boxes touch; further away, blocks whose least or
  /// greatest sample is another, or that were constant and are no longer, or have another
  /// constant. That nothing else has changed there is the caller's word: of a block far from
  /// all boxes whose samples change between the same bounds, the mesh would stay what it was.
  /// Volumes that are laid out differently (their place, background, or constants far from
  /// everything) are compared in full. Errors also: kInvalidArgument (a box that ends before it
  /// begins, or lies beyond all samples), those of `update` of a volume alone.
  Status update(const Volume& volume, std::span<const SampleBox> replaced);

  /// Tets of the last frame that were made here or sent by the server; the others were kept.
  std::uint64_t tets_sent() const noexcept;
  /// Whether it takes no more frames.
  bool is_over() const noexcept;
  /// Tells the server that this was all; the mesh stays. Errors: what the session ended with.
  Status end();

  ~StableSession();
  StableSession(StableSession&&) noexcept;
  StableSession& operator=(StableSession&&) noexcept;

  struct Impl;
  explicit StableSession(std::unique_ptr<Impl> impl);

 private:
  std::unique_ptr<Impl> impl_;
};

/// Begins a session in this process, which makes again what differs from the frame before.
/// Errors: those of mesh.
TETSTREAM_API Result<StableSession> begin_stable_session(const Volume& volume,
                                                         const Request& request = {},
                                                         const WorkOptions& options = {});
TETSTREAM_API Result<StableSession> begin_stable_session(const Scene& scene,
                                                         const Request& request = {},
                                                         const WorkOptions& options = {});

}  // namespace tetstream
