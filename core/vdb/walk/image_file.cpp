#include "core/vdb/walk/image_file.h"

#include <algorithm>

#include <absl/strings/str_format.h>

#include "core/base/posix/byte_source.h"
#include "core/image/outline_image.h"

namespace tet {
namespace {

ByteSource bytes_of_file(const OpenGridFile& file) {
  return ByteSource(file.descriptor, static_cast<std::uint64_t>(file.size_bytes));
}

}  // namespace

bool holds_image(const OpenGridFile& file) { return is_image(bytes_of_file(file)); }

absl::Status told_of_image(const OpenGridFile& file, const absl::Status& why) {
  const bool broken = absl::IsInvalidArgument(why);
  return {why.code(),
          absl::StrFormat("'%s'%s: %s", file.name, broken ? " is not a readable image" : "",
                          std::string(why.message()))};
}

absl::StatusOr<MemoryCharge> charge_image(const OpenGridFile& file,
                                          bool lists,
                                          std::uint64_t max_volume_bytes,
                                          std::uint64_t max_reading_bytes) {
  const absl::StatusOr<ImageOutline> outline = outline_image(bytes_of_file(file));
  if (!outline.ok()) return told_of_image(file, outline.status());
  const auto file_bytes = static_cast<std::uint64_t>(file.size_bytes);
  MemoryCharge charge;
  if (!lists) {
    charge = {outline->volume_bytes(), outline->reading_bytes(file_bytes)};
  } else if (outline->cut) {
    charge.reading = 2 * file_bytes;  // its text as a whole
  }
  const absl::Status fits = check_memory(charge, max_volume_bytes, max_reading_bytes);
  if (!fits.ok()) return told_of_image(file, fits);
  // Whether it is one that takes more than it claims shows only when all of it is unpacked.
  charge.unpacked = outline->most_unpacked_bytes(file_bytes);
  if (outline->packed && !lists) {
    charge.volume = std::min(outline->most_volume_bytes(file_bytes), max_volume_bytes);
    charge.reading = std::min(outline->most_reading_bytes(file_bytes), max_reading_bytes);
  }
  return charge;
}

}  // namespace tet
