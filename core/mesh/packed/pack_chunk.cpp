#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <utility>

#include "core/base/byte_coding.h"
#include "core/base/sse.h"
#include "core/mesh/packed/corner_lanes.h"
#include "core/mesh/packed/packed_chunk.h"
#include "core/mesh/packed/packed_rows.h"

namespace tet {
namespace {

/// The patterns that a chunk's rows are written with.
class ListedPatterns {
 public:
  /// `rows` are patterns below `count`. The most frequent are listed; a row of another is
  /// written with the one that `widened` gives instead, of which there are `wide` at most.
  template <class Widen>
  ListedPatterns(std::span<const std::uint16_t> rows,
                 std::size_t count,
                 std::size_t wide,
                 const Widen& widened)
      : token_(count) {
    std::vector<std::uint32_t> frequency(count);
    for (const std::uint16_t pattern : rows) ++frequency[pattern];
    std::vector<std::uint16_t> by_frequency;
    for (std::size_t p = 0; p < count; ++p) {
      if (frequency[p] > 0) by_frequency.push_back(static_cast<std::uint16_t>(p));
    }
    std::ranges::stable_sort(by_frequency, std::greater(),
                             [&](std::uint16_t p) { return frequency[p]; });
    std::vector<bool> is_listed(count);
    for (const std::uint16_t pattern : by_frequency) {
      const bool has_room = listed_.size() + wide < kMaxListed;
      const std::uint16_t used = has_room ? pattern : widened(pattern);
      if (!is_listed[used]) {
        is_listed[used] = true;
        token_[used] = static_cast<std::uint8_t>(listed_.size());
        listed_.push_back(used);
      }
      token_[pattern] = token_[used];
    }
  }

  /// The table, and then a byte for each row.
  void write(std::span<const std::uint16_t> rows, ByteWriter& out) const {
    out.varint(listed_.size());
    for (const std::uint16_t pattern : listed_) out.number(pattern);
    std::byte* const tokens = out.extend(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) tokens[i] = std::byte{token_[rows[i]]};
  }

  std::span<const std::uint16_t> listed() const noexcept { return listed_; }
  /// Where in the list the pattern is that a pattern is written with.
  std::uint8_t token(std::uint16_t pattern) const noexcept { return token_[pattern]; }

 private:
  std::vector<std::uint16_t> listed_;
  std::vector<std::uint8_t> token_;  // by pattern
};

/// Appends the lower bytes of numbers, without a look at how many each time.
template <class Number>
class LowBytes {
 public:
  /// No more than `most` bytes will be written.
  LowBytes(std::vector<std::byte>& bytes, std::size_t most)
      : bytes_(bytes), end_(bytes.size()) {
    bytes.resize(end_ + most + sizeof(Number));
  }
  void write(Number value, std::size_t count) noexcept {
    std::memcpy(&bytes_[end_], &value, sizeof(value));
    end_ += count;
  }
  void finish() { bytes_.resize(end_); }

