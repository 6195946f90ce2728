// What a decoder hands back, and anything else: it is refused in words that can be shown, or it
// is a volume or a list of grids that writes the same block again.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "core/base/byte_buffer.h"
#include "core/volume/flat_grid_list.h"
#include "core/volume/flat_volume.h"
#include "tests/fuzz/fuzz_target.h"

namespace tet::flat_volume_fuzz {
namespace {

constexpr std::uint64_t kMaxBytes = std::uint64_t{64} << 20;

void require_refusal(const absl::Status& status) {
  require(absl::IsInvalidArgument(status) || absl::IsFailedPrecondition(status) ||
          absl::IsResourceExhausted(status));
  require(status.message().size() <= 400);
}

/// All that `write(sink)` writes.
template <class Write>
std::vector<std::byte> written(const Write& write) {
  std::vector<std::byte> bytes;
  const absl::Status status = write([&](std::span<const std::byte> piece) {
    bytes.insert(bytes.end(), piece.begin(), piece.end());
    return absl::OkStatus();
  });
  require(status.ok());
  return bytes;
}

void try_grid_list(std::span<const std::byte> block) {
  const auto grids = read_flat_grid_list(block);
  if (!grids.ok()) return require_refusal(grids.status());
  const auto again =
      written([&](const ByteSink& sink) { return write_flat_grid_list(*grids, sink); });
  require(std::equal(again.begin(), again.end(), block.begin(), block.end()));
}

/// Constants that say nothing are left out when it is written again, but never again.
void try_volume(std::span<const std::byte> block) {
  const auto volume = read_flat_volume(block, kMaxBytes);
  if (!volume.ok()) return require_refusal(volume.status());
  require(volume->values.size() == volume->bricks.size() * kBrickCells);
  const auto once =
      written([&](const ByteSink& sink) { return write_flat_volume(*volume, sink); });
  require(once.size() <= block.size());
}

}  // namespace

TET_FUZZ_TARGET(flat_volume_fuzz) {
  ByteBuffer aligned(size);
  if (size > 0) std::memcpy(aligned.bytes().data(), data, size);
  try_grid_list(aligned.bytes());
  try_volume(aligned.bytes());
  return 0;
}

}  // namespace tet::flat_volume_fuzz
