// The walker against anything: it accepts or refuses, in words that can be shown, and what it
// accepts has every byte in its place.
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/vdb/walk/memory_charge.h"
#include "core/vdb/walk/walk_vdb.h"
#include "tests/fuzz/fuzz_target.h"

namespace tet::walk_vdb_fuzz {

TET_FUZZ_TARGET(walk_vdb_fuzz) {
  const auto bytes = std::as_bytes(std::span(data, size));
  const auto outline = walk_vdb(ByteSource(bytes));
  if (!outline.ok()) {
    require(absl::IsInvalidArgument(outline.status()) ||
            absl::IsResourceExhausted(outline.status()));
    require(outline.status().message().size() <= 300);
    return 0;
  }
  require(outline->file_bytes == size);
  for (const GridOutline& grid : outline->grids) {
    require(loading_charge(*outline, grid.name).reading <=
            loading_charge(*outline, "").reading);
  }
  const auto cut = walk_vdb(ByteSource(bytes.first(size - 1)));
  require(absl::IsInvalidArgument(cut.status()));
  return 0;
}

}  // namespace tet::walk_vdb_fuzz
