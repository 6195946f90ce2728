#include "core/plan/brick/survey_bytes.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <memory>
#include <type_traits>
#include <utility>

#include "core/base/check.h"

namespace tet {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kWordsOfGroup = 64;

/// A row has no padding: the same values are the same bytes.
template <class T>
concept PlainRow =
    std::is_trivially_copyable_v<T> && std::has_unique_object_representations_v<T>;

class SurveyWriter {
 public:
  template <PlainRow T>
  void row(const T& value) {
    put(&value, sizeof value);
  }

  template <PlainRow T>
  void column(const std::vector<T>& values) {
    row(std::uint64_t{values.size()});
    put(values.data(), values.size() * sizeof(T));
  }

  /// Rows of words, most of which are often 0: those are left out.
  template <PlainRow T>
  void sparse_column(const std::vector<T>& values) {
    row(std::uint64_t{values.size()});
    std::vector<std::uint64_t> words(values.size() * sizeof(T) / 8);
    if (!words.empty()) std::memcpy(words.data(), values.data(), words.size() * 8);
    for (std::size_t begin = 0; begin < words.size(); begin += kWordsOfGroup) {
      const std::span group =
          std::span(words).subspan(begin, std::min(kWordsOfGroup, words.size() - begin));
      std::uint64_t present = 0;
      for (std::size_t i = 0; i < group.size(); ++i) {
        present |= std::uint64_t{group[i] != 0} << i;
      }
      row(present);
      for (const std::uint64_t word : group) {
        if (word != 0) row(word);
      }
    }
  }

  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  void put(const void* data, std::size_t size) {
    const auto* const from = static_cast<const std::byte*>(data);
    bytes_.insert(bytes_.end(), from, from + size);
  }

  std::vector<std::byte> bytes_;
};

/// After the first thing that is not there, nothing is.
class SurveyReader {
 public:
  explicit SurveyReader(std::span<const std::byte> bytes) : rest_(bytes) {}

  template <PlainRow T>
  T row() {
    T value{};
    get(&value, sizeof value);
    return value;
  }

  template <PlainRow T>
  std::vector<T> column() {
    const auto size = row<std::uint64_t>();
    if (size > rest_.size() / sizeof(T)) return fail(), std::vector<T>();
    std::vector<T> values(size);
    get(values.data(), size * sizeof(T));
    return values;
  }

  template <PlainRow T>
  std::vector<T> sparse_column() {
    const auto size = row<std::uint64_t>();
    // A group of words takes at least one.
    if (size > rest_.size() / 8 * kWordsOfGroup / (sizeof(T) / 8)) {
      return fail(), std::vector<T>();
    }
    std::vector<std::uint64_t> words(size * sizeof(T) / 8);
    for (std::size_t begin = 0; begin < words.size() && !failed_; begin += kWordsOfGroup) {
      const std::size_t in_group = std::min(kWordsOfGroup, words.size() - begin);
      const auto present = row<std::uint64_t>();
      if (in_group < kWordsOfGroup && present >> in_group != 0) fail();
      for (std::uint64_t bits = present; bits != 0 && !failed_; bits &= bits - 1) {
        words[begin + static_cast<std::size_t>(std::countr_zero(bits))] = row<std::uint64_t>();
      }
    }
    std::vector<T> values(failed_ ? 0 : size);
    const std::span to = std::as_writable_bytes(std::span(values));
    if (!to.empty()) std::memcpy(to.data(), words.data(), to.size());
    return values;
  }

  bool read_all() const { return !failed_ && rest_.empty(); }
  bool failed() const { return failed_; }

 private:
  void fail() { failed_ = true; }

  void get(void* data, std::size_t size) {
    if (failed_ || size > rest_.size()) return fail();
    if (size > 0) std::memcpy(data, rest_.data(), size);
    rest_ = rest_.subspan(size);
  }

