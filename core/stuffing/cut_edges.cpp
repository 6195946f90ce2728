#include "core/stuffing/cut_edges.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "core/base/vector_clones.h"

namespace tet {
namespace {

/// Edges of a family with an end among the nodes that a brick needs to know.
constexpr HaloSet edges_in_reach(int family) noexcept {
  const int offset = end_offset(family_kind(family), family_direction(family));
  const HaloSet nodes = halo_cube(kNodeMin, kNodeMax);
  return nodes | seen_from(nodes, offset);
}
constexpr EdgeSets kEdgesInReach = [] {
  EdgeSets edges;
  for (int f = 0; f < kEdgeFamilies; ++f) {
    edges[static_cast<std::size_t>(f)] = edges_in_reach(f);
  }
  return edges;
}();

/// Words that hold all of a set: [begin, end).
struct WordRange {
  std::size_t begin = HaloSet::kWords, end = 0;
};
constexpr WordRange words_of(const HaloSet& set) noexcept {
  WordRange range;
  for (std::size_t w = 0; w < HaloSet::kWords; ++w) {
    if (set.word[w] == 0) continue;
    range = {std::min(range.begin, w), w + 1};
  }
  return range;
}

/// Edges of one family with a change of sign; adds them to `any` of them all.
template <int kFamily>
void find_sign_changes(const NodeSigns& signs, HaloSet& cut, HaloSet& any) noexcept {
  constexpr NodeKind kKind = family_kind(kFamily);
  constexpr NodeKind kEnd = end_kind(kKind, family_direction(kFamily));
  constexpr int kOffset = end_offset(kKind, family_direction(kFamily));
  constexpr const HaloSet& kReach = kEdgesInReach[kFamily];
  constexpr WordRange kWords = words_of(kReach);
  static_assert(kOffset >= -64 * static_cast<int>(kWords.begin) &&
                kWords.end + (kOffset >> 6) < HaloSet::kWords);
  const HaloSet &inside = signs.inside[kKind], &outside = signs.outside[kKind];
  std::fill_n(cut.word.begin(), kWords.begin, 0);
  for (std::size_t w = kWords.begin; w < kWords.end; ++w) {
    const std::uint64_t end_inside = word_seen_from(signs.inside[kEnd], w, kOffset);
    const std::uint64_t end_outside = word_seen_from(signs.outside[kEnd], w, kOffset);
    cut.word[w] =
        ((inside.word[w] & end_outside) | (outside.word[w] & end_inside)) & kReach.word[w];
    any.word[w] |= cut.word[w];
  }
  std::fill(cut.word.begin() + kWords.end, cut.word.end(), 0);
}

TET_VECTOR_CLONES
void find_all_sign_changes(const NodeSigns& signs, EdgeSets& cut, HaloSet& any) noexcept {
  any = {};
  [&]<std::size_t... kFamily>(std::index_sequence<kFamily...>) {
    (find_sign_changes<static_cast<int>(kFamily)>(signs, cut[kFamily], any), ...);
  }
  (std::make_index_sequence<kEdgeFamilies>{});
}

/// Which words of a set have bits, and what those are: found without a branch on either.
struct NonzeroWords {
  std::array<std::uint64_t, HaloSet::kWords> bits;
  std::array<std::uint16_t, HaloSet::kWords> index;
  std::size_t count = 0;

  void add(std::size_t w, std::uint64_t word) noexcept {
    bits[count] = word;
    index[count] = static_cast<std::uint16_t>(w);
    count += word != 0;
  }
};

/// Appends the set bits of a word, `first` onwards. Most words have up to four: those cost no
/// branch that is hard to foresee. Writes up to three entries too many.
std::uint16_t* append_bits(std::uint64_t bits, std::size_t first, std::uint16_t* out) noexcept {
  std::uint16_t* const end = out + std::popcount(bits);
  do {
    for (int i = 0; i < 4; ++i) {
      *out++ =
          static_cast<std::uint16_t>(first + static_cast<std::size_t>(std::countr_zero(bits)));
      bits &= bits - 1;
    }
  } while (bits != 0);
  return end;
}

TET_VECTOR_CLONES
void list_edges(const EdgeSets& cut, const HaloSet& any, CutEdges& edges) noexcept {
  NonzeroWords places;
  for (std::size_t w = 0; w < HaloSet::kWords; ++w) places.add(w, any.word[w]);
  std::uint16_t* out = edges.low.data();
  for (std::size_t f = 0; f < kEdgeFamilies; ++f) {
    NonzeroWords words;
    for (std::size_t i = 0; i < places.count; ++i) {
      words.add(places.index[i], cut[f].word[places.index[i]]);
    }
    std::uint16_t* const begin = out;
    for (std::size_t i = 0; i < words.count; ++i) {
      out = append_bits(words.bits[i], std::size_t{words.index[i]} * 64, out);
    }
    const auto count = static_cast<std::size_t>(out - begin);
    edges.run[f] = {static_cast<std::size_t>(begin - edges.low.data()), count};
    if (count == 0) continue;
    std::fill_n(out, kEdgeLanes, out[-1]);
    out = begin + edges.run[f].padded();
  }
}

}  // namespace

void find_cut_edges(const NodeSigns& signs, EdgeSets& cut, CutEdges& edges) noexcept {
  HaloSet any;
  find_all_sign_changes(signs, cut, any);
  list_edges(cut, any, edges);
}

}  // namespace tet
