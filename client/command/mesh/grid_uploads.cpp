#include "client/command/mesh/grid_uploads.h"

namespace tet {

GridUploads::Upload& GridUploads::upload_of(const MeshInput& input) {
  const std::lock_guard lock(mutex_);
  auto& upload = uploads_[{input.path, input.surface}];
  if (!upload) upload = std::make_unique<Upload>();
  return *upload;
}

absl::StatusOr<std::string> GridUploads::name_of(const MeshInput& input,
                                                 const UploadWatch& watch,
                                                 const Cancellation& cancellation) {
  if (std::string stored = stored_grid_name(input.path); !stored.empty()) return stored;
  Upload& upload = upload_of(input);
  const std::lock_guard lock(upload.mutex);
  if (!upload.name.empty()) return upload.name;
  absl::StatusOr<std::string> name = upload_input(client_, input, watch, cancellation);
  if (name.ok()) upload.name = *name;
  return name;
}

void GridUploads::forget(const MeshInput& input) {
  Upload& upload = upload_of(input);
  const std::lock_guard lock(upload.mutex);
  upload.name.clear();
}

}  // namespace tet
