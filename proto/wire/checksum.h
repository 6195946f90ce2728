// The checksum of a chunk's columns.
#pragma once

#include <cstdint>
#include <string_view>

namespace tet {

/// CRC-32 (IEEE 802.3, reflected, as zlib's crc32) of `positions` followed by `tets` and
/// `regions`: one that every language has at hand.
std::uint32_t chunk_checksum(std::string_view positions,
                             std::string_view tets,
                             std::string_view regions) noexcept;

}  // namespace tet
