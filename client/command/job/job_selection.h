// Which jobs a command is about: by name, by what they are like, or by the journal they came
// from.
#pragma once

#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "client/library/job_client.h"
#include "core/base/cancel.h"

namespace CLI {
class App;
}

namespace tet {

/// What jobs are like, before it is understood.
struct FilterArguments {
  std::vector<std::string> states;
  std::vector<std::string> labels;  ///< KEY=VALUE
  std::string name_prefix;
  std::string since, until;  ///< a time, or how long ago

  bool empty() const;
};

/// Adds --state, --label, --name, --since and --until.
void describe_filter(CLI::App& app, FilterArguments& arguments);

/// Errors: kInvalidArgument.
absl::StatusOr<v1::JobFilter> understand_filter(const FilterArguments& arguments);

struct SelectionArguments {
  std::vector<std::string> names;  ///< `jobs/{id}` or the id; "-" reads them
  FilterArguments filter;
  std::string journal;
  bool all = false;
};

/// Adds the names and all that can stand for them. Selecting nothing is a usage error, and so
/// is naming jobs, themselves or by a journal, and choosing them by what they are like at once.
void describe_selection(CLI::App& app, SelectionArguments& arguments);

/// The names of the jobs, each once. Those that are read come one a line: as the line's first
/// word, or as `name` or `job` of a JSON object. Errors: kInvalidArgument, and the server's.
absl::StatusOr<std::vector<std::string>> select_jobs(JobClient& client,
                                                     const SelectionArguments& arguments,
                                                     const Cancellation& cancellation);

/// Whether there is any of them, for commands that are about what somebody expects to be there;
/// --all may be none. Errors: kNotFound, with what was asked for.
absl::Status check_any(const std::vector<std::string>& names,
                       const SelectionArguments& arguments);

/// Calls `see` with every job, the newest first.
absl::Status for_each_job(JobClient& client,
                          const v1::JobFilter& filter,
                          const std::function<void(const v1::Job&)>& see,
                          const Cancellation& cancellation);

}  // namespace tet
