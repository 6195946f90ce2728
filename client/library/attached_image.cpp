#include "client/library/attached_image.h"

#include <utility>

#include "core/image/join_image.h"

namespace tet {

absl::StatusOr<AttachedImage> AttachedImage::of(const std::string& path,
                                                const Cancellation& cancellation) {
  AttachedImage image;
  image.path_ = path;
  if (!is_detached_image(path)) return image;
  absl::StatusOr<tetstream::TemporaryFolder> folder = tetstream::TemporaryFolder::make();
  if (!folder.ok()) return folder.status();
  image.path_ = folder->file("joined.image");
  image.folder_.emplace(*std::move(folder));
  const absl::Status joined = join_image(path, image.path_, cancellation);
  if (!joined.ok()) return joined;
  return image;
}

}  // namespace tet