 private:
  std::vector<std::byte>& bytes_;
  std::size_t end_;
};

template <class Word>
std::array<Word, 3> read_vertex(std::span<const std::byte> positions, std::size_t i) noexcept {
  std::array<Word, 3> words;
  std::memcpy(words.data(), positions.data() + i * sizeof(words), sizeof(words));
  return words;
}

/// The kind that leaves the fewest bytes to be said. Without branches: none could be foreseen.
template <class Word>
CoordinateKind kind_of(Word word, const std::array<Word, 4>& before) noexcept {
  constexpr auto kRules = coordinate_rules<Word>();
  const bool is_low = ((word ^ before[0]) & kRules[kLow].kept) == 0;
  const auto step = static_cast<Word>(word - before[0] + kRules[kClose].bias);
  CoordinateKind kind = is_low ? kLow : kWhole;
  kind = step <= kRules[kClose].said ? kClose : kind;
  kind = (word & kRules[kShort].said) == 0 ? kShort : kind;
  for (const CoordinateKind same : {kSameAsFourth, kSameAsThird, kSameAsSecond, kSame}) {
    kind = word == before[same] ? same : kind;
  }
  return kind;
}

/// The bytes that a coordinate of a kind is written as; higher bytes of the result are not
/// written.
template <class Word>
Word said_of(Word word, CoordinateKind kind, Word before) noexcept {
  constexpr auto kRules = coordinate_rules<Word>();
  const CoordinateRule<Word>& rule = kRules[kind];
  return static_cast<Word>(word - (before & rule.kept) + rule.bias) >> rule.shift;
}

template <class Id>
std::uint64_t read_id(std::span<const std::byte> tets, std::size_t i) noexcept {
  Id id;
  std::memcpy(&id, tets.data() + i * sizeof(id), sizeof(id));
  return id;
}

constexpr std::uint16_t kWholeVertex = kVertexPatterns - 1;

/// kNear, kBack and kFar of each corner.
constexpr std::size_t kWideTetPatterns = 3 * 3 * 3 * 3;

/// Replaces a pattern's kinds without bytes of their own by kNear, which has one and says the
/// same.
std::uint16_t widened_tet(std::uint16_t pattern) noexcept {
  unsigned widened = 0;
  for (unsigned weight = 1; weight < kTetPatterns; weight *= kCornerKinds) {
    widened += weight * std::max<unsigned>(pattern / weight % kCornerKinds, kNear);
  }
  return static_cast<std::uint16_t>(widened);
}

/// Walks from tet to tet, all corners at once: 16 bits for each in a register's lower half.
class CornerTracks {
 public:
  /// Goes on to the next tet; `steps` become what is said of its corners. Returns its pattern.
  std::uint16_t advance(const std::uint16_t* corners, std::uint16_t* steps) noexcept {
    const auto all = [](int kind) { return _mm_set1_epi16(static_cast<short>(kind)); };
    const __m128i next = load_lanes(corners);
    const __m128i ahead = _mm_sub_epi16(next, at_), back = _mm_sub_epi16(next, before_jump_);
    const __m128i is_short = _mm_cmpeq_epi16(_mm_min_epu16(ahead, all(kNextButOne)), ahead);
    __m128i kinds = _mm_blendv_epi8(all(kFar), all(kBack), is_near(back));
    kinds = _mm_blendv_epi8(kinds, all(kNear), is_near(ahead));
    kinds = _mm_blendv_epi8(kinds, ahead, is_short);
    const __m128i said = _mm_blendv_epi8(ahead, back, _mm_cmpeq_epi16(kinds, all(kBack)));
    store_lanes(steps, said);
    before_jump_ = _mm_blendv_epi8(before_jump_, at_, _mm_cmpgt_epi16(kinds, all(kNear)));
    at_ = next;
    constexpr int kSecond = kCornerKinds, kThird = kSecond * kCornerKinds;
    const __m128i weights =
        _mm_setr_epi16(1, kSecond, kThird, kThird * kCornerKinds, 0, 0, 0, 0);
    const __m128i halves = _mm_madd_epi16(kinds, weights);
    return static_cast<std::uint16_t>(_mm_extract_epi16(halves, 0) +
                                      _mm_extract_epi16(halves, 2));
  }

 private:
  static __m128i is_near(__m128i steps) noexcept {
    const __m128i biased = _mm_add_epi16(steps, _mm_set1_epi16(kNearBias));
    return _mm_cmpeq_epi16(_mm_srli_epi16(biased, 8), _mm_setzero_si128());
  }

  __m128i at_ = _mm_setzero_si128(), before_jump_ = _mm_setzero_si128();
};

/// How a pattern's steps become the bytes that are said.
struct TetSaying {
  LaneBytes biases{}, picks{};
  std::uint8_t bytes = 0;

