#include "server/jobs/store/ballast.h"

#include <algorithm>
#include <sys/statvfs.h>
#include <system_error>
#include <unistd.h>

#include "core/base/posix/file.h"
#include "core/base/posix/folder.h"

namespace tet {

namespace {

// What SQLite may still need, and the least that is worth keeping.
constexpr std::uint64_t kLeftFree = std::uint64_t{512} << 10;
constexpr std::uint64_t kLeast = std::uint64_t{1} << 20;

std::uint64_t free_bytes_of(const std::filesystem::path& folder) {
  struct statvfs info {};
  if (::statvfs(folder.c_str(), &info) != 0) return 0;
  return std::uint64_t{info.f_bavail} * info.f_frsize;
}

std::uint64_t size_of(const std::filesystem::path& path) {
  std::error_code none;
  const std::uintmax_t size = std::filesystem::file_size(path, none);
  return none ? 0 : size;
}

}  // namespace

bool Ballast::drop() const { return bytes_ > 0 && ::unlink(path_.c_str()) == 0; }

void Ballast::keep() const {
  if (bytes_ == 0 || size_of(path_) >= bytes_) return;
  if (free_bytes_of(folder_of(path_)) >= 2 * bytes_) make(bytes_);
}

void Ballast::retake() const {
  if (bytes_ == 0 || size_of(path_) > 0) return;
  const std::uint64_t free = free_bytes_of(folder_of(path_));
  const std::uint64_t bytes = std::min(bytes_, free - std::min(free, kLeftFree));
  if (bytes >= kLeast) make(bytes);
}

void Ballast::make(std::uint64_t bytes) const {
  auto file = File::open(path_, O_WRONLY | O_CREAT, io_error, 0600);
  if (file.ok() && !file->reserve(bytes).ok()) ::unlink(path_.c_str());
}

}  // namespace tet
