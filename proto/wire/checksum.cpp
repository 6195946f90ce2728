#include "proto/wire/checksum.h"

#include <isa-l/crc.h>

namespace tet {

namespace {

// ISA-L's is the zlib checksum at 10 times zlib's speed.
std::uint32_t add_crc(std::uint32_t crc, std::string_view bytes) noexcept {
  return crc32_gzip_refl(crc, reinterpret_cast<const unsigned char*>(bytes.data()),
                         bytes.size());
}

}  // namespace

std::uint32_t chunk_checksum(std::string_view positions,
                             std::string_view tets,
                             std::string_view regions) noexcept {
  return add_crc(add_crc(add_crc(0, positions), tets), regions);
}

}  // namespace tet
