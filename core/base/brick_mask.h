// Bits for the cells or nodes of a brick, and for a brick with its halo: sets as words.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace tet {

/// One bit for each of a brick's 8 x 8 x 8 cells (or the nodes of one kind that belong to
/// them).
///
/// Slice x holds the cells (x, y, z) at bit y*8 + z, so that set bits come in the order of
/// coordinates, x first.
struct BrickMask {
  std::array<std::uint64_t, 8> slice{};

  static constexpr BrickMask all() noexcept {
    BrickMask mask;
    mask.slice.fill(~std::uint64_t{0});
    return mask;
  }

  constexpr bool test(int x, int y, int z) const noexcept {
    return (slice[static_cast<std::size_t>(x)] >> (y * 8 + z) & 1) != 0;
  }
  constexpr void set(int x, int y, int z) noexcept {
    slice[static_cast<std::size_t>(x)] |= std::uint64_t{1} << (y * 8 + z);
  }
  constexpr bool any() const noexcept {
    std::uint64_t bits = 0;
    for (const std::uint64_t word : slice) bits |= word;
    return bits != 0;
  }
  constexpr std::uint32_t count() const noexcept {
    std::uint32_t bits = 0;
    for (const std::uint64_t word : slice) {
      bits += static_cast<std::uint32_t>(std::popcount(word));
    }
    return bits;
  }

  constexpr BrickMask& operator|=(const BrickMask& o) noexcept {
    for (std::size_t i = 0; i < 8; ++i) slice[i] |= o.slice[i];
    return *this;
  }
  constexpr BrickMask& operator&=(const BrickMask& o) noexcept {
    for (std::size_t i = 0; i < 8; ++i) slice[i] &= o.slice[i];
    return *this;
  }
  friend constexpr BrickMask operator|(BrickMask a, const BrickMask& b) noexcept {
    return a |= b;
  }
  friend constexpr BrickMask operator&(BrickMask a, const BrickMask& b) noexcept {
    return a &= b;
  }
  friend constexpr BrickMask operator~(BrickMask a) noexcept {
    for (std::uint64_t& word : a.slice) word = ~word;
    return a;
  }
  friend constexpr bool operator==(const BrickMask&, const BrickMask&) = default;
};

/// A slice's bits for the cells at `z` of each of the rows at `y`: one bit for each of eight.
constexpr std::uint64_t rows_at(std::uint8_t y, std::uint8_t z) noexcept {
  std::uint64_t rows = 0;
  for (unsigned bits = y; bits != 0; bits &= bits - 1) {
    rows |= std::uint64_t{z} << 8 * std::countr_zero(bits);
  }
  return rows;
}

/// The cells of a brick that are at one of `x`, of `y` and of `z`, likewise.
constexpr BrickMask cells_at(std::uint8_t x, std::uint8_t y, std::uint8_t z) noexcept {
  const std::uint64_t rows = rows_at(y, z);
  BrickMask mask;
  for (unsigned bits = x; bits != 0; bits &= bits - 1) {
    mask.slice[static_cast<std::size_t>(std::countr_zero(bits))] = rows;
  }
  return mask;
}

/// What the next cells along `axis` say: bit (x, y, z) is that of the cell one step up, which
/// for the last ones lies in the neighbour `beyond`.
constexpr BrickMask next_along(int axis,
                               const BrickMask& mask,
                               const BrickMask& beyond) noexcept {
  constexpr std::uint64_t kFirstOfRows = 0x0101010101010101;
  BrickMask next;
  for (std::size_t x = 0; x < 8; ++x) {
    const std::uint64_t here = mask.slice[x], there = beyond.slice[x];
    next.slice[x] = axis == 0 ? (x < 7 ? mask.slice[x + 1] : beyond.slice[0])
                    : axis == 1
                        ? here >> 8 | there << 56
                        : (here >> 1 & ~(kFirstOfRows << 7)) | (there & kFirstOfRows) << 7;
  }
  return next;
}

