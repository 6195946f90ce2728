#include "server/grids/store_lock.h"

#include <array>
#include <string>
#include <string_view>
#include <unistd.h>

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>

#include "server/ops/disk.h"

namespace tet {

namespace {

std::string holder_of(const File& file) {
  std::array<char, 32> text{};
  const auto size = file.read_at(0, text);
  if (!size.ok() || *size == 0) return "unknown";
  return std::string(absl::StripAsciiWhitespace({text.data(), *size}));
}

/// Only for the message below: a disk that is full is no reason to fail.
void write_holder(File& file) {
  if (!file.truncate(0).ok()) return;
  file.write_at(0, absl::StrCat(::getpid(), "\n")).IgnoreError();
}

}  // namespace

// The file stays when the lock goes: who removed it could remove another's.
absl::StatusOr<StoreLock> StoreLock::take(const std::filesystem::path& folder) {
  if (absl::Status made = make_folder(folder); !made.ok()) return made;
  auto file = File::open(folder / "lock", O_RDWR | O_CREAT, io_error, 0640);
  if (!file.ok()) return absl::InternalError(file.status().message());
  const auto taken = file->lock(FileLock::kAlone);
  if (!taken.ok()) return absl::InternalError(taken.status().message());
  if (!*taken) {
    return absl::FailedPreconditionError(
        absl::StrCat("the store ", folder.string(), " is in use by another server, process ",
                     holder_of(*file), ": stop it, or choose another --store"));
  }
  write_holder(*file);
  return StoreLock(*std::move(file));
}

}  // namespace tet