  TetSaying() = default;
  explicit TetSaying(unsigned pattern) noexcept {
    for (std::uint8_t k = 0; k < 4; ++k, pattern /= kCornerKinds) {
      const auto kind = static_cast<CornerKind>(pattern % kCornerKinds);
      biases[2U * k] = kind == kFar ? 0 : kNearBias;
      for (std::uint8_t b = 0; b < kCornerBytes[kind]; ++b) {
        picks[bytes++] = static_cast<std::uint8_t>(2 * k + b);
      }
    }
  }
};

void pack_regions(std::span<const std::byte> regions, ByteWriter& out) {
  std::byte* const bits = out.extend((regions.size() + 7) / 8);
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const bool outside = regions[i] == static_cast<std::byte>(MeshRegion::kOutside);
    bits[i / 8] |= std::byte{outside} << (i % 8);
  }
}

/// Runs of tets with one label: tets are sorted by label, brick by brick.
void pack_labels(std::span<const std::byte> labels, ByteWriter& out) {
  const std::size_t tets = labels.size() / sizeof(LabelNumber);
  const auto label = [&](std::size_t i) { return read_id<LabelNumber>(labels, i); };
  for (std::size_t i = 0, end = 0; i < tets; i = end) {
    while (end < tets && label(end) == label(i)) ++end;
    out.varint(label(i));
    out.varint(end - i);
  }
}

/// Says of each face how far it is behind the one before it, of the chunk's tets' four each;
/// then the labels, by runs.
template <class Id>
void pack_faces(const ChunkExtent& extent, const ChunkColumns& columns, ByteWriter& out) {
  std::uint64_t next = 0;
  for (std::uint64_t i = 0; i < extent.face_count; ++i) {
    const std::uint64_t tet = read_id<Id>(columns.face_tets, i) - extent.first_tet;
    std::size_t k = 0;
    const auto is_face = [&] {
      for (std::size_t c = 0; c < 3; ++c) {
        if (read_id<Id>(columns.faces, 3 * i + c) !=
            read_id<Id>(columns.tets, 4 * tet + kFaceCorners[k][c])) {
          return false;
        }
      }
      return true;
    };
    while (k < 3 && !is_face()) ++k;
    out.varint(4 * tet + k - next);
    next = 4 * tet + k + 1;
  }
  const auto label = [&](std::uint64_t i) {
    return read_id<std::uint16_t>(columns.face_labels, i);
  };
  for (std::uint64_t i = 0, end = 0; i < extent.face_count; i = end) {
    while (end < extent.face_count && label(end) == label(i)) ++end;
    out.varint(label(i));
    out.varint(end - i);
  }
}

}  // namespace

std::span<const std::byte> ChunkPacker::pack(const MeshHeader& header,
                                             const ChunkExtent& extent,
                                             const ChunkColumns& columns) {
  const bool numbered = header.index_type == IndexType::kUint64
                            ? number_corners<std::uint64_t>(extent, columns.tets)
                            : number_corners<std::uint32_t>(extent, columns.tets);
  if (!numbered) return {};
  bytes_.clear();
  ByteWriter out(bytes_);
  out.varint(others_.size());
  std::uint64_t last = 0;
  for (const std::uint64_t id : others_) out.varint(id - std::exchange(last, id));
  if (header.coordinate_type == CoordinateType::kFloat64) {
    pack_positions<std::uint64_t>(columns.positions);
  } else {
    pack_positions<std::uint32_t>(columns.positions);
  }
  pack_tets();
  header.labels.empty() ? pack_regions(columns.regions, out)
                        : pack_labels(columns.regions, out);
  out.append(columns.fields);
  if (header.index_type == IndexType::kUint64) {
    pack_faces<std::uint64_t>(extent, columns, out);
  } else {
    pack_faces<std::uint32_t>(extent, columns, out);
  }
  out.extend(kPackedPadding);
  return bytes_;
}

/// Numbers all corners; false where 16 bits do not hold that.
template <class Id>
bool ChunkPacker::number_corners(const ChunkExtent& extent, std::span<const std::byte> tets) {
  const std::size_t count = tets.size() / sizeof(Id);
  corners_.resize(count);
  elsewhere_.resize(count + 1);
  std::size_t elsewhere = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t own = read_id<Id>(tets, i) - extent.first_vertex;
    corners_[i] = static_cast<std::uint16_t>(own);
    // Without a branch: it could not be foreseen.
    elsewhere_[elsewhere] = static_cast<std::uint32_t>(i);
    elsewhere += own >= extent.vertex_count;
  }
  elsewhere_.resize(elsewhere);
  find_others<Id>(tets);
  if (extent.vertex_count + others_.size() > kMaxLocalVertices) return false;
  for (std::uint64_t i = 0; i < others_.size(); ++i) {
    recent(others_[i]) = {others_[i], extent.vertex_count + i};
  }
  for (const std::uint32_t i : elsewhere_) {
    const std::uint64_t id = read_id<Id>(tets, i);
    std::uint64_t number = recent(id).number;
    if (recent(id).id != id) {
      const auto found = std::ranges::lower_bound(others_, id);
      number = extent.vertex_count + static_cast<std::uint64_t>(found - others_.begin());
    }
    corners_[i] = static_cast<std::uint16_t>(number);
  }
  return true;
}

