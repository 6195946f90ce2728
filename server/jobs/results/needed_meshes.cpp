#include "server/jobs/results/needed_meshes.h"

#include <utility>

#include "proto/convert/mesh_header.h"
#include "proto/convert/request.h"
#include "proto/convert/status.h"
#include "server/jobs/results/job_spec.h"

namespace tet {

namespace {

/// More than a chunk's file has beside the message: its statistics, and a checksum.
constexpr std::uint64_t kBesideMessage = 4096;

/// A counted mesh, as plans tell of it; none where a plan cannot be read.
struct CountedMesh {
  std::string mesh_id;
  MeshHeader header;
};

std::optional<CountedMesh> counted_mesh(const std::string& stored_plan) {
  stored::JobPlan plan;
  if (!plan.ParseFromString(stored_plan)) return std::nullopt;
  auto header = from_proto(plan.header());
  if (!header.ok()) return std::nullopt;
  return CountedMesh{plan.header().mesh_id(), *std::move(header)};
}

/// What a job waits for that was counted and is not begun.
std::optional<CountedMesh> awaited_mesh(const PatientJob& job, const ResultStore& results) {
  stored::JobSpec spec;
  if (!spec.ParseFromString(job.spec)) return std::nullopt;
  const auto plan = results.find_plan(job.space, name_of_request(spec.mesh()));
  return plan ? counted_mesh(*plan) : std::nullopt;
}

/// The most urgent first, then the oldest: the order in which jobs have their turn.
std::pair<std::int64_t, const std::string&> place_in_line(const PatientJob& job) {
  return {-job.priority, job.id};
}
std::pair<std::int64_t, const std::string&> place_in_line(const Job& job) {
  return {-job.priority, job.id};
}

}  // namespace

absl::StatusOr<std::vector<NeededMesh>> needed_meshes(JobStore& jobs) {
  const auto planned = jobs.planned();
  if (!planned.ok()) return planned.status();
  std::vector<NeededMesh> meshes;
  for (const PlannedJob& job : *planned) {
    // A plan that cannot be read fails its job, which then needs nothing.
    const auto mesh = counted_mesh(job.header);
    if (!mesh) continue;
    meshes.push_back({job.id,
                      {job.space, mesh->mesh_id},
                      stored_bytes(mesh->header),
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

absl::StatusOr<std::optional<NeededMesh>> first_in_line(JobStore& jobs,
                                                        ResultStore& results,
                                                        const Job& asking) {
  const auto patient = jobs.patient();
  if (!patient.ok()) return patient.status();
  for (const PatientJob& job : *patient) {
    if (place_in_line(job) >= place_in_line(asking)) break;
    const auto mesh = awaited_mesh(job, results);
    if (!mesh || !results.check_fits(chunk_bytes(mesh->header)).ok()) continue;
    return NeededMesh{
        job.id, {job.space, mesh->mesh_id}, stored_bytes(mesh->header), true, false};
  }
  return std::nullopt;
}

std::uint64_t chunk_bytes(const MeshHeader& header) {
  return ChunkSizes(header, whole_of(header)).total();
}

std::uint64_t stored_bytes(const MeshHeader& header) {
  return chunk_bytes(header) + header.chunk_count * kBesideMessage;
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
