// The command line of tetstream-load.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "bench/load/find_rate.h"
#include "bench/load/latency_goal.h"
#include "bench/load/load_plan.h"
#include "bench/load/mix_options.h"
#include "bench/load/stream_sender.h"
#include "client/command/arguments/server_options.h"

namespace CLI {
class App;
}

namespace tet::load {

/// What the command line says, before it is understood.
struct LoadArguments {
  StreamSettings stream;
  ServerArguments server{.address = "127.0.0.1:7447", .channel = {}, .token_file = {}};
  MixArguments mix;
  std::string mix_file;
  std::string rate, arrivals = "poisson", duration, warm_up, timeout, drain = "10s";
  std::size_t workers = 0, burst = 1;
  std::size_t max_outstanding = 256, max_queued = 10000;
  std::uint64_t seed = 1;
  std::vector<std::string> targets;
  bool find_rate = false;
  int trials = 3;
  double precision = 0.05;
  std::string json;
  bool quiet = false;
};

struct LoadOptions {
  StreamSettings stream;
  std::vector<MixArguments> mix;
  LoadPlan plan;  ///< of a trial, when searching
  std::vector<LatencyGoal> goals;
  /// Searches when set; start_per_second is 0 when it has to be found out.
  std::optional<SearchPlan> search;
  std::string json;  ///< path; empty writes none
  bool quiet = false;
};

void describe_load(CLI::App& app, LoadArguments& arguments);

/// Errors: kInvalidArgument (a value that cannot be understood, options that do not go
/// together), kNotFound (the mix file).
absl::StatusOr<LoadOptions> understand_load(const LoadArguments& arguments);

}  // namespace tet::load
