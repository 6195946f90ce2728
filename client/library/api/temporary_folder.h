// A folder for files that nobody needs once a call is over.
#pragma once

#include <cerrno>
#include <filesystem>
#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): mkdtemp is POSIX
#include <string>
#include <system_error>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <absl/strings/str_cat.h>

namespace tetstream {

/// Goes with all that is in it.
class TemporaryFolder {
 public:
  /// Errors: kUnavailable (it cannot be made; says where).
  static absl::StatusOr<TemporaryFolder> make() {
    std::error_code error;
    const std::filesystem::path parent = std::filesystem::temp_directory_path(error);
    if (error) {
      return absl::UnavailableError(
          absl::StrCat("no temporary folder can be made where TMPDIR says: ", error.message()));
    }
    std::string path = (parent / "tetstream-XXXXXX").string();
    if (::mkdtemp(path.data()) != nullptr) return TemporaryFolder(path);
    error.assign(errno, std::generic_category());
    return absl::UnavailableError(
        absl::StrCat("no temporary folder can be made in ", parent.string(),
                     ", which TMPDIR may replace: ", error.message()));
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(TemporaryFolder&& other) noexcept : path_(std::move(other.path_)) {
    other.path_.clear();
  }
  TemporaryFolder& operator=(TemporaryFolder&&) = delete;

  std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  explicit TemporaryFolder(std::filesystem::path path) : path_(std::move(path)) {}
  std::filesystem::path path_;
};

}  // namespace tetstream
