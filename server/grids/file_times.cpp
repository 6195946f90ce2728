#include "server/grids/file_times.h"

#include <algorithm>
#include <fcntl.h>
#include <optional>
#include <sys/stat.h>

namespace tet {

namespace {

std::optional<absl::Time> time_of(const std::filesystem::path& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) return std::nullopt;
  return absl::TimeFromTimespec(info.st_mtim);
}

void set_time(const std::filesystem::path& path, absl::Time time) {
  const timespec times[2] = {{0, UTIME_OMIT}, absl::ToTimespec(time)};
  ::utimensat(AT_FDCWD, path.c_str(), times, 0);
}

}  // namespace

absl::Time give_time(const std::filesystem::path& path, absl::Time time) {
  const auto before = time_of(path);
  if (!before) return time;
  set_time(path, std::max(time, *before + absl::Nanoseconds(1)));
  auto now = time_of(path);
  if (now && *now <= *before) {  // a file system that has no more than seconds
    set_time(path, *before + absl::Seconds(1));
    now = time_of(path);
  }
  return now.value_or(time);
}

}  // namespace tet
