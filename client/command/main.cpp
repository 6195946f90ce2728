// tetstream: VDB volumes and closed surfaces in, tetrahedral meshes out.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "client/command/arguments/did_you_mean.h"
#include "client/command/arguments/empty_values.h"
#include "client/command/command.h"
#include "client/command/process/abandonable.h"
#include "client/command/process/exit_code.h"
#include "client/command/process/interruption.h"
#include "client/library/error_details.h"
#include "core/base/bare_option.h"
#include "core/base/contain.h"
#include "core/base/parallel.h"
#include "core/base/posix/printed.h"
#include "core/base/printable.h"
#include "core/manual/write_manual.h"
#include "proto/wire/transport.h"

namespace tet {
namespace {

constexpr const char* kAbout =
    "Turns OpenVDB volumes and closed surfaces into tetrahedral meshes, here or on a server.";

constexpr const char* kExamples = R"(
Examples:
  tetstream info bunny.vdb                      what is in the file
  tetstream mesh bunny.vdb -o bunny.vtu         mesh it in this process
  tetstream mesh bunny.vdb -o bunny.vtu --server localhost:7447
  tetstream convert part.stl part.vdb --voxel 0.5
  tetstream job submit *.vdb --server farm:7447  meshes for later; `tetstream job --help`
  tetstream mesh --help                         all options, with examples

Exit codes:
  0 done    1 the input or request was refused, or the output cannot be written
  2 usage   3 the server or the network failed    130 stopped by Ctrl-C (128 + signal)
)";

struct NamedCommand {
  CLI::App* app;
  Command run;
};

std::vector<NamedCommand> add_commands(CLI::App& app) {
  const auto add = [&](const char* name, const char* about, Command (*describe)(CLI::App&)) {
    CLI::App* command = app.add_subcommand(name, about);
    return NamedCommand{command, describe(*command)};
  };
  return {
      add("mesh", "Mesh a .vdb grid, an image or a closed surface", add_mesh_command),
      add("report", "Draw a page of a mesh's report", add_report_command),
      add("transfer", "Put one mesh's arrays on another mesh", add_transfer_command),
      add("sample", "Tell phi and fields at points", add_sample_command),
      add("estimate", "Count a mesh, and tell what it takes", add_estimate_command),
      add("info", "List the grids of a .vdb file, or what an image holds", add_info_command),
      add("convert", "Make a .vdb level set of a surface", add_convert_command),
      add("formats", "List the mesh files that can be written", add_formats_command),
      add("health", "Ask a server whether it is serving", add_health_command),
      add("job", "Meshes made while nobody waits: submit, follow, fetch", add_job_command)};
}

/// With the name of the call in the server's log, where there is one.
std::string message_of(const absl::Status& status) {
  const std::string request = request_id_of(status);
  std::string message(status.message());
  return request.empty() ? message : message + " (request " + request + ")";
}

/// What libraries throw ends like every other failure: with a line and a code.
absl::Status run_contained(const Command& command, const Cancellation& interruption) {
  try {
    return command(interruption);
  } catch (...) {
    return absl::InternalError("it failed in a way that nobody foresaw, please report it: " +
                               words_of_exception());
  }
}

int run(const NamedCommand& command, const Cancellation& interruption) {
  const absl::Status status = run_contained(command.run, interruption);
  if (status.ok()) return static_cast<int>(ExitCode::kDone);
  std::fprintf(stderr, "tetstream %s: %s\n", command.app->get_name().c_str(),
               for_terminal(message_of(status)).c_str());
  if (const int signal = interrupting_signal(); signal != 0) {
    // What was left behind still runs, and would keep the process.
    if (has_abandoned_work()) std::_Exit(128 + signal);
    return 128 + signal;
  }
  return static_cast<int>(exit_code_of(status.code()));
}

/// Help and the version are "errors" too; an option that does not exist is told before one that
/// is missing.
int report_parse_error(CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) {
    app.exit(error);
    return static_cast<int>(ExitCode::kDone);
  }
  std::string message = error.what();
  for (const std::string& rest : app.remaining(true)) {
    if (rest.starts_with("-")) message = "unknown option " + rest;
  }
  if (const std::string unknown = unknown_command(app); !unknown.empty()) message = unknown;
  std::fprintf(stderr, "tetstream: %s; try tetstream --help\n", for_terminal(message).c_str());
  return static_cast<int>(ExitCode::kUsage);
}

int run_command_line(int argc, char** argv) {
  CLI::App app(kAbout, "tetstream");
  app.footer(kExamples);
  app.set_version_flag("--version", "tetstream " TETSTREAM_VERSION);
  add_manual_option(app, "1", "tetstream " TETSTREAM_VERSION);
  app.require_subcommand(1);
  const std::vector<NamedCommand> commands = add_commands(app);
  refuse_empty_values(app);
  try {
    const std::string empty = option_without_value({argv + std::min(argc, 1), argv + argc});
    if (!empty.empty()) throw CLI::ValidationError(no_value_message(empty));
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return report_parse_error(app, error);
  }
  for (const NamedCommand& command : commands) {
    if (command.app->parsed()) return run(command, watch_for_interruption());
  }
  return static_cast<int>(ExitCode::kUsage);
}

}  // namespace
}  // namespace tet

int main(int argc, char** argv) {
  const tet::WorkerThreads workers;
  tet::keep_read_blocks();
  tet::quieten_grpc();
  return tet::exit_code_of_printed(tet::run_command_line(argc, argv), "tetstream");
}
