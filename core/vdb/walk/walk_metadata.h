// Names and values that files and grids carry along.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/vdb/walk/vdb_cursor.h"

namespace tet {

/// How many names and values there may be. What writers put there by themselves takes less than
/// a kilobyte, apart from ten bytes a leaf that tell a reader where to find it later.
struct MetadataLimits {
  std::uint32_t entries = 1024;  ///< of a file, or of one grid
  std::uint32_t name_bytes = 1024;
  std::uint64_t bytes = std::uint64_t{64} << 20;
};

/// What the walker, or OpenVDB's reader, goes by.
struct WalkedMetadata {
  std::string grid_class;   ///< empty when there is none
  bool half_float = false;  ///< what the reader believes, whatever the tree's type says
  std::optional<std::uint64_t> delayed_leaves;  ///< for how many leaves it has places
};

/// Walks over a map of metadata. Values of known types have exactly their size; those of other
/// types are passed over.
WalkedMetadata walk_metadata(VdbCursor& cursor, const MetadataLimits& limits);

/// Names and beginnings of the strings whose names begin with `prefix`, by name: at most a
/// hundred, of a thousand bytes each.
std::vector<std::pair<std::string, std::string>> read_texts(VdbCursor& cursor,
                                                            std::string_view prefix,
                                                            const MetadataLimits& limits);

}  // namespace tet
