// tetstream-load: drives a running tetstreamd and measures how it answers.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>
#include <absl/strings/str_cat.h>
#include <absl/time/clock.h>
#include <absl/time/time.h>

#include "bench/load/live_view.h"
#include "bench/load/load_options.h"
#include "bench/load/load_report.h"
#include "bench/load/run_load.h"
#include "bench/load/search_load.h"
#include "bench/load/stream_sender.h"
#include "bench/load/units.h"
#include "client/command/arguments/empty_values.h"
#include "client/command/process/exit_code.h"
#include "client/command/process/interruption.h"
#include "core/base/bare_option.h"
#include "core/base/parallel.h"
#include "core/base/posix/atomic_file.h"
#include "core/base/posix/printed.h"
#include "core/base/printable.h"
#include "core/manual/write_manual.h"
#include "proto/wire/transport.h"

namespace tet::load {
namespace {

constexpr const char* kAbout =
    "Sends mesh requests to a tetstreamd at a chosen rate, and measures how it answers.";

LoadSetting setting_of(const LoadOptions& options, const RequestMix& mix) {
  return {options.stream.address,
          absl::FormatTime(absl::RFC3339_sec, absl::Now(), absl::UTCTimeZone()), mix.entries(),
          options.goals, options.stream.encoding};
}

absl::Status write_report(const std::string& text,
                          const std::string& json_path,
                          const std::string& json) {
  std::fputs(lines_for_terminal(text).c_str(), stdout);
  std::fflush(stdout);
  return json_path.empty() ? absl::OkStatus() : write_text_file(json_path, json);
}

/// What the exit code says of a run that was reported.
absl::Status outcome_of(const LoadSetting& setting, const LoadResult& result) {
  const Tally& total = result.total;
  if (result.interrupted) return absl::CancelledError("stopped; reported what was measured");
  if (total.done == 0 && !total.error_messages.empty()) {
    const auto& [code, message] = *total.error_messages.begin();
    return absl::Status(code, absl::StrCat("every request failed: ", message));
  }
  for (const LatencyGoal& goal : setting.goals) {
    if (total.holds(goal)) continue;
    return absl::FailedPreconditionError(absl::StrCat(show_goal(goal), " was missed"));
  }
  return absl::OkStatus();
}

absl::Status run_once(const LoadOptions& options,
                      RequestMix& mix,
                      RequestSender& sender,
                      const Cancellation& interruption) {
  const LoadSetting setting = setting_of(options, mix);
  std::optional<LoadResult> result;
  {
    LiveView view(absl::StrCat("tetstream-load ", options.stream.address, ": ",
                               describe_plan(options.plan)),
                  options.quiet);
    result = run_load(options.plan, mix, sender, interruption, view.watch());
  }
  const absl::Status written =
      write_report(report_text(setting, *result), options.json, report_json(setting, *result));
  return written.ok() ? outcome_of(setting, *result) : written;
}

absl::Status run_search(const LoadOptions& options,
                        RequestMix& mix,
                        RequestSender& sender,
                        const Cancellation& interruption) {
  const LoadSetting setting = setting_of(options, mix);
  std::optional<LiveView> view;
  const SearchWatch watch{
      .begin_trial =
          [&](double per_second) {
            const std::string what =
                per_second > 0 ? absl::StrCat("a trial at ", show_number(per_second), "/s")
                               : "one worker, to see where to begin";
            view.emplace(absl::StrCat("tetstream-load ", options.stream.address, ": ", what),
                         options.quiet);
            return view->watch();
          },
      .end_trial =
          [&](const Trial& trial) {
            view.reset();
            if (!options.quiet) std::fprintf(stderr, "%s\n", trial_line(trial).c_str());
          }};
  auto found = search_load(*options.search, {options.plan, options.goals}, mix, sender,
                           interruption, watch);
  view.reset();
  if (!found.ok()) return found.status();
  const absl::Status written =
      write_report(search_text(setting, *found), options.json, search_json(setting, *found));
  if (!written.ok()) return written;
  if (found->search.interrupted)
    return absl::CancelledError("stopped; reported what was known");
  if (found->search.per_second) return absl::OkStatus();
  return absl::FailedPreconditionError("no rate was found that holds every target");
}

absl::Status run(const LoadOptions& options, const Cancellation& interruption) {
  if (!options.json.empty()) {
    if (absl::Status status = check_can_create(options.json); !status.ok()) return status;
  }
  const auto client = MeshClient::connect(options.stream.address, options.stream.channel);
  if (!client.ok()) return client.status();
  std::optional<RequestMix> mix;
  {
    ProgressBar bar;
    auto prepared = prepare_mix(options.mix, **client, bar, interruption);
    if (!prepared.ok()) return prepared.status();
    mix = *std::move(prepared);
  }
  const auto sender = open_stream_sender(options.stream);
  if (!sender.ok()) return sender.status();
  return options.search ? run_search(options, *mix, **sender, interruption)
                        : run_once(options, *mix, **sender, interruption);
}

int fail(const absl::Status& status, int exit_code) {
  const std::string message = for_terminal(std::string(status.message()));
  std::fprintf(stderr, "tetstream-load: %s\n", message.c_str());
  return exit_code;
}

/// Help and the version are "errors" too.
int report_parse_error(CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) {
    app.exit(error);
    return static_cast<int>(ExitCode::kDone);
  }
  std::fprintf(stderr, "tetstream-load: %s; try tetstream-load --help\n",
               for_terminal(error.what()).c_str());
  return static_cast<int>(ExitCode::kUsage);
}

int run_command_line(int argc, char** argv) {
  CLI::App app(kAbout, "tetstream-load");
  app.set_version_flag("--version", "tetstream-load " TETSTREAM_VERSION);
  add_manual_option(app, "1", "tetstream " TETSTREAM_VERSION);
  LoadArguments arguments;
  describe_load(app, arguments);
  refuse_empty_values(app);
  try {
    const std::string empty = option_without_value({argv + std::min(argc, 1), argv + argc});
    if (!empty.empty()) throw CLI::ValidationError(no_value_message(empty));
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return report_parse_error(app, error);
  }
  const absl::StatusOr<LoadOptions> options = understand_load(arguments);
  if (!options.ok()) {
    const bool usage = absl::IsInvalidArgument(options.status());
    return fail(options.status(),
                static_cast<int>(usage ? ExitCode::kUsage : ExitCode::kRefused));
  }
  const absl::Status status = run(*options, watch_for_interruption());
  if (const int signal = interrupting_signal(); signal != 0) return fail(status, 128 + signal);
  if (status.ok()) return static_cast<int>(ExitCode::kDone);
  return fail(status, static_cast<int>(exit_code_of(status.code())));
}

}  // namespace
}  // namespace tet::load

int main(int argc, char** argv) {
  const tet::WorkerThreads workers;
  tet::quieten_grpc();
  return tet::exit_code_of_printed(tet::load::run_command_line(argc, argv), "tetstream-load");
}
