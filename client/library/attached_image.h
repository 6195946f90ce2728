// A file of a volume as one file: an image whose data are in others is joined with them.
#pragma once

#include <optional>
#include <string>

#include <absl/status/statusor.h>

#include "client/library/api/temporary_folder.h"
#include "core/base/cancel.h"

namespace tet {

/// A file to read or to upload, for as long as this exists.
class AttachedImage {
 public:
  /// Any file's own path; of a header whose data are in others, that of a temporary file.
  /// Errors: those of join_image.
  static absl::StatusOr<AttachedImage> of(const std::string& path,
                                          const Cancellation& cancellation);

  const std::string& path() const noexcept { return path_; }

 private:
  std::string path_;
  std::optional<tetstream::TemporaryFolder> folder_;
};

}  // namespace tet
