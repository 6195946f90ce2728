// A directory of our own that is gone with us.
#pragma once

#include <filesystem>
#include <string>

namespace tet {

class ScratchDirectory {
 public:
  /// Within `parent`, whose files can then be renamed to and from it.
  explicit ScratchDirectory(const std::filesystem::path& parent);
  ~ScratchDirectory();
  ScratchDirectory(const ScratchDirectory&) = delete;
  ScratchDirectory& operator=(const ScratchDirectory&) = delete;

  std::string file(const std::string& name) const {
    return std::filesystem::path(path_) / name;
  }

 private:
  std::string path_;
  bool made_ = false;
};

}  // namespace tet
