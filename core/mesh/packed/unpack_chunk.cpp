#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>
#include <optional>

#include <absl/strings/str_cat.h>

#include "core/base/byte_coding.h"
#include "core/base/sse.h"
#include "core/mesh/packed/corner_lanes.h"
#include "core/mesh/packed/packed_chunk.h"
#include "core/mesh/packed/packed_rows.h"

namespace tet {
namespace {

absl::Status broken(const char* what) {
  return absl::DataLossError(absl::StrCat("a packed chunk is broken: ", what));
}

/// The rows of a column as they came.
struct Rows {
  std::vector<std::uint16_t> listed;  ///< patterns
  std::span<const std::byte> tokens;  ///< for each row the number of its pattern in the list
  std::span<const std::byte> said;    ///< what the patterns leave to be said, row by row
};

/// More than any chunk has: what a row takes whose pattern is not listed.
constexpr std::uint64_t kImpossible = std::uint64_t{1} << 40;

/// Reads `count` rows, of patterns below `patterns`; std::nullopt when the bytes are no such
/// rows.
template <class BytesOf>
std::optional<Rows> read_rows(ByteReader& reader,
                              std::size_t count,
                              std::size_t patterns,
                              const BytesOf& bytes_of) {
  Rows rows;
  const std::uint64_t listed = reader.varint();
  if (listed > kMaxListed) return std::nullopt;
  std::array<std::uint64_t, kMaxListed> bytes;
  bytes.fill(kImpossible);
  for (std::uint64_t i = 0; i < listed; ++i) {
    const auto pattern = reader.number<std::uint16_t>();
    if (pattern >= patterns) return std::nullopt;
    rows.listed.push_back(pattern);
    bytes[i] = bytes_of(pattern);
  }
  rows.tokens = reader.take(count);
  std::uint64_t said = 0;
  for (const std::byte token : rows.tokens) said += bytes[std::to_integer<std::size_t>(token)];
  rows.said = reader.take(said);
  return reader.failed() ? std::nullopt : std::optional(std::move(rows));
}

template <class Word>
std::size_t vertex_bytes(unsigned pattern) noexcept {
  constexpr auto kRules = coordinate_rules<Word>();
  std::size_t bytes = 0;
  for (int c = 0; c < 3; ++c, pattern /= kCoordinateKinds) {
    bytes += kRules[pattern % kCoordinateKinds].bytes;
  }
  return bytes;
}

/// How a pattern puts a vertex together.
template <class Word>
struct VertexMoves {
  struct Coordinate {
    CoordinateRule<Word> rule;
    std::uint32_t at;  ///< its bytes among those that are said of the vertex
  };
  std::array<Coordinate, 3> coordinates{};
  std::uint32_t bytes = 0;

