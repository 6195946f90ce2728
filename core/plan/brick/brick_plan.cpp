#include "core/plan/brick/brick_plan.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <utility>

#include "core/base/check.h"
#include "core/base/heap_bytes.h"
#include "core/plan/brick/fill_brick.h"
#include "core/plan/brick/new_parts.h"
#include "core/plan/creased_plan.h"
#include "core/plan/fill_watch.h"
#include "core/plan/improved_plan.h"
#include "core/plan/mesh_workspace.h"

namespace tet {
namespace {

/// What of some bricks' columns belongs to the first of them; without fields.
ChunkColumns first_of(const ChunkColumns& columns, const ChunkSizes& size) noexcept {
  return {.positions = columns.positions.first(size.positions),
          .tets = columns.tets.first(size.tets),
          .regions = columns.regions.first(size.regions),
          .faces = columns.faces.first(size.faces),
          .face_tets = columns.face_tets.first(size.face_tets),
          .face_labels = columns.face_labels.first(size.face_labels)};
}

/// The rest.
ChunkColumns after(const ChunkColumns& columns, const ChunkSizes& size) noexcept {
  return {.positions = columns.positions.subspan(size.positions),
          .tets = columns.tets.subspan(size.tets),
          .regions = columns.regions.subspan(size.regions),
          .faces = columns.faces.subspan(size.faces),
          .face_tets = columns.face_tets.subspan(size.face_tets),
          .face_labels = columns.face_labels.subspan(size.face_labels)};
}

/// All vertices of one brick: as many as it can own.
struct WholeVertices {
  static constexpr std::size_t kMost = OwnPlaces::kMax;
  std::array<std::byte, kMost * 3 * sizeof(double)> positions;
};

/// Copies the rows that are new.
void copy_new_rows(const NewNumbers& numbers,
                   const ChunkExtent& whole,
                   std::span<const std::byte> from,
                   std::span<std::byte> to,
                   std::size_t row_bytes) noexcept {
  numbers.for_each_run(whole.first_vertex, whole.vertex_count,
                       [&](std::uint64_t at, std::uint64_t count) {
                         const std::size_t bytes = count * row_bytes;
                         std::ranges::copy(from.subspan(at * row_bytes, bytes), to.begin());
                         to = to.subspan(bytes);
                       });
  TET_CHECK(to.empty());
}

}  // namespace

BrickPlan::BrickPlan(MeshFacts facts,
                     MeshSource source,
                     CountedMesh mesh,
                     std::vector<std::size_t> first_brick)
    : LatticePlan(std::move(facts), std::move(source)),
      mesh_(std::move(mesh)),
      first_brick_(std::move(first_brick)) {}

BrickRange BrickPlan::bricks_of_chunk(std::uint64_t index) const noexcept {
  return {first_brick_[index], first_brick_[index + 1]};
}

ChunkExtent BrickPlan::bricks(const BrickRange& range) const noexcept {
  return mesh_.extent(range);
}

QualityStats BrickPlan::fill_bricks(const BrickRange& range,
                                    MeshWorkspace& workspace,
                                    ChunkColumns columns) const noexcept {
  BrickFiller filler(mesh_, field(), header(), to_world(), statistics(),
                     workspace.get<BrickScratch>());
  const FillWatch& watch = workspace.get<FillWatch>();
  filler.stop_when(watch.cancellation());
  for (std::size_t brick = range.begin; brick < range.end; ++brick) {
    if (watch.stops()) return {};
    const ChunkExtent extent = bricks({brick, brick + 1});
    const ChunkSizes size(header(), extent);
    filler.fill(brick, first_of(columns, size));
    columns = after(columns, size);
  }
  TET_CHECK(columns.positions.empty() && columns.tets.empty() && columns.regions.empty());
  return filler.stats();
}

QualityStats BrickPlan::fill_new(const BrickRange& range,
                                 const NewParts& parts,
                                 MeshWorkspace& workspace,
                                 ChunkColumns columns) const noexcept {
  BrickFiller filler(mesh_, field(), header(), to_world(), statistics(),
                     workspace.get<BrickScratch>());
  const FillWatch& watch = workspace.get<FillWatch>();
  filler.stop_when(watch.cancellation());
  auto& scratch = workspace.get<WholeVertices>();
  for (std::size_t brick = range.begin; brick < range.end; ++brick) {
    if (watch.stops()) return {};
    const ChunkExtent whole = bricks({brick, brick + 1});
    const ChunkExtent extent = parts.within(whole);
    if (extent.vertex_count == 0 && extent.tet_count == 0) continue;
    const ChunkSizes size(header(), extent);
    ChunkColumns own = first_of(columns, size);
    const std::span<std::byte> positions = own.positions;
    const bool has_all = extent.vertex_count == whole.vertex_count;
    if (!has_all) {
      own.positions = std::span(scratch.positions).first(ChunkSizes(header(), whole).positions);
    }
    filler.fill(brick, own, parts.cells(brick));
    if (!has_all) {
      copy_new_rows(parts.vertices(), whole, own.positions, positions,
                    3 * size_of(header().coordinate_type));
    }
    columns = after(columns, size);
  }
  TET_CHECK(columns.positions.empty() && columns.tets.empty() && columns.regions.empty());
  return filler.stats();
}

ChunkExtent BrickPlan::chunk(std::uint64_t index) const noexcept {
  return bricks(bricks_of_chunk(index));
}

QualityStats BrickPlan::fill_chunk(std::uint64_t index,
                                   MeshWorkspace& workspace,
                                   ChunkColumns columns) const noexcept {
  const QualityStats stats = fill_bricks(bricks_of_chunk(index), workspace, columns);
  if (workspace.get<FillWatch>().stops()) return {};  // not all vertices have places
  if (!columns.fields.empty()) fill_fields(chunk(index), columns);
  return stats;
}

std::uint64_t BrickPlan::bytes() const noexcept {
  return mesh_.bytes() + heap_bytes(first_brick_);
}

std::vector<std::size_t> cut_into_chunks(const CountedMesh& mesh,
                                         std::size_t chunk_bytes,
                                         MeshHeader& header) {
  const auto bytes_before = [&](std::size_t brick) {
    return ChunkSizes(header, mesh.first_vertex(brick), mesh.first_tet(brick),
                      mesh.first_face(brick))
        .total();
  };
  std::vector<std::size_t> first_brick{0};
  for (std::size_t brick = 0; brick < mesh.brick_count(); ++brick) {
    const bool fits = bytes_before(brick + 1) - bytes_before(first_brick.back()) <= chunk_bytes;
    if (!fits && brick > first_brick.back()) first_brick.push_back(brick);
  }
  first_brick.push_back(mesh.brick_count());
  header.chunk_count = first_brick.size() - 1;
  return first_brick;
}

const BrickPlan* as_bricks(const MeshPlan& plan) noexcept {
  return dynamic_cast<const BrickPlan*>(&plan);
}

std::shared_ptr<const BrickPlan> as_bricks(
    const std::shared_ptr<const MeshPlan>& plan) noexcept {
  return std::dynamic_pointer_cast<const BrickPlan>(plan);
}

const BrickPlan* bricks_beneath(const MeshPlan& plan) noexcept {
  if (const auto* creased = dynamic_cast<const CreasedPlan*>(&plan)) {
    return bricks_beneath(creased->undivided());
  }
  const auto* improved = dynamic_cast<const ImprovedPlan*>(&plan);
  return as_bricks(improved != nullptr ? improved->unimproved() : plan);
}

}  // namespace tet
