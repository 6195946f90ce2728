#include "core/vdb/walk/walk_values.h"

namespace tet {

Inactive read_inactive(VdbCursor& cursor, const ValueFormat& format) {
  const std::uint64_t at = cursor.position();
  const auto code = cursor.read<std::uint8_t>("inactive code");
  const auto inactive = static_cast<Inactive>(code);
  if (inactive > Inactive::kAllStored) {
    refuse_at(at, absl::StrFormat(
                      "a node tells its inactive values by code %d; there are 0 to 6", code));
  }
  if (!format.compression.active_mask && inactive != Inactive::kAllStored) {
    refuse_at(at, absl::StrFormat("a node leaves out inactive values (code %d) in a grid that "
                                  "stores them all",
                                  code));
  }
  return inactive;
}

void walk_value_array(VdbCursor& cursor, const ValueFormat& format, std::uint64_t count) {
  const bool half = format.half_float && format.type.half_bytes != 0;
  if (half && count == 0) return;  // not even a length is written
  walk_chunk(cursor, count * (half ? format.type.half_bytes : format.type.value_bytes),
             format.compression);
}

}  // namespace tet
