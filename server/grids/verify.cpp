#include "server/grids/verify.h"

#include <fcntl.h>
#include <string>
#include <string_view>
#include <vector>

#include <absl/strings/str_cat.h>

#include "proto/convert/status.h"
#include "proto/wire/sha256.h"
#include "server/ops/disk.h"

namespace tet {

namespace {

absl::Status corrupt(const std::string& digest, std::string_view why) {
  return with_reason(absl::DataLossError(
                         absl::StrCat("the stored file of ", name_of_grid(digest), " ",
                                      std::string(why), "; it was set aside: upload it again")),
                     "STORED_GRID_CORRUPT");
}

/// Looks at `cancelled` after every megabyte.
absl::StatusOr<std::string> digest_of(const File& file,
                                      const std::function<bool()>& cancelled) {
  Sha256 digest;
  std::vector<char> buffer(std::size_t{1} << 20);
  for (std::uint64_t offset = 0;;) {
    if (cancelled()) return absl::CancelledError("nobody wants the grid any more");
    const auto count = file.read_at(offset, buffer);
    if (!count.ok()) return count.status();
    if (*count == 0) return digest.finish_hex();
    digest.add(std::string_view(buffer.data(), *count));
    offset += *count;
  }
}

}  // namespace

absl::Status verify_stored(const std::filesystem::path& path,
                           const std::function<bool()>& cancelled) {
  const std::string digest = path.filename().string();
  const auto file = open_file(path, O_RDONLY);
  if (absl::IsNotFound(file.status())) return corrupt(digest, "is gone");
  if (!file.ok()) return file.status();
  const auto found = digest_of(*file, cancelled);
  if (!found.ok()) return found.status();
  if (*found == digest) return absl::OkStatus();
  return corrupt(digest, absl::StrCat("has other bytes, with the SHA-256 ", *found));
}

}  // namespace tet
