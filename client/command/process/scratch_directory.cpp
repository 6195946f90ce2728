#include "client/command/process/scratch_directory.h"

#include <cerrno>
#include <stdlib.h>
#include <system_error>

#include <absl/status/status.h>
#include <absl/strings/str_cat.h>

namespace tet {

absl::StatusOr<ScratchDirectory> ScratchDirectory::make(const std::filesystem::path& parent) {
  std::string path = (parent / ".tetstream.XXXXXX").string();
  if (::mkdtemp(path.data()) != nullptr) return ScratchDirectory(std::move(path));
  return absl::ErrnoToStatus(errno, absl::StrCat("cannot make a folder in ", parent.string()));
}

ScratchDirectory::ScratchDirectory(ScratchDirectory&& other) noexcept
    : path_(std::exchange(other.path_, "")) {}

ScratchDirectory::~ScratchDirectory() {
  std::error_code ignored;
  if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
}

}  // namespace tet
