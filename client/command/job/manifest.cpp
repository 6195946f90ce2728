#include "client/command/job/manifest.h"

#include <algorithm>
#include <utility>

#include <CLI/CLI.hpp>
#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_replace.h>
#include <nlohmann/json.hpp>

#include "client/command/arguments/empty_values.h"
#include "core/base/bare_option.h"

namespace tet {
namespace {

using Json = nlohmann::ordered_json;
using Words = std::vector<std::string>;

std::string text_of(const Json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

/// Values go behind a `=`, so that none is taken for an option; one that is empty leaves a word
/// that parse_words refuses. Only numbers follow each other.
void add_option(const std::string& option, const Json& value, Words& words) {
  if (value.is_null()) return;
  const auto is_number = [](const Json& one) { return one.is_number(); };
  const bool is_list = value.is_array() && !value.empty();
  if (is_list && !std::all_of(value.begin(), value.end(), is_number)) {
    for (const Json& one : value) words.push_back(absl::StrCat(option, "=", text_of(one)));
  } else if (value.is_array()) {
    if (!is_list) return;
    words.push_back(option);
    for (const Json& one : value) words.push_back(text_of(one));
  } else if (value.is_object()) {
    for (const auto& [key, one] : value.items()) {
      words.push_back(absl::StrCat(option, "=", key, "=", text_of(one)));
    }
  } else {
    words.push_back(absl::StrCat(option, "=", text_of(value)));
  }
}

absl::StatusOr<Words> words_of_json(const std::string& line) {
  const Json object = Json::parse(line, nullptr, false);
  if (!object.is_object()) return absl::InvalidArgumentError("not a JSON object");
  Words words;
  std::string input;
  for (const auto& [key, value] : object.items()) {
    if (key == "input") {
      input = text_of(value);
    } else {
      add_option("--" + absl::StrReplaceAll(key, {{"_", "-"}}), value, words);
    }
  }
  if (!input.empty()) words.insert(words.end(), {"--", input});
  return words;
}

absl::Status parse_words(CLI::App& app, Words words) {
  if (const std::string empty = option_without_value(words); !empty.empty()) {
    return absl::InvalidArgumentError(no_value_message(empty));
  }
  std::reverse(words.begin(), words.end());  // as CLI11 takes them
  try {
    app.parse(std::move(words));
  } catch (const CLI::ParseError& error) {
    return absl::InvalidArgumentError(error.what());
  }
  return absl::OkStatus();
}

absl::Status parse_line(CLI::App& app, const std::string& line) {
  if (line.front() == '{') {
    absl::StatusOr<Words> words = words_of_json(line);
    return words.ok() ? parse_words(app, *std::move(words)) : words.status();
  }
  Words words = CLI::detail::split_up(line);
  for (std::string& word : words) CLI::detail::remove_quotes(word);
  return parse_words(app, std::move(words));
}

absl::StatusOr<JobArguments> understand_line(const std::string& line,
                                             const JobArguments& defaults) {
  JobArguments job = defaults;
  job.labels.clear();
  CLI::App app;
  app.set_help_flag();
  describe_job(app, job);
  app.add_option("INPUT", job.input);
  refuse_empty_values(app);
  if (absl::Status status = parse_line(app, line); !status.ok()) return status;
  if (job.input.empty()) return absl::InvalidArgumentError("no input");
  job.labels.insert(job.labels.begin(), defaults.labels.begin(), defaults.labels.end());
  if (absl::Status status = understand_job(job).status(); !status.ok()) return status;
  return job;
}

}  // namespace

absl::StatusOr<std::vector<JobArguments>> read_manifest(std::istream& lines,
                                                        const std::string& name,
                                                        const JobArguments& defaults) {
  std::vector<JobArguments> jobs;
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    absl::StripAsciiWhitespace(&line);
    if (line.empty() || line.front() == '#') continue;
    absl::StatusOr<JobArguments> job = understand_line(line, defaults);
    if (!job.ok()) {
      return absl::InvalidArgumentError(
          absl::StrCat(name, ":", number, ": ", job.status().message()));
    }
    jobs.push_back(*std::move(job));
  }
  return jobs;
}

}  // namespace tet
