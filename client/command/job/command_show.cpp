// `tetstream job show`
#include <memory>

#include <CLI/CLI.hpp>
#include <absl/strings/strip.h>

#include "client/command/job/job_commands.h"
#include "client/command/job/job_json.h"
#include "client/command/job/job_session.h"
#include "client/command/job/job_text.h"

namespace tet {
namespace {

constexpr const char* kShowExamples = R"(
Examples:
  tetstream job show jobs/019310c2a5d84f6b8e7a2c11 --server farm:7447
  tetstream job show --state failed --json --server farm:7447 | jq .dead_shards
)";

struct ShowArguments {
  SessionArguments session;
  SelectionArguments selection;
};

absl::Status show_job(JobSession& session,
                      const std::string& name,
                      const Cancellation& cancellation) {
  const auto job = session.jobs.get(name, cancellation);
  if (!job.ok()) return job.status();
  std::vector<v1::DeadShard> dead;
  if (job->progress().dead_shards() > 0) {
    auto shards = session.jobs.dead_shards(name, cancellation);
    if (!shards.ok()) return shards.status();
    dead = *std::move(shards);
  }
  auto json = as_json(*job);
  json["dead_shards"] = nlohmann::ordered_json::array();
  for (const v1::DeadShard& shard : dead) json["dead_shards"].push_back(as_json(shard));
  session.print(json, std::string(absl::StripSuffix(description_of(*job, dead), "\n")));
  return absl::OkStatus();
}

absl::Status run_show(const ShowArguments& arguments, const Cancellation& interruption) {
  const auto session = JobSession::open(arguments.session);
  if (!session.ok()) return session.status();
  return for_each_selected(
      **session, arguments.selection,
      [&](const std::string& name) { return show_job(**session, name, interruption); },
      interruption);
}

}  // namespace

Command add_show_command(CLI::App& app) {
  const auto arguments = std::make_shared<ShowArguments>();
  app.footer(kShowExamples);
  describe_selection(app, arguments->selection);
  describe_session(app, arguments->session);
  return [arguments](const Cancellation& interruption) {
    return run_show(*arguments, interruption);
  };
}

}  // namespace tet