  VertexMoves() = default;
  explicit VertexMoves(unsigned pattern) noexcept {
    constexpr auto kRules = coordinate_rules<Word>();
    for (Coordinate& coordinate : coordinates) {
      coordinate = {kRules[pattern % kCoordinateKinds], bytes};
      bytes += coordinate.rule.bytes;
      pattern /= kCoordinateKinds;
    }
  }
};

/// `memory` is for what lies before the first vertex, too.
template <class Word>
void unpack_positions(const Rows& rows,
                      std::vector<std::byte>& memory,
                      std::span<std::byte> positions) {
  std::array<VertexMoves<Word>, kMaxListed> moves;
  std::ranges::transform(rows.listed, moves.begin(),
                         [](auto p) { return VertexMoves<Word>(p); });
  constexpr std::size_t kBefore = 4 * 3;
  memory.resize(kBefore * sizeof(Word) + positions.size());
  std::fill_n(memory.begin(), kBefore * sizeof(Word), std::byte{0});
  auto* row = reinterpret_cast<Word*>(memory.data()) + kBefore;
  const std::byte* said = rows.said.data();
  for (const std::byte token : rows.tokens) {
    const VertexMoves<Word>& move = moves[std::to_integer<std::size_t>(token)];
    for (int c = 0; c < 3; ++c) {
      const auto& [rule, at] = move.coordinates[static_cast<std::size_t>(c)];
      Word word;
      std::memcpy(&word, said + at, sizeof(word));
      const Word base = row[c - 3 * rule.before] & rule.kept;
      row[c] = static_cast<Word>(base + ((word & rule.said) << rule.shift) - rule.bias);
    }
    row += 3;
    said += move.bytes;
  }
  std::copy_n(memory.begin() + kBefore * sizeof(Word), positions.size(), positions.begin());
}

std::size_t tet_bytes(unsigned pattern) noexcept {
  std::size_t bytes = 0;
  for (int k = 0; k < 4; ++k, pattern /= kCornerKinds) {
    bytes += kCornerBytes[pattern % kCornerKinds];
  }
  return bytes;
}

/// What a pattern does to all corners of a tet at once.
struct TetMoves {
  LaneBytes places{};            ///< which of the bytes that are said go where
  LaneBytes steps{};             ///< added besides
  LaneBytes is_back{}, jumps{};  ///< masks
  std::uint64_t bytes = 0;

