#include "core/vdb/plain/load_image_file.h"

#include <utility>

#include <absl/strings/str_format.h>

#include "core/base/posix/byte_source.h"
#include "core/image/load_image.h"
#include "core/vdb/walk/image_file.h"

namespace tet {
namespace {

ByteSource source_of(const OpenGridFile& file) {
  return ByteSource(file.descriptor, static_cast<std::uint64_t>(file.size_bytes));
}

template <class T>
absl::StatusOr<T> told(const OpenGridFile& file, absl::StatusOr<T> made) {
  if (!made.ok()) return told_of_image(file, made.status());
  return made;
}

}  // namespace

absl::StatusOr<std::vector<GridInfo>> list_image_file(const OpenGridFile& file) {
  return told(file, list_image(source_of(file)));
}

absl::StatusOr<Volume> load_image_file(const OpenGridFile& file,
                                       const std::string& name,
                                       GridUse use,
                                       std::uint32_t component,
                                       const LoadLimits& limits) {
  if (component > 0) {
    return absl::InvalidArgumentError(absl::StrFormat(
        "'%s': its values are numbers: there is no component %d", file.name, component));
  }
  return told(file, load_image(source_of(file), name,
                               use == GridUse::kField ? ImageUse::kField : ImageUse::kSurface,
                               limits.max_reading_bytes));
}

absl::StatusOr<LabelVolume> load_label_file(const OpenGridFile& file,
                                            const std::string& name,
                                            const LoadLimits& limits) {
  return told(file, load_labels(source_of(file), name, limits.max_reading_bytes));
}

}  // namespace tet
