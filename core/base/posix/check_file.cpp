#include "core/base/posix/check_file.h"

#include <filesystem>
#include <system_error>
#include <unistd.h>

#include <absl/strings/str_format.h>

namespace tet {

absl::Status check_file(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    return absl::NotFoundError(absl::StrFormat("there is no file '%s'", path));
  }
  if (!std::filesystem::is_regular_file(status)) {
    return absl::InvalidArgumentError(absl::StrFormat("'%s' is not a regular file", path));
  }
  if (::access(path.c_str(), R_OK) != 0) {
    return absl::PermissionDeniedError(
        absl::StrFormat("'%s' may not be read by this user", path));
  }
  return absl::OkStatus();
}

}  // namespace tet