template <class Id>
void ChunkPacker::find_others(std::span<const std::byte> tets) {
  recent_.assign(kRecentVertices, {});
  others_.clear();
  for (const std::uint32_t i : elsewhere_) {
    const std::uint64_t id = read_id<Id>(tets, i);
    if (recent(id).id == id) continue;
    recent(id).id = id;
    others_.push_back(id);
  }
  std::ranges::sort(others_);
  others_.erase(std::unique(others_.begin(), others_.end()), others_.end());
}

template <class Word>
void ChunkPacker::pack_positions(std::span<const std::byte> positions) {
  const std::size_t count = positions.size() / (3 * sizeof(Word));
  patterns_.resize(count);
  std::array<std::array<Word, 4>, 3> before{};  // by coordinate, the last vertex first
  for (std::size_t v = 0; v < count; ++v) {
    const std::array<Word, 3> words = read_vertex<Word>(positions, v);
    unsigned pattern = 0;
    for (std::size_t c = 3; c-- > 0;) {
      pattern = pattern * kCoordinateKinds + kind_of(words[c], before[c]);
      std::shift_right(before[c].begin(), before[c].end(), 1);
      before[c][0] = words[c];
    }
    patterns_[v] = static_cast<std::uint16_t>(pattern);
  }
  const ListedPatterns listed(patterns_, kVertexPatterns, 1,
                              [](std::uint16_t) { return kWholeVertex; });
  ByteWriter out(bytes_);
  listed.write(patterns_, out);

  constexpr auto kRules = coordinate_rules<Word>();
  LowBytes<Word> said(bytes_, positions.size());
  std::array<Word, 3> last{};
  for (std::size_t v = 0; v < count; ++v) {
    const std::array<Word, 3> words = read_vertex<Word>(positions, v);
    unsigned pattern = listed.listed()[listed.token(patterns_[v])];
    for (std::size_t c = 0; c < 3; ++c) {
      const auto kind = static_cast<CoordinateKind>(pattern % kCoordinateKinds);
      said.write(said_of(words[c], kind, last[c]), kRules[kind].bytes);
      pattern /= kCoordinateKinds;
    }
    last = words;
  }
  said.finish();
}

void ChunkPacker::pack_tets() {
  const std::size_t count = corners_.size() / 4;
  patterns_.resize(count);
  steps_.resize(corners_.size());
  CornerTracks tracks;
  for (std::size_t t = 0; t < count; ++t) {
    patterns_[t] = tracks.advance(&corners_[4 * t], &steps_[4 * t]);
  }
  const ListedPatterns listed(patterns_, kTetPatterns, kWideTetPatterns, widened_tet);
  ByteWriter out(bytes_);
  listed.write(patterns_, out);

  std::array<TetSaying, kMaxListed> sayings;
  std::ranges::transform(listed.listed(), sayings.begin(), [](auto p) { return TetSaying(p); });
  std::size_t end = bytes_.size();
  bytes_.resize(end + corners_.size() * 2);
  for (std::size_t t = 0; t < count; ++t) {
    const TetSaying& saying = sayings[listed.token(patterns_[t])];
    const __m128i biased =
        _mm_add_epi16(load_lanes(&steps_[4 * t]), load_lanes(&saying.biases));
    store_lanes(&bytes_[end], _mm_shuffle_epi8(biased, load_lanes(&saying.picks)));
    end += saying.bytes;
  }
  bytes_.resize(end);
}

}  // namespace tet