/// Moves every cell one step down instead; `beyond` is the lower neighbour.
constexpr BrickMask previous_along(int axis,
                                   const BrickMask& mask,
                                   const BrickMask& beyond) noexcept {
  constexpr std::uint64_t kFirstOfRows = 0x0101010101010101;
  BrickMask previous;
  for (std::size_t x = 0; x < 8; ++x) {
    const std::uint64_t here = mask.slice[x], there = beyond.slice[x];
    previous.slice[x] = axis == 0   ? (x > 0 ? mask.slice[x - 1] : beyond.slice[7])
                        : axis == 1 ? here << 8 | there >> 56
                                    : (here << 1 & ~kFirstOfRows) | (there >> 7 & kFirstOfRows);
  }
  return previous;
}

/// Calls `visit(x, y, z)` for each set bit, x first.
template <class Visit>
void for_each_bit(const BrickMask& mask, const Visit& visit) {
  for (int x = 0; x < 8; ++x) {
    for (std::uint64_t bits = mask.slice[static_cast<std::size_t>(x)]; bits != 0;
         bits &= bits - 1) {
      const int bit = std::countr_zero(bits);
      visit(x, bit >> 3, bit & 7);
    }
  }
}

/// Index of a node (or cell) of a brick and its halo; each coordinate in [-2, 14).
///
/// Neighbours are a constant away: (x+dx, y+dy, z+dz) is `offset_index(dx, dy, dz)` further on.
constexpr int halo_index(int x, int y, int z) noexcept {
  return ((x + 2) * 16 + (y + 2)) * 16 + (z + 2);
}
constexpr int offset_index(int dx, int dy, int dz) noexcept { return (dx * 16 + dy) * 16 + dz; }

inline constexpr int kHaloNodes = 16 * 16 * 16;

/// One bit for each `halo_index`; set operations work on 64 of them at a time.
struct HaloSet {
  static constexpr std::size_t kWords = kHaloNodes / 64;
  std::array<std::uint64_t, kWords> word;

  constexpr HaloSet() noexcept : word{} {}

  /// The set whose word i is `word_of(i)`: one pass, and no set is cleared or copied on the
  /// way.
  template <class WordOf>
  static constexpr HaloSet from_words(const WordOf& word_of) noexcept {
    HaloSet set(kUnset);
    for (std::size_t i = 0; i < kWords; ++i) set.word[i] = word_of(i);
    return set;
  }

  constexpr bool test(int index) const noexcept {
    return (word[static_cast<std::size_t>(index >> 6)] >> (index & 63) & 1) != 0;
  }
  constexpr void set(int index) noexcept {
    word[static_cast<std::size_t>(index >> 6)] |= std::uint64_t{1} << (index & 63);
  }
  constexpr std::uint32_t count() const noexcept {
    std::uint32_t bits = 0;
    for (const std::uint64_t w : word) bits += static_cast<std::uint32_t>(std::popcount(w));
    return bits;
  }
  constexpr bool any() const noexcept {
    std::uint64_t bits = 0;
    for (const std::uint64_t w : word) bits |= w;
    return bits != 0;
  }

  constexpr HaloSet& operator|=(const HaloSet& o) noexcept {
    for (std::size_t i = 0; i < kWords; ++i) word[i] |= o.word[i];
    return *this;
  }
  constexpr HaloSet& operator&=(const HaloSet& o) noexcept {
    for (std::size_t i = 0; i < kWords; ++i) word[i] &= o.word[i];
    return *this;
  }
  /// Takes the bits of `o` away.
  constexpr HaloSet& operator-=(const HaloSet& o) noexcept {
    for (std::size_t i = 0; i < kWords; ++i) word[i] &= ~o.word[i];
    return *this;
  }
  friend constexpr HaloSet operator|(const HaloSet& a, const HaloSet& b) noexcept {
    return from_words([&](std::size_t i) { return a.word[i] | b.word[i]; });
  }
  friend constexpr HaloSet operator&(const HaloSet& a, const HaloSet& b) noexcept {
    return from_words([&](std::size_t i) { return a.word[i] & b.word[i]; });
  }
  friend constexpr HaloSet operator-(const HaloSet& a, const HaloSet& b) noexcept {
    return from_words([&](std::size_t i) { return a.word[i] & ~b.word[i]; });
  }

