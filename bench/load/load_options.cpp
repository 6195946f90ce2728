#include "bench/load/load_options.h"

#include <utility>

#include <CLI/CLI.hpp>
#include <absl/strings/str_cat.h>

#include "bench/load/units.h"
#include "core/base/posix/atomic_file.h"

namespace tet::load {
namespace {

constexpr const char* kExamples = R"(
Requests come at --rate whatever became of those before (an open loop, as independent users are),
or from --workers who each wait for their answer and ask again (a closed loop). Latencies count
from the moment a request was due, so that a server that stalls cannot hide it.

Examples:
  tetstream-load bunny.vdb --rate 20
      20 requests a second for 30 s, after 3 s of warm-up
  tetstream-load bunny.vdb --levels 0 --rate 5:50:10 --duration 20s
      ten steps from 5 to 50 a second, 20 s each
  tetstream-load bunny.vdb dragon.vdb --workers 4 --check
      four callers back to back, either grid in turn at random, every checksum verified
  tetstream-load --mix mix.txt --rate 20 --json load.json
      a mix of requests; a line of mix.txt reads: --weight 3 bunny.vdb --spacing 0.02
  tetstream-load bunny.vdb --fresh --rate 20 --target p99=500ms
      every request is planned anew; exits with 1 when the target is missed
  tetstream-load bunny.vdb --find-rate --target first-chunk-p99=200ms
      the highest rate at which 99 % of the first chunks come within 200 ms

Exit codes:
  0 done    1 a target was missed, or the input was refused, or the output cannot be written
  2 usage   3 the server or the network failed    130 stopped by Ctrl-C (128 + signal),
  with a report of what was measured until then
)";

void describe_arrivals(CLI::App& app, LoadArguments& arguments) {
  app.add_option("--rate", arguments.rate,
                 "Requests a second: 20, or steps 5,10,20, or FROM:TO:STEPS")
      ->group("Load");
  app.add_option("--workers", arguments.workers, "Callers back to back, instead of a rate")
      ->group("Load")
      ->check(CLI::Range(1, 100000));
  app.add_option("--arrivals", arguments.arrivals, "poisson or constant (evenly spaced)")
      ->group("Load")
      ->capture_default_str()
      ->check(CLI::IsMember({"poisson", "constant"}));
  app.add_option("--burst", arguments.burst, "So many requests fall due at once, as of a batch")
      ->group("Load")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000));
  app.add_option("--duration", arguments.duration,
                 "How long each step is measured, e.g. 500ms, 30s, 2m [30s; 10s for a trial]")
      ->group("Load");
  app.add_option("--warm-up", arguments.warm_up, "Before that, and not measured [3s]")
      ->group("Load");
  app.add_option("--seed", arguments.seed, "Of the arrivals and of what each asks for")
      ->group("Load")
      ->capture_default_str();
}

void describe_limits(CLI::App& app, LoadArguments& arguments) {
  app.add_option("--max-outstanding", arguments.max_outstanding,
                 "Requests under way at once; more wait, and their latency counts the wait")
      ->group("Limits")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000000));
  app.add_option("--max-queued", arguments.max_queued,
                 "Requests that may wait so; more are dropped and counted")
      ->group("Limits")
      ->capture_default_str();
  app.add_option("--timeout", arguments.timeout,
                 "Deadline of a request from when it was due [none]")
      ->group("Limits");
  app.add_option("--drain", arguments.drain,
                 "How long the last answers may take before they are given up")
      ->group("Limits")
      ->capture_default_str();
}

void describe_search(CLI::App& app, LoadArguments& arguments) {
  app.add_option("--target", arguments.targets,
                 "What to keep: p99=200ms (whole meshes), header-p50=20ms, "
                 "first-chunk-p99.9=50ms; may be repeated")
      ->group("Targets");
  app.add_flag("--find-rate", arguments.find_rate,
               "Search the highest rate that keeps the targets, from --rate on [half of what "
               "one worker gets]")
      ->group("Targets");
  app.add_option("--trials", arguments.trials,
                 "The majority of so many trials decides on a rate")
      ->group("Targets")
      ->capture_default_str()
      ->check(CLI::Range(1, 99));
  app.add_option("--precision", arguments.precision,
                 "How near the lowest rate that fails must come to the answer")
      ->group("Targets")
      ->capture_default_str()
      ->check(CLI::Range(0.001, 1.0));
}

/// Sets `time` from text unless it is empty.
absl::Status set_time(const std::string& option, const std::string& text, Nanoseconds& time) {
  if (text.empty()) return absl::OkStatus();
  const absl::StatusOr<Nanoseconds> parsed = parse_time(text);
  if (!parsed.ok()) {
    return absl::InvalidArgumentError(absl::StrCat(option, ": ", parsed.status().message()));
  }
  time = *parsed;
  return absl::OkStatus();
}

absl::Status check_together(const LoadArguments& arguments) {
  const auto refuse = [](const char* message) { return absl::InvalidArgumentError(message); };
  if (arguments.mix.grids.empty() && arguments.mix_file.empty()) {
    return refuse("nothing to mesh: give a GRID or --mix");
  }
  if (!arguments.rate.empty() && arguments.workers > 0) {
    return refuse("--rate and --workers exclude each other");
  }
  if (arguments.find_rate && arguments.workers > 0) {
    return refuse("--find-rate searches a rate; --workers has none");
  }
  if (arguments.find_rate && arguments.targets.empty()) {
    return refuse("--find-rate needs a --target, e.g. p99=200ms");
  }
  if (arguments.find_rate && arguments.trials % 2 == 0) {
    return refuse("--trials must be odd, or there may be no majority");
  }
  if (!arguments.find_rate && arguments.rate.empty() && arguments.workers == 0) {
    return refuse("how many requests? give --rate, --workers or --find-rate");
  }
  return absl::OkStatus();
}

