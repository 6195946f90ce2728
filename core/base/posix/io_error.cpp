#include "core/base/posix/io_error.h"

#include <cerrno>
#include <string>
#include <system_error>

#include <absl/strings/str_cat.h>

namespace tet {

bool is_disk_full(int error) noexcept {
  return error == ENOSPC || error == EDQUOT || error == EFBIG;
}

absl::Status io_error(std::string_view action, const std::filesystem::path& path) {
  const int error = errno;
  const std::string message = absl::StrCat("cannot ", std::string(action), " ", path.string(),
                                           ": ", std::generic_category().message(error));
  if (is_disk_full(error)) return absl::ResourceExhaustedError(message);
  switch (error) {
    case ENOENT:
    case ENOTDIR:
      return absl::NotFoundError(message);
    case EACCES:
    case EPERM:
    case EROFS:
      return absl::PermissionDeniedError(message);
    default:
      return absl::FailedPreconditionError(message);
  }
}

}  // namespace tet
