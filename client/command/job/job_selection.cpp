#include "client/command/job/job_selection.h"

#include <algorithm>
#include <set>
#include <utility>

#include <CLI/CLI.hpp>
#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_join.h>
#include <absl/strings/str_split.h>
#include <absl/time/clock.h>
#include <absl/time/time.h>
#include <nlohmann/json.hpp>

#include "client/command/job/job_json.h"
#include "client/command/job/journal.h"
#include "client/library/text_file.h"
#include "proto/convert/times.h"

namespace tet {
namespace {

constexpr const char* kWhichJobs = "Which jobs";
constexpr int kPage = 1000;

std::vector<std::string> state_names() {
  std::vector<std::string> names;
  for (int state = v1::JobState_MIN + 1; state <= v1::JobState_MAX; ++state) {
    names.push_back(absl::AsciiStrToLower(name_of(static_cast<v1::JobState>(state))));
  }
  return names;
}

absl::StatusOr<google::protobuf::Timestamp> parse_moment(const char* option,
                                                         const std::string& text) {
  absl::Duration ago;
  absl::Time time;
  std::string why;
  if (absl::ParseDuration(text, &ago)) {
    time = absl::Now() - ago;
  } else if (!absl::ParseTime(absl::RFC3339_full, text, &time, &why)) {
    return absl::InvalidArgumentError(absl::StrCat(
        option, " ", text, " is neither how long ago (90m) nor a time (2026-01-31T18:00:00Z)"));
  }
  if (time < earliest_time() || time > latest_time()) {
    return absl::InvalidArgumentError(
        absl::StrCat(option, " ", text, " is not in the years 1 to 9999"));
  }
  return to_proto(absl::FromUnixSeconds(absl::ToUnixSeconds(time)));
}

/// The name that a line begins with, or that its object holds.
std::string name_in(const std::string& line) {
  const auto json = nlohmann::json::parse(line, nullptr, false);
  for (const char* key : {"name", "job"}) {
    if (json.is_object() && json.contains(key) && json[key].is_string()) {
      return json[key].get<std::string>();
    }
  }
  const std::vector<std::string> words =
      absl::StrSplit(line, absl::ByAnyChar(" \t\r"), absl::SkipEmpty());
  return words.empty() ? "" : words.front();
}

std::vector<std::string> names_in(const std::string& text) {
  std::vector<std::string> names;
  for (const absl::string_view line : absl::StrSplit(text, '\n')) {
    if (std::string name = name_in(std::string(line)); !name.empty())
      names.push_back(std::move(name));
  }
  return names;
}

std::string full_name(const std::string& name) {
  return absl::StartsWith(name, "jobs/") ? name : absl::StrCat("jobs/", name);
}

std::vector<std::string> each_once(const std::vector<std::string>& names) {
  std::set<std::string> seen;
  std::vector<std::string> once;
  for (const std::string& name : names) {
    if (seen.insert(name).second) once.push_back(name);
  }
  return once;
}

absl::StatusOr<std::vector<std::string>> named_jobs(const SelectionArguments& arguments,
                                                    const Cancellation& cancellation) {
  std::vector<std::string> names;
  for (const std::string& name : arguments.names) {
    if (name != "-") {
      names.push_back(full_name(name));
      continue;
    }
    const absl::StatusOr<std::string> text = read_standard_input(cancellation);
    if (!text.ok()) return text.status();
    for (const std::string& read : names_in(*text)) names.push_back(full_name(read));
  }
  if (arguments.journal.empty()) return names;
  const auto journal = jobs_of_journal(arguments.journal);
  if (!journal.ok()) return journal.status();
  names.insert(names.end(), journal->begin(), journal->end());
  return names;
}

}  // namespace

bool FilterArguments::empty() const {
  return states.empty() && labels.empty() && name_prefix.empty() && since.empty() &&
         until.empty();
}

void describe_filter(CLI::App& app, FilterArguments& arguments) {
  app.add_option("--state", arguments.states, "In this state; may be repeated")
      ->transform(CLI::IsMember(state_names(), CLI::ignore_case))
      ->allow_extra_args(false)
      ->group(kWhichJobs);
  app.add_option("--label", arguments.labels, "With this label; may be repeated")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false)
      ->group(kWhichJobs);
  app.add_option("--name", arguments.name_prefix, "Whose name begins like this")
      ->group(kWhichJobs);
  app.add_option("--since", arguments.since,
                 "Made since then: 90m (ago) or 2026-01-31T18:00:00Z")
      ->type_name("TIME")
      ->group(kWhichJobs);
  app.add_option("--until", arguments.until, "Made before then")
      ->type_name("TIME")
      ->group(kWhichJobs);
}

