#include "core/mesh/stable/stable_mesh.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstring>
#include <new>
#include <span>
#include <utility>
#include <vector>

#include <absl/strings/str_format.h>

#include "core/base/parallel.h"
#include "core/mesh/stable/move_ids.h"

namespace tet {
namespace {

constexpr std::uint64_t kMostHoles = 8;  ///< one slot of so many
/// Runs are looked up for ids that are not of one or two of them.
constexpr std::uint64_t kTetsPerRun = 32, kFewRuns = 1024;
constexpr std::uint64_t kTetsPerPiece = std::uint64_t{1} << 14;

bool lies_in_order(const SlotLayout& layout) noexcept {
  return layout.runs().empty() || (layout.runs().size() == 1 && layout.runs()[0].slot == 0);
}

bool has_many_holes(const SlotLayout& layout, std::uint64_t next_count) noexcept {
  const std::uint64_t slots = layout.slots();
  return next_count < slots && slots - next_count > slots / kMostHoles;
}

void copy_rows(std::span<const std::byte> from,
               std::uint64_t from_row,
               std::span<std::byte> to,
               std::uint64_t to_row,
               std::uint64_t rows,
               std::size_t row_bytes) noexcept {
  if (rows * row_bytes == 0) return;
  std::memcpy(to.data() + to_row * row_bytes, from.data() + from_row * row_bytes,
              rows * row_bytes);
}

template <class Index>
std::span<const Index> ids_in(std::span<const std::byte> tets,
                              std::uint64_t first,
                              std::uint64_t count) noexcept {
  return {reinterpret_cast<const Index*>(tets.data()) + 4 * first, 4 * count};
}

template <class Index>
bool move_piece(const NewIds& ids, const TetMesh& from, const SlotRun& piece, TetMesh& to) {
  IdMover<Index> mover(ids);
  return move_blocks(mover, ids_in<Index>(from.tets.bytes(), piece.slot, piece.count),
                     reinterpret_cast<Index*>(to.tets.bytes().data()) + 4 * piece.first);
}

/// Runs of at most so many, for as many threads.
std::vector<SlotRun> pieces_of(const std::vector<SlotRun>& runs) {
  std::vector<SlotRun> pieces;
  for (const SlotRun& run : runs) {
    for (std::uint64_t at = 0; at < run.count; at += kTetsPerPiece) {
      pieces.push_back(
          {run.first + at, run.slot + at, std::min(kTetsPerPiece, run.count - at)});
    }
  }
  return pieces;
}

std::vector<SlotRange> all_of(const SlotLayout& layout) {
  if (layout.slots() == 0) return {};
  return {{0, layout.slots()}};
}

bool has_room(const TetMesh& mesh, const MeshHeader& header) noexcept {
  const ChunkSizes sizes(header, whole_of(header));
  return sizes.positions <= mesh.positions.capacity() && sizes.tets <= mesh.tets.capacity() &&
         sizes.regions <= mesh.regions.capacity() && sizes.fields <= mesh.fields.capacity() &&
         sizes.faces <= mesh.faces.capacity() && sizes.face_tets <= mesh.face_tets.capacity() &&
         sizes.face_labels <= mesh.face_labels.capacity();
}

void copy_bytes(const ByteBuffer& from, ByteBuffer& to) noexcept {
  std::ranges::copy(from.bytes(), to.bytes().begin());
}

absl::Status no_memory(const MeshHeader& header) {
  return absl::ResourceExhaustedError(absl::StrFormat("no memory for %d vertices and %d tets",
                                                      header.vertex_count, header.tet_count));
}

}  // namespace

absl::StatusOr<TetMesh> StableMesh::in_order() const {
  TetMesh mesh;
  try {
    mesh = TetMesh(header_);
  } catch (const std::bad_alloc&) {
    return no_memory(header_);
  }
  // Who has these came whole, in order.
  copy_bytes(mesh_->fields, mesh.fields);
  copy_bytes(mesh_->faces, mesh.faces);
  copy_bytes(mesh_->face_tets, mesh.face_tets);
  copy_bytes(mesh_->face_labels, mesh.face_labels);
  const std::size_t vertex_bytes = 3 * size_of(header_.coordinate_type);
  const std::vector<SlotRun> vertices = pieces_of(vertices_.runs()),
                             tets = pieces_of(tets_.runs());
  for_each_index(vertices.size(), [&](std::size_t i) {
    copy_rows(mesh_->positions.bytes(), vertices[i].slot, mesh.positions.bytes(),
              vertices[i].first, vertices[i].count, vertex_bytes);
  });
  const std::vector<KeptRun> numbers = vertices_.from_slots();
  const NewIds ids(numbers, vertices_.slots());
  std::atomic<bool> all_kept{true};
  for_each_index(tets.size(), [&](std::size_t i) {
    copy_rows(mesh_->regions.bytes(), tets[i].slot, mesh.regions.bytes(), tets[i].first,
              tets[i].count, header_.region_bytes());
    const bool moved = header_.index_type == IndexType::kUint32
                           ? move_piece<std::uint32_t>(ids, *mesh_, tets[i], mesh)
                           : move_piece<std::uint64_t>(ids, *mesh_, tets[i], mesh);
    if (!moved) all_kept = false;
  });
  if (!all_kept) return absl::InvalidArgumentError("a kept tet has a vertex that is not kept");
  return mesh;
}

absl::Status StableMesh::begin(const MeshHeader& header, const KeptParts* kept) {
  renumbered_ = false;
  SlotChange vertices, tets;
  if (kept != nullptr) {
    if (auto status = check_splice(header_, header, *kept); !status.ok()) return status;
    if (is_worn(header)) {
      if (auto status = put_in_order(); !status.ok()) return status;
    }
    vertices = vertices_.follow(kept->vertices, header.vertex_count);
    tets = tets_.follow(kept->tets, header.tet_count);
  } else {
    vertices_ = SlotLayout(header.vertex_count);
    tets_ = SlotLayout(header.tet_count);
    renumbered_ = true;
  }
  loose_ = kept != nullptr && kept->loose;
  header_ = header;
  if (auto status = make_room(kept != nullptr); !status.ok()) {
    vertices_ = tets_ = SlotLayout();
    header_ = MeshHeader();
    mesh_ = std::make_shared<TetMesh>();
    changed_vertices_ = changed_tets_ = {};
    return status;
  }
  clear(vertices.given_up, tets.given_up);
  changed_vertices_ = renumbered_ ? all_of(vertices_) : std::move(vertices.changed);
  changed_tets_ = renumbered_ ? all_of(tets_) : std::move(tets.changed);
  new_vertices_ = RowQueue(std::move(vertices.filled));
  new_tets_ = RowQueue(std::move(tets.filled));
  new_ids_ = vertices_.to_slots();
  ids_.emplace(new_ids_, header_.vertex_count);
  return absl::OkStatus();
}

/// Whether it has too many holes for a mesh of these totals, or lies in too many runs.
bool StableMesh::is_worn(const MeshHeader& header) const noexcept {
  const std::uint64_t most_runs = kFewRuns + tets_.count() / kTetsPerRun;
  return has_many_holes(vertices_, header.vertex_count) ||
         has_many_holes(tets_, header.tet_count) || vertices_.runs().size() > most_runs ||
         tets_.runs().size() > most_runs;
}

absl::Status StableMesh::put_in_order() {
  if (lies_in_order(vertices_) && lies_in_order(tets_) && vertices_.holes() == 0 &&
      tets_.holes() == 0) {
    return absl::OkStatus();
  }
  absl::StatusOr<TetMesh> mesh = in_order();
  if (!mesh.ok()) return mesh.status();
  mesh_ = std::make_shared<TetMesh>(*std::move(mesh));
  vertices_ = SlotLayout(header_.vertex_count);
  tets_ = SlotLayout(header_.tet_count);
  renumbered_ = true;
  return absl::OkStatus();
}

MeshHeader StableMesh::header_of(const Totals& slots) const {
  MeshHeader header = header_;
  header.vertex_count = slots.vertices;
  header.tet_count = slots.tets;
  return header;
}

/// Makes room for the slots that there are now: more than that where it has to be made at all.
absl::Status StableMesh::make_room(bool keeps) {
  const Totals slots{vertices_.slots(), tets_.slots()};
  try {
    if (!has_room(*mesh_, header_of(slots))) move_elsewhere(slots, keeps);
    *mesh_ = TetMesh(header_of(slots), std::move(*mesh_));
  } catch (const std::bad_alloc&) {
    return no_memory(header_of(slots));
  }
  return absl::OkStatus();
}

/// Other memory: this one's is freed as soon as nobody reads it.
void StableMesh::move_elsewhere(const Totals& slots, bool keeps) {
  const bool is_first = mesh_->tets.capacity() == 0;
  const std::shared_ptr<const TetMesh> before = keeps ? mesh_ : nullptr;
  mesh_ = nullptr;
  const Totals roomy{slots.vertices + slots.vertices / kMostHoles,
                     slots.tets + slots.tets / kMostHoles};
  mesh_ = std::make_shared<TetMesh>(header_of(is_first ? slots : roomy));
  if (!before) return;
  copy_bytes(before->positions, mesh_->positions);
  copy_bytes(before->tets, mesh_->tets);
  copy_bytes(before->regions, mesh_->regions);
}

/// What a slot has had is gone, whether or not it becomes another's.
void StableMesh::clear(const std::vector<SlotRange>& vertices,
                       const std::vector<SlotRange>& tets) noexcept {
  const auto zero = [](std::span<std::byte> column, const SlotRange& range, std::size_t row) {
    if (range.count * row == 0) return;
    std::memset(column.data() + range.begin * row, 0, range.count * row);
  };
  for (const SlotRange& range : vertices) {
    zero(mesh_->positions.bytes(), range, 3 * size_of(header_.coordinate_type));
  }
  for (const SlotRange& range : tets) {
    zero(mesh_->tets.bytes(), range, 4 * size_of(header_.index_type));
    zero(mesh_->regions.bytes(), range, header_.region_bytes());
  }
}

/// Whether chunks lie in memory as they come.
bool StableMesh::writes_in_order() const noexcept {
  return !loose_ && lies_in_order(vertices_) && lies_in_order(tets_);
}

ChunkColumns StableMesh::place(const ChunkExtent& chunk) {
  if (writes_in_order()) return mesh_->columns_of(chunk);
  chunk_ = TetMesh(header_of_chunk(header_, chunk), std::move(chunk_));
  return chunk_.columns();
}

/// Copies `count` vertices of the chunk, from `at` on, to their slots.
void StableMesh::put_vertices(std::uint64_t slot,
                              std::uint64_t at,
                              std::uint64_t count) noexcept {
  copy_rows(chunk_.positions.bytes(), at, mesh_->positions.bytes(), slot, count,
            3 * size_of(header_.coordinate_type));
}

/// Does that with tets, whose ids become slots; false where one is beyond the mesh.
bool StableMesh::put_tets(std::uint64_t slot, std::uint64_t at, std::uint64_t count) {
  copy_rows(chunk_.regions.bytes(), at, mesh_->regions.bytes(), slot, count,
            header_.region_bytes());
  const SlotRun piece{slot, at, count};
  return header_.index_type == IndexType::kUint32
             ? move_piece<std::uint32_t>(*ids_, chunk_, piece, *mesh_)
             : move_piece<std::uint64_t>(*ids_, chunk_, piece, *mesh_);
}

absl::Status StableMesh::take(const ChunkExtent& chunk) {
  if (writes_in_order()) return absl::OkStatus();
  bool all_there = true;
  const auto vertices = [&](std::uint64_t slot, std::uint64_t at, std::uint64_t count) {
    put_vertices(slot, at, count);
  };
  const auto tets = [&](std::uint64_t slot, std::uint64_t at, std::uint64_t count) {
    all_there = put_tets(slot, at, count) && all_there;
  };
  if (loose_) {
    if (!new_vertices_.take(chunk.vertex_count, vertices) ||
        !new_tets_.take(chunk.tet_count, tets)) {
      return absl::InvalidArgumentError("a chunk has more than what is new");
    }
  } else {
    vertices_.for_each_run(chunk.first_vertex, chunk.vertex_count, vertices);
    tets_.for_each_run(chunk.first_tet, chunk.tet_count, tets);
  }
  if (all_there) return absl::OkStatus();
  return absl::InvalidArgumentError("a tet has a vertex that the mesh has not");
}

}  // namespace tet
