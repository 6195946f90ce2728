// The reader of plain grids against any file that the walker lets pass: it reads or refuses, in
// words that can be shown, and what it reads is no larger than was reckoned.
//
// The checks of zlib's and blosc's own are not looked for: what does not unpack is refused.
#include <cstddef>
#include <cstdint>
#include <span>
#include <sys/mman.h>

#include "core/base/posix/descriptor.h"
#include "core/base/posix/transfer.h"
#include "core/vdb/plain/plain_grid.h"
#include "core/vdb/walk/memory_charge.h"
#include "core/vdb/walk/plain_choice.h"
#include "core/vdb/walk/walk_vdb.h"
#include "tests/fuzz/fuzz_target.h"

namespace tet::plain_grid_fuzz {
namespace {

/// More would only be slower.
constexpr std::uint64_t kMostReading = 64 << 20;

/// It is broken, or cannot be meshed: empty, sheared, with values that are not finite.
void require_plain_words(const absl::Status& status) {
  require(absl::IsInvalidArgument(status) || absl::IsFailedPrecondition(status));
  require(status.message().size() <= 1000);
}

void read(const OpenGridFile& file, const VdbOutline& outline, std::size_t grid, GridUse use) {
  const MemoryCharge charge = loading_charge(outline, outline.grids[grid].name, use);
  if (charge.reading > kMostReading) return;
  const auto volume = read_plain_grid(file, outline, grid, use);
  if (!volume.ok()) return require_plain_words(volume.status());
  require(volume->size_bytes() <= charge.volume);
}

}  // namespace

TET_FUZZ_TARGET(plain_grid_fuzz) {
  const auto bytes = std::as_bytes(std::span(data, size));
  const auto outline = walk_vdb(ByteSource(bytes));
  if (!outline.ok()) return 0;
  const Descriptor memory(::memfd_create("grid", MFD_CLOEXEC));
  require(memory.is_open() && write_all(memory.number(), bytes));
  const OpenGridFile file{memory.number(), static_cast<std::int64_t>(size), "grid.vdb"};
  if (are_plain_grids(*outline) && listing_charge(*outline).reading <= kMostReading) {
    const auto listed = list_plain_grids(file, *outline);
    if (!listed.ok()) require_plain_words(listed.status());
  }
  for (const GridUse use : {GridUse::kSurface, GridUse::kField}) {
    for (const GridOutline& named : outline->grids) {
      const auto grid = find_plain_grid(*outline, named.name, use, 0);
      if (grid) read(file, *outline, *grid, use);
    }
  }
  return 0;
}

}  // namespace tet::plain_grid_fuzz