  std::span<const std::byte> rest_;
  bool failed_ = false;
};

struct LinkRow {
  std::int32_t x, y, z;
  std::uint16_t element, part;
};

void write_parts(const PartsOfBrick& brick, SurveyWriter& out) {
  const SurfaceParts& parts = *brick.parts;
  std::vector<LinkRow> links;
  for (const SurfaceLink& link : parts.links) {
    links.push_back(
        {link.to_brick[0], link.to_brick[1], link.to_brick[2], link.element, link.part});
  }
  out.row(brick.brick);
  out.row(parts.count);
  out.column(links);
  out.column(parts.part_of);
  out.column(parts.beside);
}

constexpr int kBricksAround = 27, kLaterBricks = 13;

bool is_beside(std::int32_t step) { return step >= -1 && step <= 1; }

/// Returns nothing where a part or a brick is named that there is not.
std::optional<PartsOfBrick> read_parts(SurveyReader& in, std::size_t bricks) {
  const auto brick = in.row<std::uint32_t>();
  SurfaceParts parts;
  parts.count = in.row<std::uint16_t>();
  bool sound = brick < bricks;
  for (const LinkRow& link : in.column<LinkRow>()) {
    sound = sound && is_beside(link.x) && is_beside(link.y) && is_beside(link.z) &&
            link.part < parts.count;
    parts.links.push_back({{static_cast<std::int8_t>(link.x), static_cast<std::int8_t>(link.y),
                            static_cast<std::int8_t>(link.z)},
                           link.element,
                           link.part});
  }
  parts.part_of = in.column<std::array<std::uint16_t, 2>>();
  parts.beside = in.column<BricksAround>();
  for (const auto& [element, part] : parts.part_of) sound = sound && part < parts.count;
  sound = sound && parts.beside.size() == parts.count;
  for (const BricksAround beside : parts.beside) sound = sound && beside >> kBricksAround == 0;
  if (!sound || in.failed()) return std::nullopt;
  return PartsOfBrick{brick, std::make_shared<const SurfaceParts>(std::move(parts))};
}

std::vector<std::uint32_t> pack(const std::vector<SurfaceSheet>& sheets) {
  std::vector<std::uint32_t> packed;
  packed.reserve(sheets.size());
  for (const SurfaceSheet& sheet : sheets) {
    packed.push_back(std::uint32_t{sheet.any} | std::uint32_t{sheet.one} << 1 |
                     std::uint32_t{sheet.later} << 16);
  }
  return packed;
}

std::vector<SurfaceSheet> unpack(const std::vector<std::uint32_t>& packed) {
  std::vector<SurfaceSheet> sheets;
  sheets.reserve(packed.size());
  for (const std::uint32_t sheet : packed) {
    sheets.push_back(
        {(sheet & 1) != 0, (sheet & 2) != 0, static_cast<std::uint16_t>(sheet >> 16)});
  }
  return sheets;
}

/// What of the candidates is written: a survey may have found nothing at all.
struct CandidateRange {
  std::uint64_t count = 0;
  BrickCoord first, last;
  friend bool operator==(const CandidateRange&, const CandidateRange&) = default;
};

CandidateRange range_of(const std::vector<BrickCoord>& candidates) {
  if (candidates.empty()) return {};
  return {candidates.size(), candidates.front(), candidates.back()};
}

/// Whether the columns fit each other, and the bricks are among those that were looked at.
bool is_of(const Survey& survey, const std::vector<BrickCoord>& candidates, bool both_sides) {
  const std::size_t bricks = survey.bricks.size();
  return survey.stuffed.size() == bricks && survey.finest.size() == bricks &&
         survey.counts.size() == bricks && survey.sheets.size() == bricks &&
         survey.fans.size() == (both_sides ? bricks : 0) &&
         std::ranges::all_of(
             survey.sheets,
             [](const SurfaceSheet& sheet) { return sheet.later >> kLaterBricks == 0; }) &&
         std::ranges::is_sorted(survey.bricks) &&
         std::ranges::includes(candidates, survey.bricks);
}

}  // namespace

std::vector<std::byte> write_survey(const Survey& survey,
                                    const std::vector<BrickCoord>& candidates) {
  TET_CHECK(survey.restored == nullptr && survey.has_topology);
  SurveyWriter out;
  out.row(range_of(candidates));
  out.column(survey.bricks);
  out.sparse_column(survey.stuffed);
  out.sparse_column(survey.finest);
  out.sparse_column(survey.fans);
  out.sparse_column(survey.counts);
  out.column(pack(survey.sheets));
  out.column(survey.thin);
  out.row(std::uint64_t{survey.box_cuts_surface});
  out.row(std::uint64_t{survey.parts.size()});
  for (const PartsOfBrick& parts : survey.parts) write_parts(parts, out);
  return out.take();
}

std::optional<Survey> read_survey(std::span<const std::byte> bytes,
                                  const std::vector<BrickCoord>& candidates,
                                  bool both_sides) {
  SurveyReader in(bytes);
  if (in.row<CandidateRange>() != range_of(candidates)) return std::nullopt;
  Survey survey;
  survey.has_topology = true;
  survey.bricks = in.column<BrickCoord>();
  survey.stuffed = in.sparse_column<StuffedBrick>();
  survey.finest = in.sparse_column<BrickMask>();
  survey.fans = in.sparse_column<FanMasks>();
  survey.counts = in.sparse_column<SurfaceCounts>();
  survey.sheets = unpack(in.column<std::uint32_t>());
  survey.thin = in.column<ThinBrick>();
  survey.box_cuts_surface = in.row<std::uint64_t>() != 0;
  const auto parts = in.row<std::uint64_t>();
  for (std::uint64_t i = 0; i < parts; ++i) {
    auto of_brick = read_parts(in, survey.bricks.size());
    if (!of_brick) return std::nullopt;
    survey.parts.push_back(*std::move(of_brick));
  }
  if (!in.read_all() || !is_of(survey, candidates, both_sides)) return std::nullopt;
  survey.geometry.of_brick.resize(survey.bricks.size());
  return survey;
}

}  // namespace tet
