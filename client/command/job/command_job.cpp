// `tetstream job`: meshes that are made while nobody waits.
#include <memory>
#include <vector>

#include <CLI/CLI.hpp>

#include "client/command/command.h"
#include "client/command/job/job_commands.h"

namespace tet {
namespace {

constexpr const char* kJobExamples = R"(
A night's work:
  tetstream job submit scans/*.vdb --server farm:7447 --label night=monday
      interrupted? The same command again submits what is missing, and nothing twice
  tetstream job wait --label night=monday --server farm:7447
      until all are finished; exits with 0 if all succeeded
  tetstream job fetch --label night=monday --into meshes --server farm:7447
      a mesh file each; again fetches what is missing

With --json every command writes one object a line, for programs; docs/jobs.md has the keys.
`tetstream job COMMAND --help` has all options of one, with examples.
)";

struct NamedCommand {
  CLI::App* app;
  Command run;
};

}  // namespace

Command add_job_command(CLI::App& app) {
  app.footer(kJobExamples);
  app.require_subcommand(1);
  const auto commands = std::make_shared<std::vector<NamedCommand>>();
  const auto add = [&](const char* name, const char* about, Command (*describe)(CLI::App&)) {
    CLI::App* command = app.add_subcommand(name, about);
    commands->push_back({command, describe(*command)});
  };
  add("submit", "Submit jobs: files, or a manifest", add_submit_command);
  add("list", "List jobs, the newest first", add_list_command);
  add("show", "Tell all about jobs", add_show_command);
  add("watch", "Tell what happens to jobs, while it happens", add_watch_command);
  add("wait", "Wait until jobs are finished", add_wait_command);
  add("cancel", "Stop jobs", add_cancel_command);
  add("retry", "Try again what failed or was stopped", add_retry_command);
  add("fetch", "Write the meshes of jobs that succeeded", add_fetch_command);
  add("delete", "Forget jobs and their results", add_delete_command);
  add("workers", "List who does the jobs, for whoever runs the servers", add_workers_command);
  return [commands](const Cancellation& interruption) {
    for (const NamedCommand& command : *commands) {
      if (command.app->parsed()) return command.run(interruption);
    }
    return absl::InternalError("no such command");
  };
}

}  // namespace tet
