#include "server/grids/store_lock.h"

#include <fcntl.h>
#include <string>
#include <sys/file.h>
#include <system_error>
#include <unistd.h>
#include <utility>

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>

#include "server/ops/file.h"

namespace tet {

namespace {

std::string holder_of(int descriptor) {
  char text[32] = {};
  const ssize_t size = ::pread(descriptor, text, sizeof text - 1, 0);
  return size > 0 ? std::string(absl::StripAsciiWhitespace(text)) : "unknown";
}

}  // namespace

// The file stays when the lock goes: who removed it could remove another's.
absl::StatusOr<StoreLock> StoreLock::take(const std::filesystem::path& folder) {
  if (absl::Status made = make_folder(folder); !made.ok()) return made;
  const std::string path = folder / "lock";
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0640);
  if (descriptor < 0) {
    return absl::InternalError(
        absl::StrCat("cannot open ", path, ": ", std::generic_category().message(errno)));
  }
  StoreLock lock(descriptor);
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
    return absl::FailedPreconditionError(
        absl::StrCat("the store ", folder.string(), " is in use by another server, process ",
                     holder_of(descriptor), ": stop it, or choose another --store"));
  }
  // Only for the message above: a disk that is full is no reason to fail.
  const std::string holder = absl::StrCat(::getpid(), "\n");
  if (::ftruncate(descriptor, 0) == 0) {
    [[maybe_unused]] const auto written = ::pwrite(descriptor, holder.data(), holder.size(), 0);
  }
  return lock;
}

StoreLock::~StoreLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

StoreLock::StoreLock(StoreLock&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)) {}

}  // namespace tet