  TetMoves() = default;
  explicit TetMoves(unsigned pattern) noexcept {
    constexpr std::uint8_t kNothing = 0x80, kAll = 0xff;
    for (std::size_t at = 0; at < 8; at += 2, pattern /= kCornerKinds) {
      const auto kind = static_cast<CornerKind>(pattern % kCornerKinds);
      const bool is_short = kind <= kNextButOne;
      for (std::size_t b = 0; b < 2; ++b) {
        const bool is_said = b < kCornerBytes[kind];
        places[at + b] = is_said ? static_cast<std::uint8_t>(bytes++) : kNothing;
        is_back[at + b] = kind == kBack ? kAll : 0;
        jumps[at + b] = kind >= kBack ? kAll : 0;
      }
      const int step = is_short ? kind : kind == kFar ? 0 : -kNearBias;
      steps[at] = static_cast<std::uint8_t>(step);
      steps[at + 1] = static_cast<std::uint8_t>(step >> 8);
    }
  }
};

/// Ids of `ids`, which has kMaxLocalVertices, whichever the corners are. Returns the largest
/// corner.
template <class Id>
std::uint16_t unpack_tets(const Rows& rows, const Id* ids, std::span<std::byte> tets) noexcept {
  std::array<TetMoves, kMaxListed> moves;
  std::ranges::transform(rows.listed, moves.begin(), [](auto p) { return TetMoves(p); });
  const std::byte* said = rows.said.data();
  std::byte* out = tets.data();
  __m128i at = _mm_setzero_si128(), before_jump = at, largest = at;
  for (const std::byte token : rows.tokens) {
    const TetMoves& move = moves[std::to_integer<std::size_t>(token)];
    const __m128i jumps = load_lanes(&move.jumps), is_back = load_lanes(&move.is_back);
    const __m128i told = _mm_shuffle_epi8(load_lanes(said), load_lanes(&move.places));
    const __m128i base = _mm_blendv_epi8(at, before_jump, is_back);
    before_jump = _mm_blendv_epi8(before_jump, at, jumps);
    at = _mm_add_epi16(base, _mm_add_epi16(told, load_lanes(&move.steps)));
    largest = _mm_max_epu16(largest, at);
    const auto corners = static_cast<std::uint64_t>(_mm_cvtsi128_si64(at));
    const std::array<Id, 4> tet{ids[corners & 0xffff], ids[corners >> 16 & 0xffff],
                                ids[corners >> 32 & 0xffff], ids[corners >> 48]};
    std::memcpy(out, tet.data(), sizeof(tet));
    out += sizeof(tet);
    said += move.bytes;
  }
  std::array<std::uint16_t, 8> lanes;
  std::memcpy(lanes.data(), &largest, sizeof(lanes));
  return *std::max_element(lanes.begin(), lanes.begin() + 4);
}

/// Reads the ids of other chunks' vertices behind the chunk's own. Returns how many there are
/// together; nothing where they are no vertices of the mesh.
template <class Id>
std::optional<std::size_t> read_ids(ByteReader& reader,
                                    const MeshHeader& header,
                                    const ChunkExtent& extent,
                                    std::vector<Id>& ids) {
  const std::uint64_t others = reader.varint();
  if (extent.vertex_count > kMaxLocalVertices ||
      others > kMaxLocalVertices - extent.vertex_count) {
    return std::nullopt;
  }
  ids.resize(kMaxLocalVertices);
  const auto own_end = ids.begin() + static_cast<std::ptrdiff_t>(extent.vertex_count);
  std::iota(ids.begin(), own_end, static_cast<Id>(extent.first_vertex));
  std::uint64_t id = 0;
  for (std::size_t i = 0; i < others; ++i) {
    const std::uint64_t step = reader.varint();
    if (step >= header.vertex_count - id) return std::nullopt;
    id += step;
    own_end[static_cast<std::ptrdiff_t>(i)] = static_cast<Id>(id);
  }
  return extent.vertex_count + others;
}

template <class Id>
absl::Status unpack_corners(const std::optional<Rows>& rows,
                            const std::vector<Id>& ids,
                            std::size_t local_vertices,
                            std::span<std::byte> tets) {
  if (!rows) return broken("tets of no known pattern");
  const std::uint16_t largest = unpack_tets(*rows, ids.data(), tets);
  if (!tets.empty() && largest >= local_vertices) return broken("a corner at no vertex");
  return absl::OkStatus();
}

void unpack_regions(std::span<const std::byte> bits, std::span<std::byte> regions) noexcept {
  for (std::size_t i = 0; i < regions.size(); ++i) {
    const bool outside = (bits[i / 8] >> (i % 8) & std::byte{1}) != std::byte{0};
    regions[i] = static_cast<std::byte>(outside ? MeshRegion::kOutside : MeshRegion::kInside);
  }
}

/// Writes the labels of tets from their runs; false where they are none of the header's, or
/// not as many.
bool unpack_labels(ByteReader& reader,
                   const MeshHeader& header,
                   std::span<std::byte> regions) noexcept {
  std::byte* out = regions.data();
  for (std::size_t left = regions.size() / sizeof(LabelNumber); left > 0;) {
    const std::uint64_t label = reader.varint(), run = reader.varint();
    if (label >= header.labels.size() || run == 0 || run > left) return false;
    const auto number = static_cast<LabelNumber>(label);
    for (std::uint64_t i = 0; i < run; ++i, out += sizeof(number)) {
      std::memcpy(out, &number, sizeof(number));
    }
    left -= run;
  }
  return true;
}

/// Faces as they came: 4 * tet + the corner opposite, within the chunk, and labels.
struct PackedFaces {
  std::vector<std::uint64_t> faces;
  std::vector<std::uint16_t> labels;
};

/// Reads them; returns nothing where they are no faces of the chunk's tets in their order, or
/// have no labels.
std::optional<PackedFaces> read_faces(ByteReader& reader,
                                      const MeshHeader& header,
                                      const ChunkExtent& extent) {
  PackedFaces packed;
  const std::uint64_t faces = 4 * extent.tet_count;
  std::uint64_t next = 0;
  for (std::uint64_t i = 0; i < extent.face_count; ++i) {
    const std::uint64_t step = reader.varint();
    if (reader.failed() || next >= faces || step >= faces - next) return std::nullopt;
    packed.faces.push_back(next + step);
    next += step + 1;
  }
  while (packed.labels.size() < extent.face_count) {
    const std::uint64_t label = reader.varint(), run = reader.varint();
    if (label >= header.face_labels.size() || run == 0 ||
        run > extent.face_count - packed.labels.size()) {
      return std::nullopt;
    }
    packed.labels.insert(packed.labels.end(), run, static_cast<std::uint16_t>(label));
  }
  return packed;
}

/// The tets are unpacked already.
template <class Id>
void unpack_faces(const PackedFaces& packed,
                  const ChunkExtent& extent,
                  const ChunkColumns& columns) noexcept {
  std::byte* ids = columns.faces.data();
  std::byte* of_tet = columns.face_tets.data();
  for (const std::uint64_t face : packed.faces) {
    const std::byte* const tet = columns.tets.data() + face / 4 * 4 * sizeof(Id);
    for (const std::uint8_t corner : kFaceCorners[face % 4]) {
      std::memcpy(ids, tet + corner * sizeof(Id), sizeof(Id));
      ids += sizeof(Id);
    }
    const auto number = static_cast<Id>(extent.first_tet + face / 4);
    std::memcpy(of_tet, &number, sizeof(Id));
    of_tet += sizeof(Id);
  }
  if (!packed.labels.empty()) {
    std::memcpy(columns.face_labels.data(), packed.labels.data(), columns.face_labels.size());
  }
}

template <class Word>
std::optional<Rows> read_vertex_rows(ByteReader& reader, std::size_t count) {
  return read_rows(reader, count, kVertexPatterns, vertex_bytes<Word>);
}

}  // namespace

absl::Status ChunkUnpacker::unpack(std::span<const std::byte> bytes,
                                   const MeshHeader& header,
                                   const ChunkExtent& extent,
                                   const ChunkColumns& columns) {
  if (bytes.size() < kPackedPadding) return broken("it is too short");
  const bool wide_ids = header.index_type == IndexType::kUint64;
  const bool doubles = header.coordinate_type == CoordinateType::kFloat64;
  ByteReader reader(bytes.first(bytes.size() - kPackedPadding));
  const auto local_vertices = wide_ids ? read_ids(reader, header, extent, wide_ids_)
                                       : read_ids(reader, header, extent, ids_);
  if (!local_vertices) return broken("it names vertices that do not exist");

  const auto vertices = doubles ? read_vertex_rows<std::uint64_t>(reader, extent.vertex_count)
                                : read_vertex_rows<std::uint32_t>(reader, extent.vertex_count);
  if (!vertices) return broken("vertices of no known pattern");
  const auto tets = read_rows(reader, extent.tet_count, kTetPatterns, tet_bytes);
  const bool has_labels = !header.labels.empty();
  if (has_labels && !unpack_labels(reader, header, columns.regions)) {
    return broken("labels that do not exist, or are not as many as its tets");
  }
  const auto regions = reader.take(has_labels ? 0 : (columns.regions.size() + 7) / 8);
  const auto fields = reader.take(columns.fields.size());
  const auto faces = read_faces(reader, header, extent);
  if (!faces) return broken("faces that are not of its tets, or without a label");
  if (reader.failed() || !reader.at_end()) return broken("it does not end where it says");

  absl::Status status = wide_ids
                            ? unpack_corners(tets, wide_ids_, *local_vertices, columns.tets)
                            : unpack_corners(tets, ids_, *local_vertices, columns.tets);
  if (!status.ok()) return status;
  if (doubles) {
    unpack_positions<std::uint64_t>(*vertices, rows_, columns.positions);
  } else {
    unpack_positions<std::uint32_t>(*vertices, rows_, columns.positions);
  }
  if (!has_labels) unpack_regions(regions, columns.regions);
  std::ranges::copy(fields, columns.fields.begin());
  if (wide_ids) {
    unpack_faces<std::uint64_t>(*faces, extent, columns);
  } else {
    unpack_faces<std::uint32_t>(*faces, extent, columns);
  }
  return absl::OkStatus();
}

}  // namespace tet
