// A strict look at a .vdb file, byte by byte and without OpenVDB: what can be read safely, what
// it holds, and what reading it takes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/posix/byte_source.h"
#include "core/vdb/walk/vdb_cursor.h"
#include "core/vdb/walk/vdb_outline.h"
#include "core/vdb/walk/walk_metadata.h"

namespace tet {

struct WalkLimits {
  std::uint32_t grids = 1024;
  std::uint32_t name_bytes = 1024;  ///< of a grid's name
  MetadataLimits metadata = {};     ///< of the file, and of each grid
  /// Asked for every quarter of a megabyte; null never cancels. Must not throw.
  std::function<bool()> cancelled = nullptr;
};

/// Walks over a whole file, every byte of which must belong to something: a file that is cut,
/// longer, or has gaps is refused, and so is any count, length, mask or offset that does not
/// agree with the rest. Values are not decompressed: what a frame of the right lengths holds is
/// for the decoder to find.
///
/// What the file claims never decides how much is allocated: memory stays below a sixteenth of
/// its size and a few hundred kilobytes, whatever is in it. Takes about as long as reading the
/// file from the page cache. Errors: kInvalidArgument (says what, and at which byte),
/// kResourceExhausted (over `limits`), kNotFound, kPermissionDenied, kCancelled. At most 300
/// characters; of the file's own bytes only names, escaped and cut. A path is given only where
/// the file cannot be opened.
absl::StatusOr<VdbOutline> walk_vdb(const std::string& path, const WalkLimits& limits = {});

/// Walks over bytes that may be anywhere. With `fields`, it lists all that was looked at, in
/// order, up to the place of a refusal.
absl::StatusOr<VdbOutline> walk_vdb(const ByteSource& source,
                                    const WalkLimits& limits = {},
                                    std::vector<VdbField>* fields = nullptr);

}  // namespace tet
