#include "core/decode/file_request.h"

#include <algorithm>
#include <fcntl.h>
#include <sys/stat.h>

#include <absl/strings/str_format.h>

#include "core/grid/check_file.h"
#include "core/grid/grid_info.h"

namespace tet {
namespace {

/// What any file may take: one of a few bytes has a small tree, and a loaded machine its time.
constexpr std::uint64_t kLeastBytes = std::uint64_t{64} << 20;
constexpr std::chrono::milliseconds kLeastTime{2000};

/// A tenth of what a slow machine decodes a second.
constexpr std::uint64_t kFileBytesPerSecond = 10'000'000;

DecodeLimits limits_of(const FileRequest& request) {
  DecodeLimits limits;
  limits.volume_bytes = request.max_bytes;
  limits.result_bytes = 2 * request.max_bytes + kLeastBytes;
  limits.working_bytes = 3 * request.max_bytes + kLeastBytes;
  return limits;
}

std::chrono::milliseconds time_for(std::int64_t file_bytes,
                                   std::chrono::milliseconds max_time) {
  const auto reading =
      std::chrono::seconds(static_cast<std::uint64_t>(file_bytes) / kFileBytesPerSecond);
  return std::clamp(kLeastTime + reading, std::min(kLeastTime, max_time), max_time);
}

}  // namespace

absl::StatusOr<CheckedFile> check_request(const FileRequest& request,
                                          std::chrono::milliseconds max_time) {
  if (absl::Status s = check_file(request.path); !s.ok()) {
    return absl::Status(s.code(), absl::StrFormat("'%s' cannot be read", request.file_name));
  }
  if (request.grid_name.size() > kMaxGridNameBytes) {
    return absl::NotFoundError(
        absl::StrFormat("no grid has a name of %d bytes; the limit is %d",
                        request.grid_name.size(), kMaxGridNameBytes));
  }
  CheckedFile checked;
  checked.file = Descriptor(::open(request.path.c_str(), O_RDONLY | O_CLOEXEC));
  struct stat facts {};
  if (!checked.file.is_open() || ::fstat(checked.file.number(), &facts) != 0) {
    return absl::PermissionDeniedError(
        absl::StrFormat("'%s' cannot be opened", request.file_name));
  }
  checked.limit = time_for(facts.st_size, max_time);
  checked.order = {request.task, limits_of(request), facts.st_size, request.file_name,
                   request.grid_name};
  checked.order.limits.cpu_seconds = static_cast<std::uint64_t>(
      std::chrono::ceil<std::chrono::seconds>(checked.limit).count());
  return checked;
}

}  // namespace tet
