// The checksum of a chunk's columns.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace tet {

/// CRC-32 (IEEE 802.3, reflected, as zlib's crc32) of `positions` followed by `tets` and
/// `regions`: one that every language has at hand.
std::uint32_t chunk_checksum(std::string_view positions,
                             std::string_view tets,
                             std::string_view regions) noexcept;

/// The checksum of what `checksum` is of, 0 of nothing, followed by `bytes`.
std::uint32_t add_to_checksum(std::uint32_t checksum,
                              std::span<const std::byte> bytes) noexcept;

}  // namespace tet
