// The page's files, read once when the server starts.
#pragma once

#include <map>
#include <string>

#include <absl/status/statusor.h>
#include <absl/strings/string_view.h>
#include <grpcpp/support/slice.h>

namespace tet {

struct PageFile {
  std::string type;                  ///< for Content-Type
  grpc::Slice bytes;                 ///< shared by all who ask for it at once
  grpc::Slice gzipped;               ///< empty where the folder has none
  bool is_named_by_content = false;  ///< its name changes with its bytes
};

/// What is served of a folder: no request ever names a file of the disk. Immutable.
class PageFiles {
 public:
  /// An empty folder is where `tetstreamd` was installed or built with one; where there is
  /// none, there are no files. Errors: kInvalidArgument (a folder that is named and has no
  /// index.html, files of other kinds or more bytes than a page has).
  static absl::StatusOr<PageFiles> open(const std::string& folder);

  /// Returns the file for a path such as "/" or "/assets/main.js"; null where there is none.
  const PageFile* find(absl::string_view path) const;
  bool empty() const noexcept { return files_.empty(); }

 private:
  std::map<std::string, PageFile, std::less<>> files_;
};

}  // namespace tet
