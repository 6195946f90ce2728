// How rows of a packed chunk are written: for each its pattern, which says what kind each of
// its numbers is, and then the bytes that those kinds leave to be said.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace tet {

/// A chunk has a table of the patterns that occur in it: a row says which in a byte.
inline constexpr std::size_t kMaxListed = 256;

/// A decoder may read this many bytes at once wherever it is.
inline constexpr std::size_t kPackedPadding = 16;

/// Corners are numbered within a chunk: its own vertices first, then those of others.
inline constexpr std::size_t kMaxLocalVertices = std::size_t{1} << 16;

// A corner of a tet, beside the same corner of the tet before: tets lie in runs along which
// each corner's number goes up by a little, and runs alternate.
enum CornerKind : std::uint8_t {
  kRepeated,  ///< the same vertex
  kNext,      ///< the next one
  kNextButOne,
  kNear,  ///< up to 128 away: one byte, the difference plus 128
  kBack,  ///< the same, beside where this corner was before its last jump; a jump
  kFar,   ///< two bytes, the difference; a jump
  kCornerKinds,
};
inline constexpr std::uint8_t kNearBias = 128;
inline constexpr std::array<std::uint8_t, kCornerKinds> kCornerBytes{0, 0, 0, 1, 1, 2};
inline constexpr std::size_t kTetPatterns =
    std::size_t{kCornerKinds} * kCornerKinds * kCornerKinds * kCornerKinds;

// A coordinate, beside that of vertices before, as the bits of an IEEE 754 number.
enum CoordinateKind : std::uint8_t {
  kSame,  ///< as that of the vertex before
  kSameAsSecond,
  kSameAsThird,
  kSameAsFourth,  ///< of the vertices before
  kShort,         ///< its lower half is zero: the upper half
  kClose,         ///< less the one before as an integer: half of a word, biased by its half
  kLow,           ///< the upper quarter is that of the one before: the other three
  kWhole,
  kCoordinateKinds,
};
inline constexpr std::size_t kVertexPatterns =
    std::size_t{kCoordinateKinds} * kCoordinateKinds * kCoordinateKinds;

/// How a coordinate of a kind is put together: the base's bits under `kept`, plus the bytes
/// that are said, shifted, less `bias`.
template <class Word>
struct CoordinateRule {
  std::uint8_t before;  ///< the base is that of so many vertices before
  std::uint8_t bytes;
  std::uint8_t shift;
  Word kept;
  Word said;  ///< where the bytes that are said are, before they are shifted
  Word bias;
};

template <class Word>
constexpr std::array<CoordinateRule<Word>, kCoordinateKinds> coordinate_rules() noexcept {
  constexpr std::uint8_t kBytes = sizeof(Word);
  constexpr Word kAll = std::numeric_limits<Word>::max();
  constexpr Word kLowerHalf = kAll >> (kBytes * 4), kLowerThree = kAll >> (kBytes * 2);
  std::array<CoordinateRule<Word>, kCoordinateKinds> rules{};
  for (std::uint8_t before = 1; before <= 4; ++before) {
    rules[before - 1U] = {before, 0, 0, kAll, 0, 0};
  }
  rules[kShort] = {1, kBytes / 2, kBytes * 4, 0, kLowerHalf, 0};
  rules[kClose] = {1, kBytes / 2, 0, kAll, kLowerHalf, (kLowerHalf >> 1) + 1};
  rules[kLow] = {1, kBytes / 4 * 3, 0, static_cast<Word>(~kLowerThree), kLowerThree, 0};
  rules[kWhole] = {1, kBytes, 0, 0, kAll, 0};
  return rules;
}

}  // namespace tet
