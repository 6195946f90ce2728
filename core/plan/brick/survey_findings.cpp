#include "core/plan/brick/survey_findings.h"

#include <algorithm>

#include "core/stuffing/brick_geometry.h"

namespace tet {
namespace {

/// Makes room for `more` bricks; where it has to, for as large a share of those to come, so
/// that columns rarely move.
void make_room(Survey& survey, std::size_t more, std::size_t of, const StillToCome& coming) {
  const std::size_t wanted = survey.bricks.size() + more;
  if (wanted <= survey.bricks.capacity()) return;
  const std::size_t rest = more * coming.candidates / std::max<std::size_t>(of, 1);
  // The surface is nowhere quite as here.
  const std::size_t room =
      std::max(wanted, std::min(wanted + rest + rest / 8, coming.most_bricks));
  survey.bricks.reserve(room);
  survey.stuffed.reserve(room);
  survey.finest.reserve(room);
  survey.geometry.of_brick.reserve(room);
  survey.counts.reserve(room);
  survey.sheets.reserve(room);
}

/// Appends bricks `[begin, end)` as they were found then, but for their geometry.
void add_known(const Survey& earlier, std::uint32_t begin, std::uint32_t end, Survey& survey) {
  const auto first = static_cast<std::uint32_t>(survey.sheets.size());
  auto parts = std::ranges::lower_bound(earlier.parts, begin, {}, &PartsOfBrick::brick);
  for (; parts != earlier.parts.end() && parts->brick < end; ++parts) {
    survey.parts.push_back({first + parts->brick - begin, parts->parts});
  }
  const auto append = [&](const auto& from, auto& to) {
    to.insert(to.end(), from.begin() + begin, from.begin() + end);
  };
  append(earlier.bricks, survey.bricks);
  append(earlier.stuffed, survey.stuffed);
  append(earlier.finest, survey.finest);
  append(earlier.counts, survey.counts);
  append(earlier.sheets, survey.sheets);
}

void add_surveyed(SurveyedBrick& found, bool both_sides, Survey& survey) {
  survey.stuffed.push_back(found.stuffed);
  survey.finest.push_back(found.finest);
  if (both_sides) survey.fans.push_back(found.fans ? *found.fans : FanMasks{});
  survey.counts.push_back(found.surface.counts);
  if (found.parts) {
    survey.parts.push_back(
        {static_cast<std::uint32_t>(survey.sheets.size()), std::move(found.parts)});
  }
  survey.sheets.push_back(found.surface.sheet);
  survey.box_cuts_surface = survey.box_cuts_surface || found.at_domain_face;
}

}  // namespace

Findings::Findings(std::size_t candidates)
    : surveyed(candidates),
      known(candidates, kNotKnown),
      geometry(candidates),
      thin(candidates) {}

std::size_t Findings::count() const noexcept {
  std::size_t bricks = 0;
  for (std::size_t i = 0; i < known.size(); ++i) {
    bricks += surveyed[i] != nullptr || known[i] != kNotKnown;
  }
  return bricks;
}

void add_findings(std::span<const BrickCoord> candidates,
                  Findings findings,
                  const EarlierSurvey* earlier,
                  bool both_sides,
                  const StillToCome& rest,
                  Survey& survey) {
  make_room(survey, findings.count(), candidates.size(), rest);
  if (earlier != nullptr) survey.known.reserve(survey.bricks.capacity());
  // Known bricks that follow each other in the earlier survey, too, and are yet to be added.
  std::uint32_t begin = 0, end = 0;
  const auto add_run = [&] {
    if (begin != end) add_known(earlier->survey, begin, end, survey);
    begin = end = 0;
  };
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (findings.thin[i]) survey.thin.push_back({candidates[i], *findings.thin[i]});
    const std::uint32_t known = findings.known[i];
    if (known == kNotKnown && findings.surveyed[i] == nullptr) continue;
    survey.geometry.of_brick.push_back(findings.geometry[i]);
    if (earlier != nullptr) survey.known.push_back(known);
    if (known != kNotKnown) {
      if (known != end) add_run();
      if (begin == end) begin = known;
      end = known + 1;
      continue;
    }
    add_run();
    survey.bricks.push_back(candidates[i]);
    add_surveyed(*findings.surveyed[i], both_sides, survey);
    findings.surveyed[i] = nullptr;
  }
  add_run();
}

RareBytes RareFindings::bytes_of(const Survey& survey) noexcept {
  for (; counted_ < survey.parts.size(); ++counted_) {
    parts_bytes_ += survey.parts[counted_].parts->bytes();
  }
  return {parts_bytes_, survey.thin.size() * sizeof(ThinBrick)};
}

std::uint64_t count_kept(const KeptGeometry& geometry) noexcept {
  return static_cast<std::uint64_t>(std::ranges::count_if(
      geometry.of_brick, [](const std::byte* packed) { return packed != nullptr; }));
}

bool can_share(const KeptGeometry& earlier, std::uint64_t room) noexcept {
  return earlier.gone <= count_kept(earlier) / 2 && earlier.block_bytes <= room / 2;
}

void GeometryKeeper::keep(std::size_t brick,
                          const StuffedBrick& stuffed,
                          const StuffedLattice& lattice) {
  if (std::byte* const to = make_room(brick, stuffed)) pack_geometry(lattice, stuffed, to);
}

void GeometryKeeper::keep_again(std::size_t brick,
                                const StuffedBrick& stuffed,
                                const std::byte* packed) {
  if (packed == nullptr) return;
  if (std::byte* const to = make_room(brick, stuffed)) {
    std::copy_n(packed, GeometrySizes(stuffed).bytes(), to);
  }
}

std::shared_ptr<const std::byte[]> GeometryKeeper::take() {
  if (packed_.empty()) return nullptr;
  std::shared_ptr<std::byte[]> block =
      std::make_unique_for_overwrite<std::byte[]>(packed_.size());
  std::copy(packed_.begin(), packed_.end(), block.get());
  for (const auto& [brick, begin] : begins_) kept_[brick] = block.get() + begin;
  return block;
}

std::byte* GeometryKeeper::make_room(std::size_t brick, const StuffedBrick& stuffed) {
  const std::size_t size = GeometrySizes(stuffed).bytes();
  if (room_.fetch_sub(static_cast<std::int64_t>(size)) < static_cast<std::int64_t>(size)) {
    return nullptr;
  }
  const std::size_t begin = packed_.size();
  packed_.resize(begin + size);
  begins_.emplace_back(brick, begin);
  return packed_.data() + begin;
}

}  // namespace tet