absl::Status set_times(const LoadArguments& arguments, Nanoseconds& duration, LoadPlan& plan) {
  Nanoseconds warm_up = from_seconds(plan.warm_up_seconds), timeout{0};
  absl::Status status = set_time("--duration", arguments.duration, duration);
  if (status.ok()) status = set_time("--warm-up", arguments.warm_up, warm_up);
  if (status.ok()) status = set_time("--timeout", arguments.timeout, timeout);
  if (status.ok()) status = set_time("--drain", arguments.drain, plan.drain);
  if (status.ok() && duration.count() == 0) {
    status = absl::InvalidArgumentError("--duration 0 measures nothing");
  }
  plan.warm_up_seconds = to_seconds(warm_up);
  if (timeout.count() > 0) plan.timeout = timeout;
  return status;
}

absl::StatusOr<LoadPlan> understand_plan(const LoadArguments& arguments) {
  LoadPlan plan;
  Nanoseconds duration = std::chrono::seconds(arguments.find_rate ? 10 : 30);
  if (absl::Status status = set_times(arguments, duration, plan); !status.ok()) return status;
  std::vector<double> rates{1};  // of workers, who ask when they can
  if (!arguments.rate.empty()) {
    const absl::StatusOr<std::vector<double>> parsed = parse_rates(arguments.rate);
    if (!parsed.ok()) return parsed.status();
    rates = *parsed;
  }
  for (const double rate : rates) plan.steps.push_back({rate, to_seconds(duration)});
  plan.process =
      arguments.arrivals == "poisson" ? ArrivalProcess::kPoisson : ArrivalProcess::kConstant;
  plan.burst = arguments.burst;
  plan.workers = arguments.workers;
  plan.max_outstanding = std::max(arguments.max_outstanding, arguments.workers);
  plan.max_queued = arguments.max_queued;
  plan.seed = arguments.seed;
  return plan;
}

absl::StatusOr<std::vector<MixArguments>> understand_mix(const LoadArguments& arguments) {
  std::vector<MixArguments> mix;
  if (!arguments.mix_file.empty()) {
    absl::StatusOr<std::vector<MixArguments>> lines = read_mix_file(arguments.mix_file);
    if (!lines.ok()) return lines.status();
    mix = *std::move(lines);
  }
  if (!arguments.mix.grids.empty()) mix.push_back(arguments.mix);
  return mix;
}

}  // namespace

void describe_load(CLI::App& app, LoadArguments& arguments) {
  app.footer(kExamples);
  describe_server(app, arguments.server)->capture_default_str();
  describe_mix(app, arguments.mix);
  app.add_option("--mix", arguments.mix_file,
                 "File of requests, one a line, with the options above");
  describe_arrivals(app, arguments);
  describe_limits(app, arguments);
  describe_search(app, arguments);
  app.add_option("--connections", arguments.stream.connections, "Connections that take turns")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  const auto ask_for = [&](v1::Encoding encoding) {
    return [&arguments, encoding] { arguments.stream.encoding = encoding; };
  };
  auto* const packed = app.add_flag_callback("--packed", ask_for(v1::ENCODING_PACKED),
                                             "Ask for packed chunks, four bytes a tet");
  app.add_flag_callback("--compact", ask_for(v1::ENCODING_COMPACT),
                        "Ask for the compact encoding, half a byte a tet")
      ->excludes(packed);
  app.add_flag("--check", arguments.stream.check_columns, "Verify the checksum of every chunk");
  app.add_option("--json", arguments.json, "File for all figures; docs/load.md has the keys");
  app.add_flag("--quiet", arguments.quiet, "Only the report, no view of what goes on");
}

absl::StatusOr<LoadOptions> understand_load(const LoadArguments& arguments) {
  if (absl::Status status = check_together(arguments); !status.ok()) return status;
  LoadOptions options;
  options.stream = arguments.stream;
  options.stream.address = arguments.server.address;
  auto channel = understand_server(arguments.server);
  if (!channel.ok()) return channel.status();
  options.stream.channel = *std::move(channel);
  options.json = arguments.json;
  options.quiet = arguments.quiet;
  auto mix = understand_mix(arguments);
  if (!mix.ok()) return mix.status();
  options.mix = *std::move(mix);
  auto plan = understand_plan(arguments);
  if (!plan.ok()) return plan.status();
  options.plan = *std::move(plan);
  for (const std::string& text : arguments.targets) {
    const absl::StatusOr<LatencyGoal> goal = parse_goal(text);
    if (!goal.ok()) return goal.status();
    options.goals.push_back(*goal);
  }
  if (!arguments.find_rate) return options;
  options.search = SearchPlan{.trials = arguments.trials, .precision = arguments.precision};
  options.search->start_per_second =
      arguments.rate.empty() ? 0 : options.plan.steps.front().per_second;
  return options;
}

}  // namespace tet::load
