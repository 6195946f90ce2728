#include "core/stuffing/topology/nodes_near.h"

#include "core/base/sse.h"

namespace tet {
namespace {

/// Gathers what two sets say of the nodes some steps on along y and z.
inline void gather_column(const HaloSet& plus,
                          const HaloSet& zero,
                          std::array<int, 2> steps,
                          NodeColumn& plus_slices,
                          NodeColumn& zero_slices) noexcept {
  // Eight rows of 16 bits lie one after another: the middle byte of each is a row of nodes.
  const __m128i byte = _mm_set1_epi16(0xff);
  const __m128i shift = _mm_cvtsi32_si128(2 + steps[1]);
  const auto rows_of = [&](const HaloSet& set, int row) {
    const auto* const rows = reinterpret_cast<const char*>(set.word.data());
    const __m128i bits = _mm_loadu_si128(reinterpret_cast<const __m128i*>(rows + 2 * row));
    return _mm_and_si128(_mm_srl_epi16(bits, shift), byte);
  };
  for (int x = -1; x <= 8; ++x) {
    const int row = halo_index(x, steps[0], -2) / 16;
    const __m128i both = _mm_packus_epi16(rows_of(plus, row), rows_of(zero, row));
    const auto at = static_cast<std::size_t>(x + 1);
    _mm_storel_epi64(reinterpret_cast<__m128i*>(&plus_slices[at]), both);
    _mm_storel_epi64(reinterpret_cast<__m128i*>(&zero_slices[at]),
                     _mm_unpackhi_epi64(both, both));
  }
}

}  // namespace

NodesNear::NodesNear(const std::array<HaloSet, kNodeKinds>& all_plus,
                     const std::array<HaloSet, kNodeKinds>& all_zero) noexcept {
  const auto gather = [&](NodeKind kind, const auto& columns, std::size_t first) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      gather_column(all_plus[kind], all_zero[kind], columns[c], plus[first + c],
                    zero[first + c]);
    }
  };
  gather(kCorner, kCornerSteps, 0);
  gather(kCentre, kCentreSteps, kCornerSteps.size());
}

}  // namespace tet
