// The values of one node: which of them were left out, and the array of the rest.
#pragma once

#include <cstdint>

#include <absl/strings/str_format.h>

#include "core/vdb/walk/tree_type.h"
#include "core/vdb/walk/vdb_cursor.h"
#include "core/vdb/walk/vdb_outline.h"
#include "core/vdb/walk/walk_chunk.h"
#include "core/vdb/walk/walk_refusal.h"
#include "core/volume/node_mask.h"

namespace tet {

/// How the values of a tree are stored.
struct ValueFormat {
  TreeType type;
  bool half_float = false;
  VdbCompression compression;
};

/// How a node's inactive values can be told, when they are not stored; the file's numbers.
enum class Inactive : std::uint8_t {
  kBackground = 0,
  kMinusBackground = 1,
  kOne = 2,                ///< one value for all, which is stored
  kMaskOfBackgrounds = 3,  ///< a mask: where it is set the background, else its negative
  kMaskAndOne = 4,         ///< a mask: where it is set the background, else a stored value
  kMaskAndTwo = 5,         ///< a mask: where it is set the second of two stored values
  kAllStored = 6,
};

/// Reads which it is. Without mask compression all values are stored.
Inactive read_inactive(VdbCursor& cursor, const ValueFormat& format);

/// Walks over the array of a node's values, `count` of them.
void walk_value_array(VdbCursor& cursor, const ValueFormat& format, std::uint64_t count);

inline bool has_mask(Inactive inactive) noexcept {
  return inactive >= Inactive::kMaskOfBackgrounds && inactive <= Inactive::kMaskAndTwo;
}

/// The values that stand in for inactive ones.
inline std::uint32_t count_stored(Inactive inactive) noexcept {
  if (inactive == Inactive::kMaskAndTwo) return 2;
  return inactive == Inactive::kOne || inactive == Inactive::kMaskAndOne ? 1 : 0;
}

/// Walks over a node's values. Returns where an inactive one may differ from the background.
template <int kLog2>
NodeMask<kLog2> walk_values(VdbCursor& cursor,
                            const ValueFormat& format,
                            std::uint32_t active) {
  using Mask = NodeMask<kLog2>;
  const Inactive inactive = read_inactive(cursor, format);
  cursor.take(std::size_t{count_stored(inactive)} * format.type.value_bytes, "inactive values");
  Mask differs;
  if (inactive != Inactive::kBackground) differs = ~differs;
  if (has_mask(inactive)) {
    const Mask selected = Mask::from_bytes(cursor.take(Mask::kBytes, "selection mask"));
    if (inactive != Inactive::kMaskAndTwo) differs = ~selected;
  }
  walk_value_array(cursor, format, inactive == Inactive::kAllStored ? Mask::kBits : active);
  return differs;
}

}  // namespace tet
