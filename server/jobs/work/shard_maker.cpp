#include "server/jobs/work/shard_maker.h"

#include <algorithm>
#include <utility>

#include <absl/functional/function_ref.h>
#include <absl/strings/str_cat.h>
#include <absl/time/clock.h>
#include <absl/time/time.h>

#include "proto/convert/mesh_header.h"
#include "proto/convert/status.h"
#include "server/jobs/results/needed_meshes.h"
#include "server/jobs/results/stored_mesh.h"
#include "server/jobs/store/store_errors.h"
#include "server/rpc/background.h"

namespace tet {

struct ShardMaker::Shard {
  const ShardLease& lease;
  Job job;
  stored::JobSpec spec;
  CountOrder order;
  stored::JobPlan plan;  ///< nothing before it is counted, or divided to be
};

namespace {

constexpr char kHeldByJobs[] = "RESULTS_HELD_BY_JOBS";

absl::Status other_mesh(const std::string& planned, const std::string& found) {
  return with_reason(absl::AbortedError(absl::StrCat("the job's mesh is ", planned,
                                                     ", but this worker makes it as ", found,
                                                     ": it is of another version")),
                     "OTHER_MESH");
}

absl::Status alarm(const ChunkRange& chunks, const std::string& mesh_id) {
  return with_reason(
      absl::DataLossError(absl::StrCat("chunks ", chunks.first, " to ", chunks.end, " of mesh ",
                                       mesh_id, " were made with other bytes than before")),
      "DETERMINISM_ALARM");
}

/// Asks the store until it answers, or nobody wants to know any more: a database that was away
/// for a while costs no attempt. What is asked for twice is done once.
absl::Status persist(const Cancellation& cancellation, absl::FunctionRef<absl::Status()> ask) {
  constexpr absl::Duration kPause = absl::Milliseconds(200);
  absl::Status answer = ask();
  while (absl::IsUnavailable(answer) && !cancellation.requested()) {
    absl::SleepFor(kPause);
    answer = ask();
  }
  return answer;
}

}  // namespace

bool ShardMaker::is_worth_another_try(const absl::Status& error) {
  switch (error.code()) {
    case absl::StatusCode::kAborted:
    case absl::StatusCode::kInternal:
    case absl::StatusCode::kUnavailable:
    case absl::StatusCode::kUnknown:
      return true;
    case absl::StatusCode::kResourceExhausted:
      return reason_of(error) != "LIMIT_EXCEEDED";
    default:
      return false;
  }
}

bool ShardMaker::lacks_room(const absl::Status& error) {
  return reason_of(error) == "DISK_FULL" || awaits_room(error) || will_pass(error);
}

bool ShardMaker::ends_job(const absl::Status& error) { return reason_of(error) == kHeldByJobs; }

bool ShardMaker::awaits_room(const absl::Status& error) {
  return reason_of(error) == "RESULTS_FULL";
}

absl::Status ShardMaker::run(const ShardLease& lease,
                             const std::shared_ptr<PlanningWatch>& watch) {
  absl::StatusOr<Job> job;
  const absl::Status found = persist(watch->cancellation, [&] {
    job = jobs_.get(lease.id.shard.job);
    return job.status();
  });
  if (!found.ok()) return found;
  auto spec = spec_of(*job);
  if (!spec.ok()) return spec.status();
  auto plan_so_far = plan_of(*job);
  if (!plan_so_far.ok()) return plan_so_far.status();
  auto mesh_order = order_of(*job, *spec);
  if (!mesh_order.ok()) return mesh_order.status();
  const Shard shard{lease,
                    *std::move(job),
                    *std::move(spec),
                    {*std::move(mesh_order), watch},
                    *std::move(plan_so_far)};
  switch (lease.id.shard.phase) {
    case Phase::kPlan:
      return plan(shard);
    case Phase::kCount:
      return survey(shard);
    case Phase::kMesh:
      return mesh(shard);
  }
  return absl::InternalError("a shard of no known phase");
}

absl::Status ShardMaker::plan(const Shard& shard) {
  const std::string name = name_of_request(shard.spec.mesh());
  stored::JobPlan plan;
  const auto counted = results_.find_plan(shard.job.space, name);
  if (counted && plan.ParseFromString(*counted)) {
    if (!shard.spec.skip_cache() && is_stored(shard.job.space, plan)) {
      plan.set_cached(true);
      return commit_plan(shard, plan);
    }
    // A job that waits for room is not counted each time that it looks.
    if (auto fits = check_room(shard, plan); !fits.ok()) {
      results_.keep_plan(shard.job.space, name);
      return fits;
    }
  }
  if (shard.plan.survey_block_bricks() == 0) {
    const auto blocks = counter_.blocks(shard.order, block_bricks_);
    if (!blocks.ok()) return blocks.status();
    if (*blocks > 1) return divide(shard, *blocks);
  }
  const auto planned = count(shard);
  if (!planned.ok()) return planned.status();
  plan = plan_of(*planned);
  plan.set_survey_block_bricks(shard.plan.survey_block_bricks());
  const absl::Status kept =
      results_.put_plan({shard.job.space, planned->mesh_id}, name, plan.SerializeAsString());
  plan.set_cached(!shard.spec.skip_cache() && is_stored(shard.job.space, plan));
  const absl::Status fits =
      plan.cached() ? check_size(planned->plan->header()) : check_room(shard, plan);
  if (!fits.ok()) return fits;
  if (!kept.ok()) return kept;
  return commit_plan(shard, plan);
}

absl::Status ShardMaker::divide(const Shard& shard, std::int64_t blocks) {
  stored::JobPlan plan;
  plan.set_survey_block_bricks(block_bricks_);
  const Plan shards{Phase::kCount, plan.SerializeAsString(), count_shards_of(blocks),
                    kAlgorithmVersion};
  return commit(shard, [&] { return jobs_.set_plan(shard.lease.id, shards); });
}

absl::Status ShardMaker::survey(const Shard& shard) {
  const auto survey = survey_of(shard);
  if (!survey.ok()) return survey.status();
  std::vector<ChunkDigest> digests;
  for (std::int64_t i = shard.lease.chunks.first; i < shard.lease.chunks.end; ++i) {
    auto digest = survey_block(shard, **survey, i);
    if (!digest.ok()) return digest.status();
    digests.push_back(*std::move(digest));
  }
  return commit_chunks(shard, digests);
}

absl::StatusOr<ChunkDigest> ShardMaker::survey_block(const Shard& shard,
                                                     SharedSurvey& survey,
                                                     std::int64_t block) {
  if (!shard.spec.skip_cache()) {
    if (auto digest = survey.digest_of(block)) return *std::move(digest);
  }
  const auto bytes = counter_.survey(shard.order, shard.plan.survey_block_bricks(), block);
  if (!bytes.ok()) return bytes.status();
  return survey.put(block, *bytes);
}

/// What the workers share of the mesh's survey.
absl::StatusOr<std::shared_ptr<SharedSurvey>> ShardMaker::survey_of(const Shard& shard) {
  const std::int64_t block_bricks = shard.plan.survey_block_bricks();
  if (block_bricks <= 0) {
    return store_broken(absl::StrCat("job ", shard.job.id, " is surveyed in blocks of ",
                                     block_bricks, " bricks"));
  }
  return SharedSurvey::open(
      results_, engine_.blocks,
      {shard.job.space, name_of_request(shard.spec.mesh()), block_bricks});
}

/// What can never be stored is not worth making.
absl::Status ShardMaker::check_size(const MeshHeader& header) const {
  return results_.check_fits(chunk_bytes(header));
}

/// Whether the mesh can be stored, and beside those that other unfinished jobs have begun or
/// are to begin. If it were begun all the same, each could have what the other waits for. What
/// becomes free belongs to the first of those that have long waited for it: a large mesh would
/// wait for ever behind small ones which all fit.
absl::Status ShardMaker::check_room(const Shard& shard, const stored::JobPlan& plan) const {
  const auto header = from_proto(plan.header());
  if (!header.ok()) return absl::OkStatus();  // it is counted anew
  if (auto fits = check_size(*header); !fits.ok()) return fits;
  auto needed = needed_meshes(jobs_);
  if (!needed.ok()) return needed.status();
  const ResultKey key{shard.job.space, plan.header().mesh_id()};
  const auto first = first_in_line(jobs_, results_, shard.job);
  if (!first.ok()) return first.status();
  // A mesh that another job has begun takes nothing of what is waited for.
  const bool begun = std::ranges::count(*needed, key, &NeededMesh::key) > 0;
  const bool gives_way = *first && !begun;
  if (gives_way) needed->push_back(**first);
  const std::uint64_t own = stored_bytes(*header), all = bytes_beside(*needed, key, own);
  if (all == own || results_.check_fits(all).ok()) return absl::OkStatus();
  return with_reason(absl::ResourceExhaustedError(
                         absl::StrCat("no room for the mesh's ", own, " bytes beside the ",
                                      all - own, " of meshes that other jobs are making",
                                      gives_way ? ", or have long waited for" : "")),
                     "RESULTS_FULL");
}

/// Jobs that were planned when there was more room, or at the same moment, may hold what each
/// other waits for. Of those that wait the youngest ends, so that what it made may go. As long
/// as another job goes on, or all would fit if others gave their part of the disk back, `why`
/// stands, and the job waits.
absl::Status ShardMaker::give_way(const Shard& shard, const absl::Status& why) const {
  if (!is_want_of_room(why)) return why;
  const auto header = from_proto(shard.plan.header());
  const auto needed = needed_meshes(jobs_);
  if (!header.ok() || !needed.ok() || !check_size(*header).ok()) return why;
  const ResultKey key{shard.job.space, shard.plan.header().mesh_id()};
  const std::uint64_t own = stored_bytes(*header), all = bytes_beside(*needed, key, own);
  if (!is_youngest_of_waiting(*needed, shard.job.id) || results_.check_ever_fits(all).ok()) {
    return why;
  }
  return with_reason(absl::ResourceExhaustedError(absl::StrCat(
                         "no room for the mesh's ", own, " bytes beside the ", all - own,
                         " of meshes that older jobs are making, which wait for room, too: "
                         "retry the job when ",
                         "they are finished")),
                     kHeldByJobs);
}

bool ShardMaker::is_stored(const std::string& space, const stored::JobPlan& plan) const {
  return StoredMesh::find(results_, space, plan) != nullptr;
}

absl::Status ShardMaker::commit_plan(const Shard& shard, const stored::JobPlan& plan) {
  const Plan shards{Phase::kMesh, plan.SerializeAsString(),
                    shards_of(plan.header().chunk_count()), kAlgorithmVersion};
  return commit(shard, [&] { return jobs_.set_plan(shard.lease.id, shards); });
}

absl::Status ShardMaker::mesh(const Shard& shard) {
  const std::string& mesh_id = shard.plan.header().mesh_id();
  const ChunkRange& chunks = shard.lease.chunks;
  const auto folder = results_.make({shard.job.space, mesh_id});
  if (!folder.ok()) return folder.status();
  if (!shard.spec.skip_cache()) {
    const auto digests = (*folder)->find_whole_shard(chunks);
    if (digests) return commit_chunks(shard, *digests);
  }
  const auto planned = count(shard);
  if (!planned.ok()) return planned.status();
  if (planned->mesh_id != mesh_id) {
    // Versions that did not say whose plan it is.
    if (!shard.job.algorithm.empty()) return other_mesh(mesh_id, planned->mesh_id);
    return commit(shard, [&] { return jobs_.plan_anew(shard.lease.id); });
  }
  const auto made = make_chunks(shard, *planned, **folder);
  if (!made.ok()) return give_way(shard, made.status());
  const auto before = (*folder)->find_shard(chunks);
  if (before && *before != *made) return alarm(chunks, mesh_id);
  if (auto kept = (*folder)->put_shard(chunks, *made); !kept.ok()) return kept;
  return commit_chunks(shard, *made);
}

absl::Status ShardMaker::commit_chunks(const Shard& shard,
                                       const std::vector<ChunkDigest>& digests) {
  return commit(shard, [&] { return jobs_.complete(shard.lease.id, digests); });
}

/// What was written into a folder that is no longer the store, or never was, is nobody's.
absl::Status ShardMaker::commit(const Shard& shard, absl::FunctionRef<absl::Status()> tell) {
  return persist(shard.order.watch->cancellation, [&] {
    const absl::Status place = place_.check_store();
    return place.ok() ? tell() : place;
  });
}

absl::StatusOr<PlannedMesh> ShardMaker::count(const Shard& shard) {
  if (shard.plan.survey_block_bricks() == 0) return counter_.count(shard.order, {});
  auto survey = survey_of(shard);
  if (!survey.ok()) return survey.status();
  return counter_.count(shard.order, SharedSurvey::blocks(*std::move(survey)));
}

absl::StatusOr<std::vector<ChunkDigest>> ShardMaker::make_chunks(const Shard& shard,
                                                                 const PlannedMesh& planned,
                                                                 MeshFolder& folder) {
  const ChunkSource source{planned.plan, nullptr};
  const std::string client = background_client(shard.order.mesh.space);
  const WorkTimer timer(engine_.calls.clients().of(client));
  std::vector<ChunkDigest> digests;
  bool waits = shard.job.waits_for_room;
  for (std::int64_t i = shard.lease.chunks.first; i < shard.lease.chunks.end; ++i) {
    const absl::Status wanted = check_cancelled(shard.order.watch->cancellation);
    if (!wanted.ok()) return wanted;
    const absl::StatusOr<ChunkMessage> chunk =
        make_chunk(source, static_cast<std::uint64_t>(i), engine_.chunk_memory(), nullptr,
                   shard.order.watch->cancellation);
    if (!chunk.ok()) return chunk.status();
    engine_.activity.chunks_made.fetch_add(1);
    auto put = results_.put_chunk(folder, *chunk);
    if (!put.ok()) return put.status();
    // Others must not take a job for waiting that goes on. A store that does not answer is
    // asked with the next chunk.
    if (waits && put->is_new) waits = !jobs_.found_room(shard.lease.id).ok();
    digests.push_back(std::move(put->digest));
  }
  return digests;
}

}  // namespace tet
