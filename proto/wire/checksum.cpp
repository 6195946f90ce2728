#include "proto/wire/checksum.h"

#include <isa-l/crc.h>

namespace tet {

// ISA-L's is the zlib checksum at more than 10 times zlib's speed.
std::uint32_t add_to_checksum(std::uint32_t checksum,
                              std::span<const std::byte> bytes) noexcept {
  return crc32_gzip_refl(checksum, reinterpret_cast<const unsigned char*>(bytes.data()),
                         bytes.size());
}

std::uint32_t chunk_checksum(std::span<const std::string_view> columns) noexcept {
  std::uint32_t checksum = 0;
  for (const std::string_view column : columns) {
    checksum = add_to_checksum(checksum, std::as_bytes(std::span(column)));
  }
  return checksum;
}

}  // namespace tet
