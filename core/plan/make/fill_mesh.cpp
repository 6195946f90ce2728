#include "core/plan/make/fill_mesh.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <mutex>
#include <utility>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/scratch_pool.h"
#include "core/plan/brick/brick_plan.h"
#include "core/plan/brick/fill_brick.h"
#include "core/plan/fill_watch.h"
#include "core/plan/mesh_workspace.h"

namespace tet {
namespace {

QualityStats sum_of(const std::vector<QualityStats>& chunks) {
  QualityStats sum;
  for (const QualityStats& chunk : chunks) sum.add(chunk);
  return sum;
}

/// What one thread fills at a time: a run of a chunk's bricks where a chunk is made of bricks
/// alone, and a chunk otherwise. There are often few chunks for many threads.
struct PartOfChunk {
  std::uint64_t chunk = 0;
  BrickRange bricks = {};
};

/// What whoever takes a mesh gets at a time: parts that follow each other, of about so many
/// bytes. Files are written faster in large pieces; the memory of each thread stays small.
constexpr std::size_t kBatchBytes = std::size_t{1} << 20;

/// Fills a mesh part by part.
class PartFiller {
 public:
  PartFiller(const MeshPlan& plan, bool with_fields)
      : plan_(plan), bricks_(with_fields ? nullptr : as_bricks(plan)) {}

  std::vector<PartOfChunk> parts() const {
    std::vector<PartOfChunk> parts;
    for (std::uint64_t chunk = 0; chunk < plan_.header().chunk_count; ++chunk) {
      bricks_ == nullptr ? parts.push_back({chunk}) : add_runs(chunk, parts);
    }
    return parts;
  }

  ChunkExtent place(const PartOfChunk& part) const {
    return bricks_ == nullptr ? plan_.chunk(part.chunk) : bricks_->bricks(part.bricks);
  }

  /// `columns` are as large as the part.
  QualityStats fill(const PartOfChunk& part,
                    MeshWorkspace& workspace,
                    const ChunkColumns& columns) const {
    return bricks_ == nullptr ? plan_.fill_chunk(part.chunk, workspace, columns)
                              : bricks_->fill_bricks(part.bricks, workspace, columns);
  }

 private:
  void add_runs(std::uint64_t chunk, std::vector<PartOfChunk>& parts) const {
    const auto [begin, end] = bricks_->bricks_of_chunk(chunk);
    for (std::size_t brick = begin; brick < end; brick += kBricksPerRun) {
      parts.push_back({chunk, {brick, std::min(end, brick + kBricksPerRun)}});
    }
  }

  const MeshPlan& plan_;
  const BrickPlan* const bricks_;  // null where chunks are filled whole
};

/// The sums of chunks, as each says of itself, one after the other.
QualityStats sum_of(const std::vector<PartOfChunk>& parts,
                    const std::vector<QualityStats>& stats) {
  QualityStats sum, of_chunk;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    of_chunk.add(stats[i]);
    if (i + 1 < parts.size() && parts[i + 1].chunk == parts[i].chunk) continue;
    sum.add(std::exchange(of_chunk, {}));
  }
  return sum;
}

/// Calls `make(i, workspace)` for each i below `count`, in any order, until it is cancelled.
template <class Make>
void for_each_work(std::size_t count,
                   const Cancellation& cancellation,
                   const ProgressFunction& progress,
                   const Make& make) {
  ScratchPool<MeshWorkspace> workspaces;
  std::atomic<std::uint64_t> done{0};
  for_each_range(count, 1, [&](std::size_t begin, std::size_t end) {
    ScratchPool<MeshWorkspace>::Turn workspace(workspaces);
    const WatchedFill watched(*workspace, cancellation);
    for (std::size_t i = begin; i < end && !cancellation.requested(); ++i) {
      make(i, *workspace);
      if (progress) progress(static_cast<double>(++done) / static_cast<double>(count));
    }
  });
}

/// Where the batches of some parts begin, and one more.
std::vector<std::size_t> first_of_batches(const PartFiller& filler,
                                          const std::vector<PartOfChunk>& parts,
                                          const MeshHeader& header) {
  std::vector<std::size_t> first;
  std::size_t bytes = kBatchBytes;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (bytes >= kBatchBytes) {
      first.push_back(i);
      bytes = 0;
    }
    bytes += ChunkSizes(header, filler.place(parts[i])).total();
  }
  first.push_back(parts.size());
  return first;
}

/// Two places that follow each other, as one.
ChunkExtent joined(const ChunkExtent& a, const ChunkExtent& b) noexcept {
  return {a.first_vertex, b.first_vertex + b.vertex_count - a.first_vertex,
          a.first_tet,    b.first_tet + b.tet_count - a.first_tet,
          a.first_face,   b.first_face + b.face_count - a.first_face};
}

