// Many orders to a server: each grid goes up once, and each job is made once.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <absl/status/status.h>

#include "client/command/job/job_order.h"
#include "client/command/job/journal.h"
#include "client/library/job_client.h"
#include "client/library/mesh_client.h"
#include "core/base/cancel.h"

namespace tet {

/// A job that the server has acknowledged.
struct SubmittedJob {
  const JobOrder& order;
  std::string request_id;
  std::string name;     ///< `jobs/{id}`
  bool before = false;  ///< the journal knew it already
};

/// Who is told; one call at a time, on any thread.
struct SubmitWatch {
  std::function<void(const SubmittedJob&)> submitted;
  std::function<void(const JobOrder&, const absl::Status&)> refused;
  std::function<void(double jobs)> progress;  ///< dealt with, with parts of uploads
  std::function<void(const std::string& line)> say;
};

struct SubmitCounts {
  std::size_t submitted = 0, before = 0, refused = 0;
};

struct SubmitResult {
  SubmitCounts counts;
  absl::Status status;  ///< what stopped it, if anything did
};

/// A server's two faces: where grids go, and where jobs are made.
struct JobServer {
  MeshClient& meshes;
  JobClient& jobs;
};

/// Submits what the journal does not know yet, `parallel` at a time. An order that is refused
/// for what it is does not stop the others; a server that fails or has no room does.
SubmitResult submit_jobs(const std::vector<JobOrder>& orders,
                         const JobServer& server,
                         Journal& journal,
                         int parallel,
                         const SubmitWatch& watch,
                         const Cancellation& cancellation);

}  // namespace tet
