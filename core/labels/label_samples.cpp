#include "core/labels/label_samples.h"

#include <cstddef>

#include "core/base/sse.h"
#include "core/stuffing/node_signs.h"

namespace tet {
namespace {

/// Words of halo sets that hold nodes in [-2, 9]^3.
constexpr std::size_t kEndWord = halo_index(10, -2, -2) / 64;

/// Where sixteen labels differ from sixteen others.
std::uint64_t differing(const Label* a, const Label* b) noexcept {
  const auto equal = [&](std::size_t i) {
    return _mm_cmpeq_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(a + i)),
                           _mm_loadu_si128(reinterpret_cast<const __m128i*>(b + i)));
  };
  const int same = _mm_movemask_epi8(_mm_packs_epi16(equal(0), equal(8)));
  return static_cast<std::uint64_t>(~same & 0xffff);
}

}  // namespace

void find_label_changes(const std::array<std::array<Label, kHaloNodes>, kNodeKinds>& label,
                        EdgeSets& changes) noexcept {
  for (int family = 0; family < kEdgeFamilies; ++family) {
    const NodeKind kind = family_kind(family), end = end_kind(kind, family_direction(family));
    const int offset = end_offset(kind, family_direction(family));
    const HaloSet from_high = seen_from(kKnownNodes, offset);
    const Label* const low = label[kind].data();
    HaloSet& found = changes[static_cast<std::size_t>(family)];
    found = {};
    for (std::size_t w = 0; w < kEndWord; ++w) {
      const std::uint64_t wanted = kKnownNodes.word[w] | from_high.word[w];
      if (wanted == 0) continue;
      std::uint64_t bits = 0;
      for (std::size_t row = 0; row < 4; ++row) {
        const std::size_t at = 64 * w + 16 * row;
        if ((wanted >> (16 * row) & 0xffff) == 0) continue;
        // Rows with a wanted edge have all their ends within the columns.
        const std::size_t to = at + static_cast<std::size_t>(offset);
        bits |= differing(low + at, label[end].data() + to) << (16 * row);
      }
      found.word[w] = bits & wanted;
    }
  }
}

}  // namespace tet
