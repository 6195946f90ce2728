// The corners of a tet in the lower half of a register, 16 bits for each.
#pragma once

#include <array>
#include <cstdint>

#include "core/base/sse.h"

namespace tet {

/// Four lanes as their bytes, to be made one by one.
using LaneBytes = std::array<std::uint8_t, 8>;

inline __m128i load_lanes(const void* from) noexcept {
  return _mm_loadl_epi64(static_cast<const __m128i*>(from));
}

inline void store_lanes(void* to, __m128i lanes) noexcept {
  _mm_storel_epi64(static_cast<__m128i*>(to), lanes);
}

}  // namespace tet
