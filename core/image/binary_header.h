// Numbers at fixed places of a binary header.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <span>
#include <type_traits>

#include "core/image/image_refusal.h"

namespace tet {

/// A header's bytes, in this order of bytes or the other. Refuses rather than read past its
/// end.
class BinaryHeader {
 public:
  BinaryHeader(std::span<const std::byte> bytes, bool big_endian)
      : bytes_(bytes), swapped_(big_endian != (std::endian::native == std::endian::big)) {}

  template <class T>
  T at(std::size_t offset) const {
    static_assert(std::is_trivially_copyable_v<T>);
    if (offset > bytes_.size() || bytes_.size() - offset < sizeof(T)) {
      refuse_image("it is truncated: it ends within its header");
    }
    std::array<std::byte, sizeof(T)> raw;
    std::memcpy(raw.data(), bytes_.data() + offset, sizeof(T));
    if (swapped_) std::reverse(raw.begin(), raw.end());
    return std::bit_cast<T>(raw);
  }

 private:
  std::span<const std::byte> bytes_;
  bool swapped_;
};

}  // namespace tet