 private:
  enum Unset { kUnset };
  explicit constexpr HaloSet(Unset) noexcept {}

  friend constexpr HaloSet seen_from(const HaloSet& set, int offset) noexcept;
};

/// The set seen from a neighbour: bit i of the result is bit i + offset of `set`.
constexpr HaloSet seen_from(const HaloSet& set, int offset) noexcept {
  constexpr int kWords = static_cast<int>(HaloSet::kWords);
  const int words = offset >> 6;  // rounds down, so that `bits` is in [0, 64)
  const int bits = offset & 63;
  const auto at = [&](int i) { return set.word[static_cast<std::size_t>(i)]; };
  const auto within = [](int i) { return i >= 0 && i < kWords; };
  // Shifted twice, so that nothing is shifted by 64.
  const auto high_part = [&](std::uint64_t word) { return word << 1 << (63 - bits); };
  HaloSet out(HaloSet::kUnset);
  const auto edge = [&](int i) {
    const std::uint64_t low = within(i + words) ? at(i + words) >> bits : 0;
    const std::uint64_t high = within(i + words + 1) ? high_part(at(i + words + 1)) : 0;
    out.word[static_cast<std::size_t>(i)] = low | high;
  };
  // Between the edges both words exist: a plain loop, which vectorises.
  const int begin = words < 0 ? -words : 0;
  const int end = words < 0 ? kWords - 1 : kWords - 1 - words;
  for (int i = 0; i < begin; ++i) edge(i);
  for (int i = begin; i < end; ++i) {
    out.word[static_cast<std::size_t>(i)] =
        at(i + words) >> bits | high_part(at(i + words + 1));
  }
  for (int i = end > begin ? end : begin; i < kWords; ++i) edge(i);
  return out;
}

/// Word `w` of what `seen_from` makes of a set, where every bit of it comes from within the
/// set.
constexpr std::uint64_t word_seen_from(const HaloSet& set, std::size_t w, int offset) noexcept {
  const std::size_t at = w + static_cast<std::size_t>(offset >> 6);  // wraps if negative
  // Shifted twice, so that nothing is shifted by 64.
  return set.word[at] >> (offset & 63) | set.word[at + 1] << 1 << (63 - (offset & 63));
}

/// The set that holds every index of the box [min, max]^3, both ends included.
constexpr HaloSet halo_cube(int min, int max) noexcept {
  HaloSet set;
  for (int x = min; x <= max; ++x) {
    for (int y = min; y <= max; ++y) {
      for (int z = min; z <= max; ++z) set.set(halo_index(x, y, z));
    }
  }
  return set;
}

/// Calls `visit(index)` for each set bit, in increasing order.
template <class Visit>
void for_each_bit(const HaloSet& set, const Visit& visit) {
  for (int w = 0; w < static_cast<int>(HaloSet::kWords); ++w) {
    for (std::uint64_t bits = set.word[static_cast<std::size_t>(w)]; bits != 0;
         bits &= bits - 1) {
      visit(w * 64 + std::countr_zero(bits));
    }
  }
}

/// Copies the cells of the brick itself, [0, 8)^3, out of a halo set.
BrickMask brick_part(const HaloSet& set) noexcept;
/// Copies the 8^3 cells that begin at (dx, dy, dz), each in -1..1: cell (x, y, z) of the result
/// is the set's (x + dx, y + dy, z + dz).
BrickMask brick_part(const HaloSet& set, int dx, int dy, int dz) noexcept;

/// Adds what `mask` says of the neighbour brick at (bx, by, bz), each in -1..1, where it lies
/// within the halo.
void add_brick(HaloSet& set, const BrickMask& mask, int bx, int by, int bz) noexcept;

}  // namespace tet
