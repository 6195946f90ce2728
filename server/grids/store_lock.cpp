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
  std::array<char, 96> text{};
  const auto size = file.read_at(0, text);
  if (!size.ok() || *size == 0) return "unknown";
  return std::string(absl::StripAsciiWhitespace({text.data(), *size}));
}

/// Only for the message below: a disk that is full is no reason to fail. Of several the last is
/// written.
void write_holder(File& file) {
  std::array<char, 64> host{};
  ::gethostname(host.data(), host.size() - 1);
  if (!file.truncate(0).ok()) return;
  file.write_at(0, absl::StrCat(::getpid(), " on ", host.data(), "\n")).IgnoreError();
}

absl::Status in_use(const std::filesystem::path& folder, const File& file) {
  return absl::FailedPreconditionError(absl::StrCat(
      "the store ", folder.string(), " is in use by another server, process ", holder_of(file),
      ": stop it, or choose another --store. Servers share a store where all of them keep "
      "their "
      "jobs in one PostgreSQL (--jobs postgresql://...)"));
}

}  // namespace

// The file stays when the lock goes: who removed it could remove another's.
absl::StatusOr<StoreLock> StoreLock::take(const std::filesystem::path& folder,
                                          StoreSharing sharing) {
  if (absl::Status made = make_folder(folder); !made.ok()) return made;
  auto file = File::open(folder / "lock", O_RDWR | O_CREAT, io_error, 0640);
  if (!file.ok()) return absl::InternalError(file.status().message());
  const auto taken =
      file->lock(sharing == StoreSharing::kAlone ? FileLock::kAlone : FileLock::kSharedIfFree);
  if (!taken.ok()) return absl::InternalError(taken.status().message());
  if (!*taken) return in_use(folder, *file);
  write_holder(*file);
  return StoreLock(*std::move(file));
}

}  // namespace tet
