#include "server/jobs/results/job_spec.h"

#include <algorithm>

#include "proto/convert/statistics.h"
#include "server/jobs/store/store_errors.h"
#include "server/meshing/mesh_events.h"

namespace tet {

namespace {

// 32 MiB of mesh, or a second's work: what is lost with a worker. A small mesh is cut finer, so
// that several workers have something of it.
constexpr std::int64_t kShardChunks = 64, kSmallShardChunks = 4, kShardsOfAMesh = 16;

constexpr std::int64_t kMostCountShards = 1000;

/// [0, count) in ranges of `size`; the last may be shorter.
std::vector<ChunkRange> cut(std::int64_t count, std::int64_t size) {
  std::vector<ChunkRange> ranges;
  for (std::int64_t first = 0; first < count; first += size) {
    ranges.push_back({first, std::min(first + size, count)});
  }
  return ranges;
}

}  // namespace

absl::StatusOr<stored::JobSpec> spec_of(const Job& job) {
  stored::JobSpec spec;
  if (spec.ParseFromString(job.spec)) return spec;
  return store_broken("what job " + job.id + " asks for cannot be read");
}

absl::StatusOr<stored::JobPlan> plan_of(const Job& job) {
  stored::JobPlan plan;
  if (plan.ParseFromString(job.header)) return plan;
  return store_broken("the plan of job " + job.id + " cannot be read");
}

absl::StatusOr<MeshOrder> order_of(const Job& job, const stored::JobSpec& spec) {
  auto order = parse_mesh_request(spec.mesh());
  if (order.ok()) order->space = job.space;
  return order;
}

stored::JobPlan plan_of(const PlannedMesh& planned) {
  stored::JobPlan plan;
  const ChunkSource source{planned.plan, nullptr};
  *plan.mutable_header() = header_event(planned, source).header();
  *plan.mutable_trailer() = trailer_event(source, 0, 0, {}).trailer();
  plan.mutable_trailer()->clear_quality();
  return plan;
}

v1::MeshEvent trailer_event(const stored::JobPlan& plan,
                            std::uint64_t first,
                            std::uint64_t end,
                            const QualityStats& quality) {
  v1::MeshEvent event;
  v1::MeshTrailer& trailer = *event.mutable_trailer();
  trailer = plan.trailer();
  trailer.set_first_chunk(static_cast<std::int64_t>(first));
  trailer.set_end_chunk(static_cast<std::int64_t>(end));
  to_proto(quality, *trailer.mutable_quality());
  return event;
}

std::vector<ChunkRange> shards_of(std::int64_t chunk_count) {
  return cut(chunk_count,
             std::clamp(chunk_count / kShardsOfAMesh, kSmallShardChunks, kShardChunks));
}

std::vector<ChunkRange> count_shards_of(std::int64_t block_count) {
  return cut(block_count, (block_count + kMostCountShards - 1) / kMostCountShards);
}

}  // namespace tet
