#include "server/upkeep/check_store.h"

#include <span>
#include <system_error>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>

#include "core/base/posix/file.h"
#include "proto/wire/sha256.h"
#include "server/grids/store_identity.h"
#include "server/jobs/results/whole_file.h"
#include "server/jobs/store/sqlite_backup.h"
#include "server/upkeep/store_files.h"

namespace tet {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kReadBytes = std::size_t{1} << 20;

/// Its digest; kNotFound if it is gone.
absl::StatusOr<std::pair<std::string, std::uint64_t>> digest_file(const fs::path& path) {
  const auto file = File::open(path, O_RDONLY, io_error);
  if (!file.ok()) return file.status();
  std::vector<char> bytes(kReadBytes);
  Sha256 digest;
  std::uint64_t offset = 0;
  while (true) {
    const auto count = file->read_at(offset, bytes);
    if (!count.ok()) return count.status();
    if (*count == 0) return std::pair(digest.finish_hex(), offset);
    digest.add(std::string_view(bytes.data(), *count));
    offset += *count;
  }
}

class Checking {
 public:
  Checking(fs::path store, const std::function<void(const std::string&)>& tell)
      : store_(std::move(store)), tell_(tell) {}

  absl::Status check_file(const StoreFile& file) {
    if (file.kind == FileKind::kGrows || file.path == kStoreIdentityFile) {
      return absl::OkStatus();
    }
    const std::string name = file.path.filename().string();
    const bool is_named_so =
        is_sha256_hex(name) && file.path.parent_path().filename() != "plans";
    const auto found = digest_file(store_ / file.path);
    if (absl::IsNotFound(found.status())) return absl::OkStatus();
    if (!found.ok()) return problem(file.path, found.status().message());
    ++counts_.files;
    counts_.bytes += found->second;
    if (is_named_so) {
      if (found->first == name) return absl::OkStatus();
      return problem(file.path, absl::StrCat("has the digest ", found->first));
    }
    std::error_code gone;
    if (read_checked(store_ / file.path) || !fs::exists(store_ / file.path, gone)) {
      return absl::OkStatus();
    }
    return problem(file.path, "has another checksum than it says");
  }

  absl::Status check_jobs(const fs::path& jobs) {
    if (auto sound = check_sqlite(jobs); !sound.ok()) return problem(jobs, sound.message());
    const auto inputs = inputs_of_sqlite(jobs);
    if (!inputs.ok()) return problem(jobs, inputs.status().message());
    for (const JobInput& input : *inputs) {
      const fs::path grid = grid_file(input.space, input.name);
      std::error_code ignored;
      if (fs::exists(store_ / grid, ignored)) continue;
      problem(grid, "is missing: a job that is not finished reads it").IgnoreError();
    }
    return absl::OkStatus();
  }

  const CheckCounts& counts() const { return counts_; }

 private:
  absl::Status problem(const fs::path& where, absl::string_view what) {
    ++counts_.problems;
    tell_(absl::StrCat(where.string(), " ", what));
    return absl::OkStatus();
  }

  const fs::path store_;
  const std::function<void(const std::string&)>& tell_;
  CheckCounts counts_;
};

}  // namespace

absl::StatusOr<CheckCounts> check_store(const fs::path& store,
                                        const fs::path& jobs,
                                        const std::function<void(const std::string&)>& tell) {
  const auto identity = read_store_identity(store);
  if (!identity.ok()) {
    return absl::NotFoundError(absl::StrCat(
        store.string(), " is no store: ", std::string(identity.status().message())));
  }
  Checking checking(store, tell);
  const absl::Status walked = for_each_store_file(
      store, [&](const StoreFile& file) { return checking.check_file(file); });
  if (!walked.ok()) return walked;
  std::error_code ignored;
  if (!jobs.empty() && fs::exists(jobs, ignored)) {
    if (auto looked = checking.check_jobs(jobs); !looked.ok()) return looked;
  }
  return checking.counts();
}

}  // namespace tet
