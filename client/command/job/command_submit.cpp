// `tetstream job submit`
#include <memory>
#include <sstream>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "client/command/job/job_commands.h"
#include "client/command/job/job_json.h"
#include "client/command/job/job_session.h"
#include "client/command/job/manifest.h"
#include "client/command/job/submit_jobs.h"
#include "client/library/text_file.h"
#include "core/base/printable.h"

namespace tet {
namespace {

constexpr const char* kSubmitExamples = R"(
A line for each job that the server keeps from then on, whatever happens: its name and its input.

Interrupted, or the network broke? Run the same command again. What was submitted is in a journal,
so that only the rest is sent and nothing is submitted twice; when all is submitted the journal is
deleted, and the same command makes new jobs. With --journal FILE it is kept: whatever is submitted
with it, each job is made once.

A manifest has a job on each line, as on the command line or as JSON; what a line does not say is
taken from the command:
  bunny.vdb --levels 0 --label part=ear
  {"input": "bunny.vdb", "improve": true, "label": {"part": "ear"}, "max_attempts": 5}

Examples:
  tetstream job submit scans/*.vdb --label night=monday --server farm:7447
  tetstream job submit bunny.vdb --improve --priority 10 --ttl 12h --server farm:7447
  tetstream job submit --manifest jobs.txt --journal monday.jsonl --server farm:7447
  tetstream job submit *.vdb --json --server farm:7447 | jq -r .name
)";

struct SubmitArguments {
  SessionArguments session;
  JobArguments job;  ///< for all of them
  std::vector<std::string> inputs;
  std::string manifest, journal;
  int parallel = 4;
};

void describe_options(CLI::App& app, SubmitArguments& arguments) {
  app.footer(kSubmitExamples);
  app.add_option(
      "INPUT", arguments.inputs,
      ".vdb volumes, closed .obj, .stl or .ply surfaces, .json scenes, or digests of stored "
      "grids");
  app.add_option("--manifest", arguments.manifest, "File with a job on each line; - reads it");
  app.add_option("--journal", arguments.journal,
                 "What is submitted already [in ~/.local/state/tetstream, until all is]");
  app.add_option("--parallel", arguments.parallel, "Jobs submitted at once [4]")
      ->check(CLI::Range(1, 64));
  describe_job(app, arguments.job);
  describe_session(app, arguments.session);
  app.parse_complete_callback([&arguments] {
    if (arguments.inputs.empty() && arguments.manifest.empty())
      throw CLI::RequiredError("an INPUT or --manifest");
  });
}

absl::StatusOr<std::vector<JobArguments>> manifest_jobs(const SubmitArguments& arguments,
                                                        const Cancellation& interruption) {
  if (arguments.manifest.empty()) return std::vector<JobArguments>();
  const absl::StatusOr<std::string> text =
      arguments.manifest == "-" ? read_standard_input(interruption)
                                : read_text_file(arguments.manifest, interruption);
  if (!text.ok()) return text.status();
  std::istringstream lines(*text);
  return read_manifest(lines, arguments.manifest, arguments.job);
}

absl::StatusOr<std::vector<JobOrder>> understand_orders(const SubmitArguments& arguments,
                                                        const Cancellation& interruption) {
  auto jobs = manifest_jobs(arguments, interruption);
  if (!jobs.ok()) return jobs.status();
  for (const std::string& input : arguments.inputs) {
    jobs->push_back(arguments.job);
    jobs->back().input = input;
  }
  std::vector<JobOrder> orders;
  for (const JobArguments& job : *jobs) {
    auto order = understand_job(job);
    if (!order.ok()) return order.status();
    orders.push_back(*std::move(order));
  }
  if (orders.empty())
    return absl::InvalidArgumentError(absl::StrCat(arguments.manifest, " has no jobs"));
  return orders;
}

absl::StatusOr<std::unique_ptr<Journal>> open_journal(const SubmitArguments& arguments,
                                                      const std::vector<JobOrder>& orders) {
  const std::string& server = arguments.session.server.address;
  if (!arguments.journal.empty()) return Journal::open(arguments.journal, server);
  const auto path = default_journal_path(server, orders);
  if (!path.ok()) return path.status();
  return Journal::open(*path, server);
}

SubmitWatch watch_for(JobSession& session, std::size_t total) {
  return {
      .submitted =
          [&](const SubmittedJob& job) {
            session.print({{"name", job.name},
                           {"input", job.order.input.path},
                           {"request_id", job.request_id},
                           {"submitted_before", job.before}},
                          for_terminal(absl::StrCat(job.name, "  ", job.order.input.path)));
          },
      .refused = [&](const JobOrder& order,
                     const absl::Status& status) { session.failed(order.input.path, status); },
      .progress = [&session, total](
                      double jobs) { session.bar.update(jobs, static_cast<double>(total)); },
      .say = [&](const std::string& line) { session.bar.say_lines(line, stderr); }};
}

/// What went wrong, and what to do about it.
absl::Status outcome_of(const SubmitResult& result,
                        const Journal& journal,
                        const JobSession& session,
                        std::size_t total) {
  const auto& [submitted, before, refused] = result.counts;
  const absl::Status& cause = result.status.ok() ? session.outcome(total) : result.status;
  if (cause.ok()) return cause;
  absl::Status told(
      cause.code(),
      absl::StrFormat("%s; %d of %d submitted: run it again for the rest (the journal is %s)",
                      cause.message(), submitted + before, total, journal.path()));
  cause.ForEachPayload([&](auto url, const auto& bytes) { told.SetPayload(url, bytes); });
  return told;
}

absl::Status run_submit(const SubmitArguments& arguments, const Cancellation& interruption) {
  const auto orders = understand_orders(arguments, interruption);
  if (!orders.ok()) return orders.status();
  const auto session = JobSession::open(arguments.session);
  if (!session.ok()) return session.status();
  const auto journal = open_journal(arguments, *orders);
  if (!journal.ok()) return journal.status();

  (*session)->bar.begin("submitting", "jobs");
  const SubmitResult result =
      submit_jobs(*orders, {(*session)->meshes, (*session)->jobs}, **journal,
                  arguments.parallel, watch_for(**session, orders->size()), interruption);
  const absl::Status outcome = outcome_of(result, **journal, **session, orders->size());
  if (outcome.ok() && arguments.journal.empty()) (*journal)->remove();
  return outcome;
}

}  // namespace

Command add_submit_command(CLI::App& app) {
  const auto arguments = std::make_shared<SubmitArguments>();
  describe_options(app, *arguments);
  return [arguments](const Cancellation& interruption) {
    return run_submit(*arguments, interruption);
  };
}

}  // namespace tet
