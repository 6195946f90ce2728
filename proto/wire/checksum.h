// The checksum of a chunk's columns.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string_view>

namespace tet {

/// CRC-32 (IEEE 802.3, reflected, as zlib's crc32) of a chunk's columns one after the other:
/// one that every language has at hand.
std::uint32_t chunk_checksum(std::span<const std::string_view> columns) noexcept;
inline std::uint32_t chunk_checksum(std::initializer_list<std::string_view> columns) noexcept {
  return chunk_checksum(std::span(columns.begin(), columns.size()));
}

/// The checksum of what `checksum` is of, 0 of nothing, followed by `bytes`.
std::uint32_t add_to_checksum(std::uint32_t checksum,
                              std::span<const std::byte> bytes) noexcept;

}  // namespace tet