absl::StatusOr<v1::JobFilter> understand_filter(const FilterArguments& arguments) {
  v1::JobFilter filter;
  for (const std::string& state : arguments.states) {
    v1::JobState parsed = v1::JOB_STATE_UNSPECIFIED;
    v1::JobState_Parse("JOB_STATE_" + absl::AsciiStrToUpper(state), &parsed);
    filter.add_states(parsed);
  }
  for (const std::string& label : arguments.labels) {
    const std::vector<std::string> parts = absl::StrSplit(label, absl::MaxSplits('=', 1));
    if (parts.size() != 2) {
      return absl::InvalidArgumentError(absl::StrCat("--label ", label, " is not KEY=VALUE"));
    }
    (*filter.mutable_labels())[parts[0]] = parts[1];
  }
  filter.set_display_name_prefix(arguments.name_prefix);
  if (!arguments.since.empty()) {
    const auto since = parse_moment("--since", arguments.since);
    if (!since.ok()) return since.status();
    *filter.mutable_created_from() = *since;
  }
  if (!arguments.until.empty()) {
    const auto until = parse_moment("--until", arguments.until);
    if (!until.ok()) return until.status();
    *filter.mutable_created_before() = *until;
  }
  return filter;
}

void describe_selection(CLI::App& app, SelectionArguments& arguments) {
  app.add_option("JOB", arguments.names, "jobs/ID or the id alone; - reads them, one a line");
  describe_filter(app, arguments.filter);
  app.add_option("--journal", arguments.journal, "Submitted with this journal")
      ->group(kWhichJobs);
  app.add_flag("--all", arguments.all, "All there are")->group(kWhichJobs);
  app.parse_complete_callback([&arguments] {
    const bool names_them = !arguments.names.empty() || !arguments.journal.empty();
    const bool chooses = !arguments.filter.empty() || arguments.all;
    if (!names_them && !chooses)
      throw CLI::RequiredError("which jobs? Their names, --label and its like, or --all");
    // Some would take it for those of the named ones that are like this, and some for both.
    if (names_them && chooses) {
      throw CLI::ValidationError(
          absl::StrCat("jobs are either named or chosen: leave out ",
                       arguments.names.empty() ? "--journal" : "their names", ", or ",
                       arguments.all ? "--all" : "--state, --label and their like"));
    }
  });
}

absl::StatusOr<std::vector<std::string>> select_jobs(JobClient& client,
                                                     const SelectionArguments& arguments,
                                                     const Cancellation& cancellation) {
  const auto filter = understand_filter(arguments.filter);
  if (!filter.ok()) return filter.status();
  auto names = named_jobs(arguments, cancellation);
  if (!names.ok()) return names.status();
  if (arguments.all || !arguments.filter.empty()) {
    const absl::Status status = for_each_job(
        client, *filter, [&](const v1::Job& job) { names->push_back(job.name()); },
        cancellation);
    if (!status.ok()) return status;
  }
  return each_once(*names);
}

absl::Status check_any(const std::vector<std::string>& names,
                       const SelectionArguments& arguments) {
  if (!names.empty() || arguments.all) return absl::OkStatus();
  std::vector<std::string> asked;
  const auto add = [&](const char* option, const std::string& value) {
    if (!value.empty()) asked.push_back(absl::StrCat(option, " ", value));
  };
  for (const std::string& state : arguments.filter.states) add("--state", state);
  for (const std::string& label : arguments.filter.labels) add("--label", label);
  add("--name", arguments.filter.name_prefix);
  add("--since", arguments.filter.since);
  add("--until", arguments.filter.until);
  add("--journal", arguments.journal);
  if (!arguments.names.empty()) asked.emplace_back("the names that were read");
  return absl::NotFoundError(absl::StrCat("there is no such job: ", absl::StrJoin(asked, ", "),
                                          "; `tetstream job list` shows what there is"));
}

absl::Status for_each_job(JobClient& client,
                          const v1::JobFilter& filter,
                          const std::function<void(const v1::Job&)>& see,
                          const Cancellation& cancellation) {
  v1::ListJobsRequest request;
  *request.mutable_filter() = filter;
  request.set_page_size(kPage);
  do {
    const auto page = client.list(request, cancellation);
    if (!page.ok()) return page.status();
    for (const v1::Job& job : page->jobs()) see(job);
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty());
  return absl::OkStatus();
}

}  // namespace tet
