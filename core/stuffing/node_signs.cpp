#include "core/stuffing/node_signs.h"

#include <cstddef>
#include <cstdint>

#include "core/base/sse.h"
#include "core/field/phi_field.h"

namespace tet {
namespace {

/// Where samples are valid; see BrickSamples.
constexpr std::array<HaloSet, kNodeKinds> kSampled{halo_cube(-2, 10), halo_cube(-2, 9)};
constexpr std::size_t kSampledWords = 13 * 4;  // x in [-2, 10]

/// Bits of the 16 values of a row: those with a sign bit, and those that are +0.
struct RowSigns {
  std::uint64_t negative, zero;
};

/// Read as integers and cut to 8 bits (with saturation), floats keep their sign, and none but
/// +0 becomes 0.
RowSigns row_signs(const float* row) noexcept {
  const auto load = [&](int i) {
    return _mm_load_si128(reinterpret_cast<const __m128i*>(row + 4 * i));
  };
  const __m128i bytes =
      _mm_packs_epi16(_mm_packs_epi32(load(0), load(1)), _mm_packs_epi32(load(2), load(3)));
  const auto bits = [](__m128i mask) {
    return static_cast<std::uint64_t>(static_cast<unsigned>(_mm_movemask_epi8(mask)));
  };
  return {bits(bytes), bits(_mm_cmpeq_epi8(bytes, _mm_setzero_si128()))};
}

}  // namespace

void find_signs(const BrickSamples& samples, NodeSigns& signs) noexcept {
  for (const NodeKind kind : {kCorner, kCentre}) {
    const auto& phi = kind == kCorner ? samples.corner : samples.centre;
    for (std::size_t w = 0; w < kSampledWords; ++w) {
      std::uint64_t negative = 0, zero = 0;
      for (std::size_t row = 0; row < 4; ++row) {
        const RowSigns bits = row_signs(&phi[(w * 4 + row) * 16]);
        negative |= bits.negative << (row * 16);
        zero |= bits.zero << (row * 16);
      }
      signs.inside[kind].word[w] = kSampled[kind].word[w] & negative;
      signs.outside[kind].word[w] = kSampled[kind].word[w] & ~(negative | zero);
    }
  }
}

bool NodeSigns::one_sided() const noexcept {
  const auto every_sample = [](const std::array<HaloSet, kNodeKinds>& nodes) {
    return !(kSampled[kCorner] - nodes[kCorner]).any() &&
           !(kSampled[kCentre] - nodes[kCentre]).any();
  };
  const bool none_inside = !inside[kCorner].any() && !inside[kCentre].any();
  return none_inside || every_sample(inside);
}

}  // namespace tet
