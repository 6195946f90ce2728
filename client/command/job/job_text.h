// Jobs as people read them.
#pragma once

#include <string>

#include "client/library/job_client.h"

namespace tet {

/// "jobs/ID  RUNNING   12/40 chunks  bunny  part=ear"; the header of such lines.
std::string table_line(const v1::Job& job);
std::string table_header();

/// "HOST:PROCESS  6  WORKING  3 s ago  2  jobs/ID ..."; the header of such lines. Why a worker
/// is in quarantine comes on a line of its own.
std::string table_line(const v1::Worker& worker, const google::protobuf::Timestamp& now);
std::string workers_header();

/// A few lines, all that is known.
std::string description_of(const v1::Job& job, const std::vector<v1::DeadShard>& dead_shards);

/// "jobs/ID  FAILED     bunny: LEASE_EXPIRED: why"; of a job that was deleted, that.
std::string outcome_line(const v1::Job& job);

/// "18:03:21  42  jobs/ID  SHARD_DONE  RUNNING  3/12 chunks"
std::string event_line(const v1::JobEvent& event);

}  // namespace tet
