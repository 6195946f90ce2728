#include "server/jobs/store/new_job.h"

#include <algorithm>
#include <string_view>

#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>

#include "proto/convert/status.h"
#include "proto/wire/sha256.h"

namespace tet {

namespace {

constexpr std::size_t kMaxIdBytes = 128;
constexpr std::size_t kMaxNameBytes = 256;
// More digests than a mesh can have; with a namespace less than PostgreSQL's indexes take,
// 2704.
constexpr std::size_t kMaxInputBytes = 2400;
constexpr std::size_t kMaxSpecBytes = 64 << 10;
constexpr std::size_t kMaxLabels = 32;
constexpr std::size_t kMaxLabelBytes = 63;
constexpr std::size_t kMaxShards = 100'000;
constexpr std::size_t kMaxAlgorithmBytes = 64;

bool is_printable(const std::string& text) {
  return std::ranges::all_of(text, [](char c) { return c >= ' ' && c <= '~'; });
}

bool is_label_key(const std::string& key) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') ||
           std::string_view("_-./").find(c) != std::string_view::npos;
  };
  return !key.empty() && key.size() <= kMaxLabelBytes && key[0] >= 'a' && key[0] <= 'z' &&
         std::ranges::all_of(key, allowed);
}

absl::Status check_size(const std::string& field, std::size_t bytes, std::size_t limit) {
  if (bytes <= limit) return absl::OkStatus();
  return invalid_field(absl::StrCat(field, " has ", bytes, " bytes, more than ", limit));
}

absl::Status check_range(const std::string& field,
                         std::int64_t value,
                         std::int64_t min,
                         std::int64_t max) {
  if (value >= min && value <= max) return absl::OkStatus();
  return invalid_field(absl::StrCat(field, " ", value, " is not from ", min, " to ", max));
}

absl::Status check_span(const std::string& field, absl::Duration value) {
  if (value <= absl::ZeroDuration()) {
    return invalid_field(
        absl::StrCat(field, " ", absl::FormatDuration(value), " is not positive"));
  }
  if (value <= kLongestSpan || value == absl::InfiniteDuration()) return absl::OkStatus();
  return invalid_field(absl::StrCat(field, " ", absl::FormatDuration(value), " is more than ",
                                    absl::FormatDuration(kLongestSpan),
                                    ", a hundred years: leave it out for no end"));
}

absl::Status check_text(const std::string& field,
                        const std::string& text,
                        std::size_t limit = kMaxIdBytes) {
  if (auto status = check_size(field, text.size(), limit); !status.ok()) return status;
  if (is_printable(text)) return absl::OkStatus();
  return invalid_field(
      absl::StrCat(field, " '", absl::CHexEscape(text), "' is not printable ASCII"));
}

absl::Status first_error(std::initializer_list<absl::Status> statuses) {
  for (const absl::Status& status : statuses) {
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status invalid_plan(const std::string& message) {
  return with_reason(absl::InvalidArgumentError(message), "INVALID_PLAN");
}

}  // namespace

absl::Status check_labels(const Labels& labels) {
  if (labels.size() > kMaxLabels) {
    return invalid_field(
        absl::StrCat("labels has ", labels.size(), " entries, more than ", kMaxLabels));
  }
  for (const auto& [key, value] : labels) {
    if (!is_label_key(key)) {
      return invalid_field(
          absl::StrCat("labels has the key '", absl::CHexEscape(key),
                       "', which is not [a-z][a-z0-9_./-]* of at most 63 bytes"));
    }
    if (value.size() > kMaxLabelBytes || !is_printable(value)) {
      return invalid_field(absl::StrCat("labels has ", key, "='", absl::CHexEscape(value),
                                        "', which is not printable ASCII of at most 63 bytes"));
    }
  }
  return absl::OkStatus();
}

absl::Status check(const NewJob& job) {
  if (job.space.empty()) return invalid_field("namespace is empty");
  return first_error(
      {check_text("namespace", job.space), check_text("request_id", job.request_id),
       check_text("input", job.input, kMaxInputBytes),
       check_size("display_name", job.display_name.size(), kMaxNameBytes),
       check_size("spec", job.spec.size(), kMaxSpecBytes), check_labels(job.labels),
       check_range("priority", job.priority, -kMaxPriority, kMaxPriority),
       check_range("max_attempts", job.max_attempts, 1, kMaxAttempts),
       check_span("ttl", job.ttl), check_span("timeout", job.timeout)});
}

absl::Status check(const Plan& plan) {
  if (plan.phase == Phase::kPlan) return invalid_plan("a plan cannot lead to another plan");
  if (plan.phase == Phase::kCount && plan.shards.empty()) {
    return invalid_plan("a count phase has no shards");
  }
  if (plan.header.size() > kMaxSpecBytes || plan.shards.size() > kMaxShards) {
    return invalid_plan(absl::StrCat(
        "a plan of ", plan.shards.size(), " shards and a header of ", plan.header.size(),
        " bytes is over the limit of ", kMaxShards, " and ", kMaxSpecBytes));
  }
  if (plan.algorithm.size() > kMaxAlgorithmBytes) {
    return invalid_plan(absl::StrCat("the algorithm version has ", plan.algorithm.size(),
                                     " bytes, more than ", kMaxAlgorithmBytes));
  }
  std::int64_t end = 0;
  for (const ChunkRange& range : plan.shards) {
    if (range.first != end || range.end <= range.first) {
      return invalid_plan(absl::StrCat("shard [", range.first, ", ", range.end,
                                       ") is empty or does not begin at ", end));
    }
    end = range.end;
  }
  return absl::OkStatus();
}

std::string fingerprint(const NewJob& job) {
  Sha256 digest;
  const auto add = [&](const std::string& text) {
    digest.add(absl::StrCat(text.size(), ":"));  // so that no two lists of fields look alike
    digest.add(text);
  };
  add(job.space);
  add(job.display_name);
  add(job.spec);
  add(encode_labels(job.labels));
  add(absl::StrCat(job.priority, " ", job.max_attempts));
  add(absl::FormatDuration(job.ttl));
  add(absl::FormatDuration(job.timeout));
  return digest.finish_hex();
}

std::string encode_labels(const Labels& labels) {
  std::string text = labels.empty() ? "" : "\n";
  for (const auto& [key, value] : labels) absl::StrAppend(&text, key, "=", value, "\n");
  return text;
}

Labels decode_labels(const std::string& text) {
  const std::vector<std::string> lines = absl::StrSplit(text, '\n', absl::SkipEmpty());
  Labels labels;
  for (const std::string& line : lines) {
    const std::size_t equals = line.find('=');
    labels.emplace(line.substr(0, equals), line.substr(equals + 1));
  }
  return labels;
}

}  // namespace tet