/// A place as it is counted from the begin of another.
ChunkExtent within(const ChunkExtent& place, const ChunkExtent& all) noexcept {
  ChunkExtent within = place;
  within.first_vertex -= all.first_vertex;
  within.first_tet -= all.first_tet;
  within.first_face -= all.first_face;
  return within;
}

/// The first error of several threads.
class FirstError {
 public:
  bool is_set() const noexcept { return is_set_; }
  void set(absl::Status status) {
    const std::lock_guard lock(mutex_);
    if (!is_set_.exchange(true)) status_ = std::move(status);
  }
  /// Once all threads are done.
  const absl::Status& status() const noexcept { return status_; }

 private:
  std::mutex mutex_;
  std::atomic<bool> is_set_{false};
  absl::Status status_;
};

}  // namespace

absl::StatusOr<FilledMesh> fill_mesh(const MeshPlan& plan,
                                     const Cancellation& cancellation,
                                     const ProgressFunction& progress,
                                     TetMesh used,
                                     FieldValues fields) {
  MeshHeader header = plan.header();
  if (fields == FieldValues::kLater) header.fields.clear();
  TetMesh mesh(header, std::move(used));
  const PartFiller filler(plan, !mesh.header.fields.empty());
  const std::vector<PartOfChunk> parts = filler.parts();
  std::vector<QualityStats> stats(parts.size());
  for_each_work(
      parts.size(), cancellation, progress, [&](std::size_t i, MeshWorkspace& workspace) {
        stats[i] = filler.fill(parts[i], workspace, mesh.columns_of(filler.place(parts[i])));
      });
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  return FilledMesh{std::move(mesh), sum_of(parts, stats)};
}

absl::StatusOr<QualityStats> fill_parts(const MeshPlan& plan,
                                        const Cancellation& cancellation,
                                        const ProgressFunction& progress,
                                        const TakePart& take) {
  const MeshHeader& header = plan.header();
  const PartFiller filler(plan, !header.fields.empty());
  const std::vector<PartOfChunk> parts = filler.parts();
  const std::vector<std::size_t> first = first_of_batches(filler, parts, header);
  std::vector<QualityStats> stats(parts.size());
  const auto place_of = [&](std::size_t batch) {
    return joined(filler.place(parts[first[batch]]), filler.place(parts[first[batch + 1] - 1]));
  };
  // Memory that is large enough at once need not grow, which would touch new pages.
  ChunkExtent most;
  for (std::size_t batch = 0; batch + 1 < first.size(); ++batch) {
    const ChunkExtent place = place_of(batch);
    most.vertex_count = std::max(most.vertex_count, place.vertex_count);
    most.tet_count = std::max(most.tet_count, place.tet_count);
    most.face_count = std::max(most.face_count, place.face_count);
  }
  ScratchPool<TetMesh> memory;
  FirstError error;
  const auto make = [&](std::size_t batch, MeshWorkspace& workspace) {
    if (error.is_set()) return;
    const ChunkExtent place = place_of(batch);
    const ScratchPool<TetMesh>::Turn mesh(memory);
    if (mesh->tets.size() == 0) *mesh = TetMesh(header_of_chunk(header, most));
    *mesh = TetMesh(header_of_chunk(header, place), std::move(*mesh));
    for (std::size_t i = first[batch]; i < first[batch + 1]; ++i) {
      stats[i] = filler.fill(parts[i], workspace,
                             mesh->columns_of(within(filler.place(parts[i]), place)));
    }
    if (cancellation.requested()) return;  // it may not be whole
    if (auto status = take(*mesh, place); !status.ok()) error.set(std::move(status));
  };
  for_each_work(first.size() - 1, cancellation, progress, make);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  if (error.is_set()) return error.status();
  return sum_of(parts, stats);
}

QualityStats measure_chunks(const MeshPlan& plan, const TetMesh& mesh) {
  std::vector<QualityStats> stats(plan.header().chunk_count);
  for_each_index(stats.size(), [&](std::size_t i) {
    const ChunkExtent extent = plan.chunk(i);
    const std::size_t first = ChunkSizes(mesh.header, 0, extent.first_tet).tets;
    MeshView chunk = mesh.view();
    chunk.tets = chunk.tets.subspan(first, ChunkSizes(mesh.header, 0, extent.tet_count).tets);
    stats[i] = measure_tets(chunk, mesh.header.spacing_at(extent.first_tet));
  });
  return sum_of(stats);
}

}  // namespace tet
