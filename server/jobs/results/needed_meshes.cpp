#include "server/jobs/results/needed_meshes.h"

#include <utility>

#include "proto/convert/mesh_header.h"
#include "proto/convert/status.h"
#include "tetstream/stored/jobs.pb.h"

namespace tet {

namespace {

/// More than a chunk's file has beside the message: its statistics, and a checksum.
constexpr std::uint64_t kBesideMessage = 4096;

}  // namespace

absl::StatusOr<std::vector<NeededMesh>> needed_meshes(JobStore& jobs) {
  const auto planned = jobs.planned();
  if (!planned.ok()) return planned.status();
  std::vector<NeededMesh> meshes;
  for (const PlannedJob& job : *planned) {
    // A plan that cannot be read fails its job, which then needs nothing.
    tetstream::stored::JobPlan plan;
    if (!plan.ParseFromString(job.header)) continue;
    const auto header = from_proto(plan.header());
    if (!header.ok()) continue;
    meshes.push_back({job.id,
                      {job.space, plan.header().mesh_id()},
                      stored_bytes(*header),
                      job.waits_for_room,
                      job.leased_shards > 0 && !job.waits_for_room});
  }
  return meshes;
}

absl::StatusOr<std::set<ResultKey>> needed_results(JobStore& jobs) {
  const auto meshes = needed_meshes(jobs);
  if (!meshes.ok()) return meshes.status();
  std::set<ResultKey> keys;
  for (const NeededMesh& mesh : *meshes) keys.insert(mesh.key);
  return keys;
}

std::uint64_t stored_bytes(const MeshHeader& header) {
  return ChunkSizes(header, whole_of(header)).total() + header.chunk_count * kBesideMessage;
}

std::uint64_t bytes_beside(const std::vector<NeededMesh>& meshes,
                           const ResultKey& key,
                           std::uint64_t bytes) {
  std::set<ResultKey> counted = {key};
  for (const NeededMesh& mesh : meshes) {
    if (counted.insert(mesh.key).second) bytes += mesh.bytes;
  }
  return bytes;
}

bool is_youngest_of_waiting(const std::vector<NeededMesh>& meshes, const std::string& job) {
  bool another_waits = false;
  for (const NeededMesh& mesh : meshes) {
    if (mesh.job == job) continue;
    if (mesh.goes_on || (mesh.waits && mesh.job > job)) return false;
    another_waits = another_waits || mesh.waits;
  }
  return another_waits;
}

bool is_want_of_room(const absl::Status& status) {
  const std::string reason = reason_of(status);
  return reason == "RESULTS_FULL" || reason == "DISK_FULL";
}

}  // namespace tet
