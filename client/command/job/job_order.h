// One job to be submitted: as a command line or a line of a manifest says it, and as it is
// sent.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "client/command/arguments/mesh_input.h"
#include "client/command/arguments/request_options.h"
#include "tetstream/v1/jobs.pb.h"

namespace CLI {
class App;
}

namespace tet {

/// Before it is understood.
struct JobArguments {
  std::string input;  ///< a path, or the name or digest of a stored file
  SurfaceChoices surface;
  RequestArguments request;
  std::string name;                 ///< empty takes the file's, without its ending
  std::vector<std::string> labels;  ///< KEY=VALUE; of two with one key the later holds
  int priority = 0;
  std::string ttl, timeout;  ///< "90s", "1h30m"; empty: none
  std::optional<int> max_attempts;
  bool skip_cache = false;
};

/// Adds every option but the input.
void describe_job(CLI::App& app, JobArguments& arguments);

struct JobOrder {
  MeshInput input;
  v1::Job job;  ///< whose mesh has no name yet, and fields with paths: those of stored files
};

/// Errors: kInvalidArgument (a value that cannot be, or options that do not go together).
absl::StatusOr<JobOrder> understand_job(const JobArguments& arguments);

/// What tells the order from others: 64 hexadecimal digits of where the input is and all that
/// is asked for, but not of what is in the file.
std::string digest_of(const JobOrder& order);

}  // namespace tet
