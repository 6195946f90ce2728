// A directory of our own that is gone with us.
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include <absl/status/statusor.h>

namespace tet {

class ScratchDirectory {
 public:
  /// Within `parent`, whose files can then be renamed to and from it. Errors: of making it,
  /// with the parent's path.
  static absl::StatusOr<ScratchDirectory> make(const std::filesystem::path& parent);
  ~ScratchDirectory();
  ScratchDirectory(ScratchDirectory&& other) noexcept;
  ScratchDirectory& operator=(ScratchDirectory&&) = delete;

  std::string file(const std::string& name) const {
    return std::filesystem::path(path_) / name;
  }

 private:
  explicit ScratchDirectory(std::string path) : path_(std::move(path)) {}

  std::string path_;  ///< empty once it was moved away
};

}  // namespace tet
