#include "core/volume/flat_block.h"

#include <algorithm>
#include <array>

namespace tet {

void FlatWriter::add_bytes(std::span<const std::byte> bytes) {
  static constexpr std::array<std::byte, kColumnAlignment> kZeros{};
  write(bytes);
  write(std::span(kZeros).first(column_bytes(bytes.size()) - bytes.size()));
}

void FlatWriter::write(std::span<const std::byte> bytes) {
  if (status_.ok() && !bytes.empty()) status_ = sink_(bytes);
}

// A block that is not where its columns would be aligned has none.
FlatReader::FlatReader(std::span<const std::byte> block) : rest_(block) {
  if (reinterpret_cast<std::uintptr_t>(block.data()) % kColumnAlignment != 0) rest_ = {};
}

bool FlatReader::skip(std::size_t bytes) {
  const std::uint64_t padded = column_bytes(bytes);
  if (padded > rest_.size()) return false;
  const auto padding = rest_.subspan(bytes, static_cast<std::size_t>(padded) - bytes);
  rest_ = rest_.subspan(static_cast<std::size_t>(padded));
  return std::all_of(padding.begin(), padding.end(),
                     [](std::byte b) { return b == std::byte{0}; });
}

}  // namespace tet
