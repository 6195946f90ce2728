#include "server/jobs/service/job_context.h"

#include <algorithm>

#include <absl/strings/str_cat.h>

#include "server/jobs/results/job_spec.h"
#include "server/jobs/service/job_messages.h"
#include "server/jobs/store/store_errors.h"

namespace tet {

namespace {

/// Digests read at once.
constexpr std::int64_t kPage = 4096;

}  // namespace

absl::StatusOr<Job> JobContext::find(const std::string& space, const std::string& name) const {
  const auto id = parse_job_name(name);
  if (!id.ok()) return id.status();
  auto job = jobs.get(*id);
  if (job.ok() && job->space != space) return job_not_found(*id);
  return job;
}

absl::StatusOr<std::shared_ptr<MeshFolder>> JobContext::mesh_of(const Job& job) const {
  if (job.chunk_count == 0) return nullptr;
  const auto plan = plan_of(job);
  if (!plan.ok()) return plan.status();
  if (plan->header().chunk_count() != job.chunk_count) {
    return store_broken(absl::StrCat("job ", job.id, " has ", job.chunk_count,
                                     " chunks, and its plan ", plan->header().chunk_count()));
  }
  return results.make({job.space, plan->header().mesh_id()});
}

absl::StatusOr<std::vector<std::int64_t>> JobContext::lost_chunks(
    const Job& job, const MeshFolder* folder) const {
  std::vector<std::int64_t> lost;
  if (folder == nullptr) return lost;
  for (std::int64_t first = 0; first < job.chunk_count; first += kPage) {
    const auto digests =
        jobs.chunk_digests(job.id, {first, std::min(first + kPage, job.chunk_count)});
    if (!digests.ok()) return digests.status();
    for (const auto& [chunk, digest] : *digests) {
      if (!folder->has_chunk(digest)) lost.push_back(chunk);
    }
  }
  return lost;
}

}  // namespace tet
