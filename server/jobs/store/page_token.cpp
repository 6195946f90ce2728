#include "server/jobs/store/page_token.h"

#include <algorithm>

#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>

#include "proto/convert/status.h"
#include "proto/wire/sha256.h"
#include "server/jobs/store/job_rows.h"
#include "server/jobs/store/new_job.h"

namespace tet {

namespace {

constexpr std::size_t kIdDigits = 24, kDigestDigits = 8;
constexpr std::size_t kMostShown = 40;

std::string digest_of(const JobFilter& filter) {
  std::string text = absl::StrCat(filter.space, "\n", filter.name_prefix.size(), "\n",
                                  filter.name_prefix, encode_labels(filter.labels));
  for (const JobState state : filter.states) absl::StrAppend(&text, " ", number_of(state));
  absl::StrAppend(&text, "\n", absl::FormatTime(filter.created_from), "\n",
                  absl::FormatTime(filter.created_before));
  Sha256 digest;
  digest.add(text);
  return digest.finish_hex().substr(0, kDigestDigits);
}

}  // namespace

std::string make_page_token(const std::string& job, const JobFilter& filter) {
  return absl::StrCat(job, digest_of(filter));
}

absl::StatusOr<std::string> job_after_token(const std::string& token, const JobFilter& filter) {
  if (token.empty()) return std::string();
  const auto is_digit = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
  if (token.size() != kIdDigits + kDigestDigits || !std::ranges::all_of(token, is_digit)) {
    return invalid_field(
        absl::StrCat("page_token '", absl::CHexEscape(token.substr(0, kMostShown)),
                     "' was not given by this server: begin at the first page"));
  }
  if (token.substr(kIdDigits) != digest_of(filter)) {
    return invalid_field(
        absl::StrCat("page_token ", token, " is of a list with another filter"));
  }
  return token.substr(0, kIdDigits);
}

}  // namespace tet
