#include "client/library/local_file.h"

#include <filesystem>
#include <fstream>
#include <vector>

#include <absl/strings/str_cat.h>

#include "proto/wire/sha256.h"

namespace tet {

namespace {
constexpr std::size_t kReadBytes = std::size_t{1} << 20;
}

absl::StatusOr<LocalFile> name_file(const std::string& path, const Cancellation& cancellation) {
  if (!std::filesystem::is_regular_file(path)) {
    return absl::NotFoundError(absl::StrCat(path, " is not a file that can be read"));
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) return absl::NotFoundError(absl::StrCat(path, " cannot be opened"));
  std::vector<char> buffer(kReadBytes);
  LocalFile named{path, {}, 0};
  Sha256 digest;
  while (file.read(buffer.data(), static_cast<std::streamsize>(kReadBytes)) ||
         file.gcount() > 0) {
    if (absl::Status status = check_cancelled(cancellation); !status.ok()) return status;
    const auto count = static_cast<std::size_t>(file.gcount());
    digest.add(std::string_view(buffer.data(), count));
    named.size_bytes += count;
  }
  if (named.size_bytes == 0) return absl::InvalidArgumentError(absl::StrCat(path, " is empty"));
  named.name = name_of_grid(digest.finish_hex());
  return named;
}

}  // namespace tet
