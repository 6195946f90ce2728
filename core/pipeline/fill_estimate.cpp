#include "core/pipeline/fill_estimate.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <span>
#include <vector>

#include "core/base/byte_buffer.h"
#include "core/base/parallel.h"

namespace tet {
namespace {

/// 32 MiB of mesh at most: tens of milliseconds.
constexpr std::uint64_t kMostChunks = 64;

/// The chunks in the middle of equal parts of the mesh.
std::vector<std::uint64_t> chunks_to_try(std::uint64_t chunk_count) {
  std::vector<std::uint64_t> chunks(std::min(chunk_count, kMostChunks));
  for (std::uint64_t i = 0; i < chunks.size(); ++i) {
    chunks[i] = (2 * i + 1) * chunk_count / (2 * chunks.size());
  }
  return chunks;
}

ChunkSizes sizes_of(const MeshPlan& plan, std::uint64_t chunk) {
  const ChunkExtent extent = plan.chunk(chunk);
  return {plan.header(), extent.vertex_count, extent.tet_count};
}

void try_chunk(const MeshPlan& plan,
               std::uint64_t chunk,
               MeshWorkspace& workspace,
               std::span<std::byte> bytes) {
  const ChunkSizes size = sizes_of(plan, chunk);
  plan.fill_chunk(
      chunk, workspace,
      {bytes.first(size.positions), bytes.subspan(size.positions, size.tets),
       bytes.last(size.regions), bytes.subspan(size.positions + size.tets, size.fields)});
}

}  // namespace

FillEstimate estimate_fill(const MeshPlan& plan, const Cancellation& cancellation) {
  const MeshHeader& header = plan.header();
  FillEstimate estimate{ChunkSizes(header, header.vertex_count, header.tet_count).total(), 0};
  const std::vector<std::uint64_t> chunks = chunks_to_try(header.chunk_count);
  const std::vector<std::uint64_t> first_byte = offsets_from_counts(
      chunks.size(), [&](std::size_t i) { return sizes_of(plan, chunks[i]).total(); });
  const std::uint64_t tried = first_byte.back();
  if (tried == 0) return estimate;
  const auto start = std::chrono::steady_clock::now();
  // Nobody has touched it, as a mesh's memory.
  ByteBuffer memory(tried);
  for_each_range(chunks.size(), 1, [&](std::size_t begin, std::size_t end) {
    MeshWorkspace workspace;
    for (std::size_t i = begin; i < end && !cancellation.requested(); ++i) {
      try_chunk(plan, chunks[i], workspace,
                memory.bytes().subspan(first_byte[i], first_byte[i + 1] - first_byte[i]));
    }
  });
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  estimate.seconds =
      taken.count() * static_cast<double>(estimate.bytes) / static_cast<double>(tried);
  return estimate;
}

}  // namespace tet
