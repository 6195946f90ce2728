// The walker against anything: it accepts or refuses, in words that can be shown, and what it
// accepts has every byte in its place.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "core/vdb/memory_charge.h"
#include "core/vdb/walk_vdb.h"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  const auto outline = tet::walk_vdb(tet::ByteSource(bytes));
  if (!outline.ok()) {
    require(absl::IsInvalidArgument(outline.status()) ||
            absl::IsResourceExhausted(outline.status()));
    require(outline.status().message().size() <= 300);
    return 0;
  }
  require(outline->file_bytes == size);
  for (const tet::GridOutline& grid : outline->grids) {
    require(tet::loading_charge(*outline, grid.name).reading <=
            tet::loading_charge(*outline, "").reading);
  }
  const auto cut = tet::walk_vdb(tet::ByteSource(bytes.first(size - 1)));
  require(absl::IsInvalidArgument(cut.status()));
  return 0;
}
