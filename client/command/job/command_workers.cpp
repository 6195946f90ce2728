// `tetstream job workers`
#include <memory>

#include <CLI/CLI.hpp>

#include "client/command/job/job_commands.h"
#include "client/command/job/job_json.h"
#include "client/command/job/job_session.h"
#include "client/command/job/job_text.h"

namespace tet {
namespace {

constexpr const char* kWorkersExamples = R"(
Examples:
  tetstream job workers --server farm:7447
  tetstream job workers --json --server farm:7447 | jq -r 'select(.state != "WORKING") | .name'

Shards are named where their jobs are of your namespace, and counted where they are others'.
With tokens it takes one that has the scope workers.read.
)";

absl::Status run_workers(const SessionArguments& arguments, const Cancellation& interruption) {
  const auto session = JobSession::open(arguments);
  if (!session.ok()) return session.status();
  const auto known = (*session)->jobs.workers(interruption);
  if (!known.ok()) return known.status();
  if (!(*session)->json) (*session)->bar.say(workers_header(), stdout);
  for (const v1::Worker& worker : known->workers()) {
    (*session)->print(as_json(worker), table_line(worker, known->read_time()));
  }
  return absl::OkStatus();
}

}  // namespace

Command add_workers_command(CLI::App& app) {
  const auto arguments = std::make_shared<SessionArguments>();
  app.footer(kWorkersExamples);
  describe_session(app, *arguments);
  return [arguments](const Cancellation& interruption) {
    return run_workers(*arguments, interruption);
  };
}

}  // namespace tet
