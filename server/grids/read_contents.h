// What the values of a stored file's grids tell, read by decoders one grid after another.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/vdb/decoder/decoder_pool.h"
#include "core/volume/grid_contents.h"
#include "core/volume/grid_info.h"

namespace tet {

/// A file and those of its grids that are wanted.
struct ContentsOrder {
  std::string client;  ///< in whose turns
  std::string path;
  std::string file_name;  ///< what messages call it
  std::vector<GridInfo> grids;
  std::uint64_t max_bytes = 0;  ///< that one grid may take in memory
};

/// Grids whose values are read for one call, of those that can be meshed.
inline constexpr std::size_t kMostGridsRead = 64;

using ContentsRead = std::function<void(absl::StatusOr<std::vector<GridContents>>)>;

/// Calls `done` on a thread of the pool, with contents of every grid in their order: empty ones
/// of those that cannot be meshed, and beyond kMostGridsRead. `cancelled` is polled. The pool
/// outlives it. Errors: those of DecoderPool::decode and contents_of, but kFailedPrecondition,
/// which says of a grid why it is not meshable.
void read_contents_of(DecoderPool& decoders,
                      ContentsOrder order,
                      std::function<bool()> cancelled,
                      ContentsRead done);

}  // namespace tet
