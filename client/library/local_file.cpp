#include "client/library/local_file.h"

#include <filesystem>
#include <string_view>
#include <system_error>
#include <vector>

#include <absl/strings/str_cat.h>

#include "core/base/posix/file.h"
#include "proto/wire/sha256.h"

namespace tet {

namespace {
constexpr std::size_t kReadBytes = std::size_t{1} << 20;
}

absl::StatusOr<LocalFile> name_file(const std::string& path, const Cancellation& cancellation) {
  std::error_code unknown;  // as in a folder that may not be looked into
  if (!std::filesystem::is_regular_file(path, unknown)) {
    return absl::NotFoundError(absl::StrCat(path, " is not a file that can be read"));
  }
  const absl::StatusOr<File> file = File::open(path, O_RDONLY, io_error);
  if (!file.ok()) return absl::NotFoundError(absl::StrCat(path, " cannot be opened"));
  std::vector<char> buffer(kReadBytes);
  LocalFile named{path, {}, 0};
  Sha256 digest;
  while (true) {
    if (absl::Status status = check_cancelled(cancellation); !status.ok()) return status;
    const absl::StatusOr<std::size_t> count = file->read_at(named.size_bytes, buffer);
    if (!count.ok()) return count.status();
    if (*count == 0) break;
    digest.add(std::string_view(buffer.data(), *count));
    named.size_bytes += *count;
  }
  if (named.size_bytes == 0) return absl::InvalidArgumentError(absl::StrCat(path, " is empty"));
  named.name = name_of_grid(digest.finish_hex());
  return named;
}

}  // namespace tet
