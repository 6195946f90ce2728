// Jobs as the wire has them, and back: the one place where requests about jobs are validated.
#pragma once

#include <string>

#include <absl/status/statusor.h>
#include <absl/time/time.h>

#include "server/jobs/results/job_spec.h"
#include "server/jobs/store/job_store.h"
#include "tetstream/v1/jobs.pb.h"

namespace tet {

/// Errors of all: kInvalidArgument (INVALID_FIELD), naming the field, its value and what it may
/// be.

/// The id within `jobs/{id}`.
absl::StatusOr<std::string> parse_job_name(const std::string& name);

/// Its input names the digests of all files that it reads.
absl::StatusOr<NewJob> parse_create(const v1::CreateJobRequest& request,
                                    const std::string& space);
absl::StatusOr<ListJobs> parse_list(const v1::ListJobsRequest& request,
                                    const std::string& space);
/// How long to wait.
absl::StatusOr<absl::Duration> parse_wait(const v1::WaitJobRequest& request);
/// How many shards were on the pages before: what `next_page_token` of ListDeadShards said.
absl::StatusOr<std::int64_t> parse_shard_token(const std::string& token);
/// 1 to 1000.
absl::StatusOr<std::int64_t> parse_page_size(std::int32_t page_size);

/// The name of the last worker of the page before.
absl::StatusOr<std::string> parse_worker_token(const std::string& token);

std::string name_of_job(const std::string& id);
/// What is damaged of the job's opaque parts stays out. `with_header` as lists are without.
void to_proto(const Job& job, bool with_header, v1::Job& message);
void to_proto(const JobEvent& event, v1::JobEvent& message);
void to_proto(const DeadLetter& letter, v1::DeadShard& message);
/// As the store knew it at `read_time`.
void to_proto(const KnownWorker& worker, absl::Time read_time, v1::Worker& message);

}  // namespace tet
