// Which requests to send, as a user says it: options of `tetstream mesh` and a few of our own.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "bench/load/request_mix.h"
#include "client/command/arguments/request_options.h"
#include "client/command/process/progress_bar.h"
#include "client/library/mesh_client.h"
#include "core/base/cancel.h"

namespace CLI {
class App;
}

namespace tet::load {

/// A command line's or a mix file's line's requests: one for each grid.
struct MixArguments {
  std::vector<std::string> grids;  ///< paths, or names or digests of stored files
  RequestArguments request;
  std::optional<std::array<double, 2>> vary_iso;
  bool fresh = false;
  bool job = false, skip_cache = false;
  double weight = 1;
};

void describe_mix(CLI::App& app, MixArguments& arguments);

/// One line for each kind of request: `--weight 3 bunny.vdb --levels 0`. Empty lines and those
/// that begin with # mean nothing. Errors: kNotFound (the file), kInvalidArgument (line by
/// number).
absl::StatusOr<std::vector<MixArguments>> read_mix_file(const std::string& path);

/// Uploads the files that the server lacks, and asks it what each request would make, which
/// also loads every grid. Errors: the server's own; kInvalidArgument (options that do not go
/// together).
absl::StatusOr<RequestMix> prepare_mix(const std::vector<MixArguments>& arguments,
                                       MeshClient& client,
                                       ProgressBar& bar,
                                       const Cancellation& interruption);

}  // namespace tet::load
