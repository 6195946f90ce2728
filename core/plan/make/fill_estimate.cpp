#include "core/plan/make/fill_estimate.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <span>
#include <vector>

#include "core/base/byte_buffer.h"
#include "core/base/parallel.h"
#include "core/base/scratch_pool.h"
#include "core/plan/mesh_workspace.h"

namespace tet {
namespace {

/// 32 MiB of mesh at most: tens of milliseconds.
constexpr std::uint64_t kMostChunks = 64;

/// The bits of a number below kMostChunks, the other way round.
constexpr std::uint64_t reversed(std::uint64_t number) {
  std::uint64_t turned = 0;
  for (std::uint64_t bit = 1; bit < kMostChunks; bit *= 2) {
    turned = 2 * turned + (number / bit) % 2;
  }
  return turned;
}

/// The chunks in the middle of equal parts of the mesh; the first few are spread over it, too.
std::vector<std::uint64_t> chunks_to_try(std::uint64_t chunk_count) {
  const std::uint64_t count = std::min(chunk_count, kMostChunks);
  std::vector<std::uint64_t> chunks;
  for (std::uint64_t i = 0; i < kMostChunks; ++i) {
    const std::uint64_t part = reversed(i);
    if (part < count) chunks.push_back((2 * part + 1) * chunk_count / (2 * count));
  }
  return chunks;
}

ChunkSizes sizes_of(const MeshPlan& plan, std::uint64_t chunk) {
  return {plan.header(), plan.chunk(chunk)};
}

/// The columns one after the other, those with the largest numbers first.
ChunkColumns columns_in(std::span<std::byte> bytes, const ChunkSizes& size) {
  const auto take = [&](std::size_t count) {
    const std::span<std::byte> taken = bytes.first(count);
    bytes = bytes.subspan(count);
    return taken;
  };
  ChunkColumns columns;
  columns.positions = take(size.positions);
  columns.tets = take(size.tets);
  columns.faces = take(size.faces);
  columns.face_tets = take(size.face_tets);
  columns.fields = take(size.fields);
  columns.face_labels = take(size.face_labels);
  columns.regions = take(size.regions);
  return columns;
}

/// Makes a chunk in memory of its own, as those that are sent are made: one a thread at a time.
void try_chunk(const MeshPlan& plan, std::uint64_t chunk, MeshWorkspace& workspace) {
  const ChunkSizes size = sizes_of(plan, chunk);
  ByteBuffer memory(size.total());
  plan.fill_chunk(chunk, workspace, columns_in(memory.bytes(), size));
}

}  // namespace

FillEstimate estimate_fill(const MeshPlan& plan,
                           const Cancellation& cancellation,
                           std::chrono::nanoseconds most) {
  const MeshHeader& header = plan.header();
  FillEstimate estimate{ChunkSizes(header, whole_of(header)).total(), 0};
  const std::vector<std::uint64_t> chunks = chunks_to_try(header.chunk_count);
  std::atomic<std::size_t> next{0};
  std::atomic<std::uint64_t> tried{0};
  const auto start = std::chrono::steady_clock::now();
  ScratchPool<MeshWorkspace> workspaces;
  // Whichever thread has time takes the next one.
  for_each_index(chunks.size(), [&](std::size_t /*any*/) {
    const std::size_t i = next.fetch_add(1);
    const bool is_over = i > 0 && std::chrono::steady_clock::now() - start > most;
    if (is_over || cancellation.requested()) return;
    try_chunk(plan, chunks[i], *ScratchPool<MeshWorkspace>::Turn(workspaces));
    tried.fetch_add(sizes_of(plan, chunks[i]).total());
  });
  if (tried == 0) return estimate;
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  estimate.seconds =
      taken.count() * static_cast<double>(estimate.bytes) / static_cast<double>(tried.load());
  return estimate;
}

}  // namespace tet
