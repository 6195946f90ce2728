// What a decoder hands back, and anything else: it is refused in words that can be shown, or it
// is a volume or a list of grids that writes the same block again.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <vector>

#include "core/base/byte_buffer.h"
#include "core/volume/flat_grid_list.h"
#include "core/volume/flat_volume.h"

namespace {

constexpr std::uint64_t kMaxBytes = std::uint64_t{64} << 20;

void require(bool condition) {
  if (!condition) std::abort();
}

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
  const auto grids = tet::read_flat_grid_list(block);
  if (!grids.ok()) return require_refusal(grids.status());
  const auto again = written(
      [&](const tet::ByteSink& sink) { return tet::write_flat_grid_list(*grids, sink); });
  require(std::equal(again.begin(), again.end(), block.begin(), block.end()));
}

/// Constants that say nothing are left out when it is written again, but never again.
void try_volume(std::span<const std::byte> block) {
  const auto volume = tet::read_flat_volume(block, kMaxBytes);
  if (!volume.ok()) return require_refusal(volume.status());
  require(volume->values.size() == volume->bricks.size() * tet::kBrickCells);
  const auto once =
      written([&](const tet::ByteSink& sink) { return tet::write_flat_volume(*volume, sink); });
  require(once.size() <= block.size());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  tet::ByteBuffer aligned(size);
  if (size > 0) std::memcpy(aligned.bytes().data(), data, size);
  try_grid_list(aligned.bytes());
  try_volume(aligned.bytes());
  return 0;
}
