// `tetstream job list`
#include <cstdint>
#include <limits>
#include <memory>

#include <CLI/CLI.hpp>

#include "client/command/job/job_commands.h"
#include "client/command/job/job_json.h"
#include "client/command/job/job_session.h"
#include "client/command/job/job_text.h"

namespace tet {
namespace {

constexpr const char* kListExamples = R"(
Examples:
  tetstream job list --server farm:7447
  tetstream job list --state failed --since 12h --server farm:7447
  tetstream job list --label night=monday --json --server farm:7447 | jq -r .display_name
)";

struct ListArguments {
  SessionArguments session;
  FilterArguments filter;
};

absl::Status run_list(const ListArguments& arguments, const Cancellation& interruption) {
  const auto filter = understand_filter(arguments.filter);
  if (!filter.ok()) return filter.status();
  const auto session = JobSession::open(arguments.session);
  if (!session.ok()) return session.status();
  bool first = true;
  return for_each_job((*session)->jobs, *filter,
                      [&](const v1::Job& job) {
                        if (first && !(*session)->json)
                          (*session)->bar.say(table_header(), stdout);
                        first = false;
                        (*session)->print(as_json(job), table_line(job));
                      },
                      interruption);
}

}  // namespace

Command add_list_command(CLI::App& app) {
  const auto arguments = std::make_shared<ListArguments>();
  app.footer(kListExamples);
  describe_filter(app, arguments->filter);
  describe_session(app, arguments->session);
  return [arguments](const Cancellation& interruption) {
    return run_list(*arguments, interruption);
  };
}

}  // namespace tet
