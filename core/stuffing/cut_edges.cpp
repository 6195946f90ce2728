#include "core/stuffing/cut_edges.h"

#include <algorithm>
#include <bit>

#include "core/base/vector_clones.h"

namespace tet {
namespace {

/// Edges of a family with an end among the nodes that a brick needs to know.
constexpr HaloSet edges_in_reach(int family) noexcept {
  const int offset = end_offset(family_kind(family), family_direction(family));
  return kKnownNodes | seen_from(kKnownNodes, offset);
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

constexpr std::array<WordRange, kEdgeFamilies> kWordsInReach = [] {
  std::array<WordRange, kEdgeFamilies> words;
  for (std::size_t f = 0; f < kEdgeFamilies; ++f) words[f] = words_of(kEdgesInReach[f]);
  return words;
}();

/// Edges with a change of sign, family by family; `any` holds those of all families.
TET_VECTOR_CLONES
void find_sign_changes(const NodeSigns& signs, EdgeSets& cut, HaloSet& any) noexcept {
  for (int family = 0; family < kEdgeFamilies; ++family) {
    const auto f = static_cast<std::size_t>(family);
    const NodeKind kind = family_kind(family);
    const NodeKind end = end_kind(kind, family_direction(family));
    const int offset = end_offset(kind, family_direction(family));
    const auto& inside = signs.inside[kind].word;
    const auto& outside = signs.outside[kind].word;
    auto& out = cut[f].word;
    for (std::size_t w = kWordsInReach[f].begin; w < kWordsInReach[f].end; ++w) {
      const std::uint64_t end_inside = word_seen_from(signs.inside[end], w, offset);
      const std::uint64_t end_outside = word_seen_from(signs.outside[end], w, offset);
      out[w] =
          ((inside[w] & end_outside) | (outside[w] & end_inside)) & kEdgesInReach[f].word[w];
      any.word[w] |= out[w];
    }
  }
}

/// Which words of a set have bits, and what those are: found without a branch on either.
struct NonzeroWords {
  std::array<std::uint64_t, HaloSet::kWords> bits;
  std::array<std::uint16_t, HaloSet::kWords> index;

  /// Adds a word behind `count` others; returns how many there are then.
  std::size_t add(std::size_t count, std::size_t w, std::uint64_t word) noexcept {
    bits[count] = word;
    index[count] = static_cast<std::uint16_t>(w);
    return count + (word != 0 ? 1 : 0);
  }
};

/// The number of the lowest bit; of no bit, 63. No branch asks whether there is one.
std::uint16_t lowest_bit(std::uint64_t bits) noexcept {
  return static_cast<std::uint16_t>(std::countr_zero(bits | std::uint64_t{1} << 63));
}

/// Appends the set bits of a word, `first` onwards. Most words have up to four: those cost no
/// branch that is hard to foresee. Writes up to three entries too many.
std::uint16_t* append_bits(std::uint64_t bits,
                           std::uint16_t first,
                           std::uint16_t* out) noexcept {
  std::uint16_t* const end = out + std::popcount(bits);
  do {
    for (int i = 0; i < 4; ++i) {
      *out++ = static_cast<std::uint16_t>(first + lowest_bit(bits));
      bits &= bits - 1;
    }
  } while (bits != 0);
  return end;
}

TET_VECTOR_CLONES
void list_edges(const EdgeSets& cut, const HaloSet& any, CutEdges& edges) noexcept {
  NonzeroWords places;
  std::size_t place_count = 0;
  for (std::size_t w = 0; w < HaloSet::kWords; ++w) {
    place_count = places.add(place_count, w, any.word[w]);
  }
  std::uint16_t* out = edges.low.data();
  for (std::size_t f = 0; f < kEdgeFamilies; ++f) {
    NonzeroWords words;
    std::size_t word_count = 0;
    for (std::size_t i = 0; i < place_count; ++i) {
      word_count = words.add(word_count, places.index[i], cut[f].word[places.index[i]]);
    }
    std::uint16_t* const begin = out;
    for (std::size_t i = 0; i < word_count; ++i) {
      out = append_bits(words.bits[i], static_cast<std::uint16_t>(words.index[i] * 64), out);
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
  find_sign_changes(signs, cut, any);
  list_edges(cut, any, edges);
}

}  // namespace tet
