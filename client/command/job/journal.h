// What a submission remembers, so that it can be run again after whatever ended it.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <absl/status/statusor.h>

#include "client/command/job/job_order.h"
#include "core/base/posix/file.h"

namespace tet {

/// A small text file. Its first line holds a random submission id, which is on the disk before
/// anything is sent; the request id of every job is a pure function of it and of the order, so
/// that a job that was asked for before is asked for under the same name. Each job that the
/// server has acknowledged gets a line: those need not be asked for again, nor their files
/// read. A line that was not written to its end counts as not written.
///
/// One process has a journal at a time. Thread safety: any thread may call any member.
class Journal {
 public:
  /// Makes the file when it is missing. Errors: those of io_error; kFailedPrecondition (another
  /// process has it, it is of another server, or it is no journal).
  static absl::StatusOr<std::unique_ptr<Journal>> open(const std::string& path,
                                                       const std::string& server);
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  const std::string& path() const { return path_; }

  /// 40 hexadecimal digits for the `nth` (from 0) order with this digest.
  std::string request_id(const std::string& order_digest, std::size_t nth) const;

  /// The job that was acknowledged under this request id.
  std::optional<std::string> job_of(const std::string& request_id) const;

  /// What cannot be written to its end is taken away again, so that the next line stands alone.
  absl::Status record(const std::string& request_id, const std::string& job);

  /// The submission is complete: nobody will go on with it.
  void remove();

 private:
  Journal(std::string path, File file) : path_(std::move(path)), file_(std::move(file)) {}
  absl::Status lock();
  absl::Status read(const std::string& server);
  absl::Status begin(const std::string& server);
  absl::Status write_line(const std::string& line);

  const std::string path_;
  File file_;
  std::size_t whole_bytes_ = 0;  ///< of lines that were written to their ends
  std::string submission_;
  mutable std::mutex mutex_;
  std::map<std::string, std::string> jobs_;  ///< by request id
};

/// The jobs that a journal knows of, in the order they were acknowledged.
absl::StatusOr<std::vector<std::string>> jobs_of_journal(const std::string& path);

/// Where the journal of a submission is that was not given one: in the user's folder for state,
/// named after the server and all that is asked of it. Makes the folder.
/// Errors: kFailedPrecondition (the user has no home), those of making a folder.
absl::StatusOr<std::string> default_journal_path(const std::string& server,
                                                 const std::vector<JobOrder>& orders);

}  // namespace tet
