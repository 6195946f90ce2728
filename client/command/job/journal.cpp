#include "client/command/job/journal.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <string_view>
#include <unistd.h>
#include <utility>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <nlohmann/json.hpp>

#include "core/base/posix/folder.h"
#include "core/base/posix/io_error.h"
#include "proto/wire/sha256.h"

namespace tet {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kRequestIdDigits = 40;

std::string random_id() {
  std::random_device random;
  return absl::StrFormat("%08x%08x%08x%08x", random(), random(), random(), random());
}

constexpr std::string_view kBegin = R"({"submission":)";

absl::Status not_a_journal(const std::string& path) {
  return absl::FailedPreconditionError(absl::StrCat(path, " is not a journal"));
}

/// The lines that were written to their ends, and how many bytes they take.
struct WholeLines {
  std::vector<Json> lines;
  std::size_t bytes = 0;
};

/// Whether text begins as a journal does, as far as it goes.
bool begins_a_journal(std::string_view text) {
  return text.substr(0, kBegin.size()) == kBegin.substr(0, text.size());
}

absl::StatusOr<WholeLines> read_lines(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return io_error("read", path);
  WholeLines whole;
  std::string line;
  while (std::getline(file, line)) {
    if (whole.lines.empty() && !begins_a_journal(line)) return not_a_journal(path);
    if (file.eof()) break;
    Json json = Json::parse(line, nullptr, false);
    if (!json.is_object())
      return not_a_journal(absl::StrCat(path, ":", whole.lines.size() + 1));
    whole.bytes += line.size() + 1;
    whole.lines.push_back(std::move(json));
  }
  return whole;
}

std::string text_at(const Json& line, const char* key) {
  const auto found = line.find(key);
  return found != line.end() && found->is_string() ? found->get<std::string>() : "";
}

}  // namespace

absl::StatusOr<std::unique_ptr<Journal>> Journal::open(const std::string& path,
                                                       const std::string& server) {
  for (;;) {
    auto file = File::open(path, O_RDWR | O_CREAT | O_APPEND, io_error, 0600);
    if (!file.ok()) return file.status();
    std::unique_ptr<Journal> journal(new Journal(path, *std::move(file)));
    if (absl::Status status = journal->lock(); !status.ok()) return status;
    // Another process may have completed its submission since the file was opened.
    if (!journal->file_.is_at_its_path()) continue;
    if (absl::Status status = journal->read(server); !status.ok()) return status;
    return journal;
  }
}

absl::Status Journal::lock() {
  const absl::StatusOr<bool> taken = file_.lock(FileLock::kAlone);
  if (!taken.ok() || *taken) return taken.status();
  return absl::FailedPreconditionError(
      absl::StrCat("another process is submitting with the journal ", path_));
}

absl::Status Journal::read(const std::string& server) {
  const absl::StatusOr<WholeLines> whole = read_lines(path_);
  if (!whole.ok()) return whole.status();
  if (absl::Status status = file_.truncate(whole->bytes); !status.ok()) return status;
  whole_bytes_ = whole->bytes;
  if (whole->lines.empty()) return begin(server);
  submission_ = text_at(whole->lines.front(), "submission");
  if (const auto of = text_at(whole->lines.front(), "server"); of != server) {
    return absl::FailedPreconditionError(
        absl::StrCat("the journal ", path_, " is of what was submitted to ", of));
  }
  for (std::size_t i = 1; i < whole->lines.size(); ++i) {
    jobs_.emplace(text_at(whole->lines[i], "request_id"), text_at(whole->lines[i], "job"));
  }
  return absl::OkStatus();
}

absl::Status Journal::begin(const std::string& server) {
  submission_ = random_id();
  const Json first{{"submission", submission_}, {"server", server}};
  if (absl::Status status = write_line(first.dump()); !status.ok()) return status;
  if (absl::Status status = file_.sync(); !status.ok()) return status;
  return sync_folder(folder_of(path_), io_error);
}

absl::Status Journal::write_line(const std::string& line) {
  const std::string whole = absl::StrCat(line, "\n");
  absl::Status written = file_.append(whole);
  if (written.ok()) {
    whole_bytes_ += whole.size();
  } else {
    // A disk that was full may have taken the beginning.
    file_.truncate(whole_bytes_).IgnoreError();
  }
  return written;
}

std::string Journal::request_id(const std::string& order_digest, std::size_t nth) const {
  Sha256 digest;
  digest.add(absl::StrCat(submission_, "/", order_digest, "/", nth));
  return digest.finish_hex().substr(0, kRequestIdDigits);
}

std::optional<std::string> Journal::job_of(const std::string& request_id) const {
  const std::lock_guard lock(mutex_);
  const auto found = jobs_.find(request_id);
  return found == jobs_.end() ? std::nullopt : std::optional(found->second);
}

absl::Status Journal::record(const std::string& request_id, const std::string& job) {
  const Json line{{"request_id", request_id}, {"job", job}};
  const std::lock_guard lock(mutex_);
  jobs_.emplace(request_id, job);
  return write_line(line.dump());
}

void Journal::remove() { unlink(path_.c_str()); }

absl::StatusOr<std::vector<std::string>> jobs_of_journal(const std::string& path) {
  const absl::StatusOr<WholeLines> whole = read_lines(path);
  if (!whole.ok()) return whole.status();
  std::vector<std::string> jobs;
  for (const Json& line : whole->lines) {
    if (std::string job = text_at(line, "job"); !job.empty()) jobs.push_back(std::move(job));
  }
  return jobs;
}

absl::StatusOr<std::string> default_journal_path(const std::string& server,
                                                 const std::vector<JobOrder>& orders) {
  const char* const state = std::getenv("XDG_STATE_HOME");
  const char* const home = std::getenv("HOME");
  const bool has_state = state != nullptr && *state != '\0';
  if (!has_state && (home == nullptr || *home == '\0')) {
    return absl::FailedPreconditionError(
        "there is no HOME to keep a journal in: name one with --journal FILE");
  }
  const fs::path folder =
      (has_state ? fs::path(state) : fs::path(home) / ".local" / "state") / "tetstream";
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    return absl::FailedPreconditionError(absl::StrCat("cannot make ", folder.string(), ": ",
                                                      error.message(), "; use --journal FILE"));
  }
  Sha256 digest;
  digest.add(server);
  for (const JobOrder& order : orders) digest.add(digest_of(order));
  return folder / absl::StrCat("submit-", digest.finish_hex().substr(0, 16), ".jsonl");
}

}  // namespace tet
