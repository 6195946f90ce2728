#include "core/plan/labelled/label_sizes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/base/parallel.h"
#include "core/octree/sizing.h"
#include "core/plan/budget.h"

namespace tet {
namespace {

constexpr double kTetsOfLeaf = 12;

/// The level of the largest leaves of each label, and of what is left out.
class LabelLevels {
 public:
  LabelLevels(std::span<const double> largest_leaf, double spacing, int levels) {
    for (const double size : largest_leaf) {
      of_label_.push_back(std::isinf(size) ? levels : level_of_size(size, spacing, levels));
    }
    free_ = levels;
  }

  int of(Label label) const noexcept {
    return label < of_label_.size() ? of_label_[label] : free_;
  }
  /// Whether any label's leaves are at most of this level, and may not be of the next.
  bool any_end_at(int level) const noexcept {
    return level < free_ && std::ranges::find(of_label_, level) != of_label_.end();
  }

 private:
  std::vector<int> of_label_;
  int free_ = 0;
};

/// Labels of a finest brick's cells: those of their lowest corners, since cells that have more
/// are finest whatever is asked. Where one label fills a brick, it has `every_cell`.
template <class Visit>
void for_each_label(const LabelSurvey& survey,
                    const BrickCoord& brick,
                    const BrickMask& every_cell,
                    const Visit& visit) {
  const BrickState state = survey.state.of(brick);
  if (state.one()) return visit(state.label(), every_cell);
  const auto& label = survey.brick[state.place()]->label[kCorner];
  BrickMask rest = BrickMask::all();
  while (rest.any()) {
    Label next = kJoker;
    BrickMask cells;
    for_each_bit(rest, [&](int x, int y, int z) {
      const Label here = label[static_cast<std::size_t>((x * 8 + y) * 8 + z)];
      if (!cells.any()) next = here;
      if (here == next) cells.set(x, y, z);
    });
    visit(next, cells);
    rest &= ~cells;
  }
}

/// A brick's cells, one in each cell of `level`.
BrickMask one_of_each(int level) {
  const int step = 1 << std::min(level, kBrickShift);
  BrickMask cells;
  for (int x = 0; x < kBrickEdge; x += step) {
    for (int y = 0; y < kBrickEdge; y += step) {
      for (int z = 0; z < kBrickEdge; z += step) cells.set(x, y, z);
    }
  }
  return cells;
}

/// Cells of a brick of `level` that hold any of the labels whose leaves end at the level below.
BrickMask refined_in(const LabelSurvey& survey,
                     const LabelLevels& levels,
                     const BrickCoord& coarse,
                     int level) {
  BrickMask refined;
  const BrickMask each = one_of_each(level);
  const BrickBox& domain = survey.rules.domain;
  const auto first = [&](std::int32_t at, std::int32_t min) {
    return std::max(at << level, min);
  };
  const auto last = [&](std::int32_t at, std::int32_t max) {
    return std::min(((at + 1) << level) - 1, max);
  };
  const BrickBox box{{first(coarse.x, domain.min.x), first(coarse.y, domain.min.y),
                      first(coarse.z, domain.min.z)},
                     {last(coarse.x, domain.max.x), last(coarse.y, domain.max.y),
                      last(coarse.z, domain.max.z)}};
  for_each_brick(box, [&](const BrickCoord& brick) {
    const auto cell = [&](std::int32_t at, int i) { return ((8 * at + i) >> level) & 7; };
    for_each_label(survey, brick, each, [&](Label label, const BrickMask& cells) {
      if (levels.of(label) != level - 1) return;
      for_each_bit(cells, [&](int x, int y, int z) {
        refined.set(cell(brick.x, x), cell(brick.y, y), cell(brick.z, z));
      });
    });
  });
  return refined;
}

CellSet refined_at(const LabelSurvey& survey,
                   const LabelLevels& levels,
                   int level,
                   const Cancellation& cancellation) {
  const BrickBox& domain = survey.rules.domain;
  const BrickBox coarse{{domain.min.x >> level, domain.min.y >> level, domain.min.z >> level},
                        {domain.max.x >> level, domain.max.y >> level, domain.max.z >> level}};
  CellSet cells;
  for_each_brick(coarse, [&](const BrickCoord& brick) { cells.bricks.push_back(brick); });
  cells.cells.resize(cells.bricks.size());
  for_each_index(cells.bricks.size(), [&](std::size_t i) {
    if (cancellation.requested()) return;
    cells.cells[i] = refined_in(survey, levels, cells.bricks[i], level);
  });
  drop_empty(cells);
  return cells;
}

/// Leaves as large as each label allows would have more tets than there may be.
absl::Status check_leaves(const LabelSurvey& survey,
                          const LabelLevels& levels,
                          const MeshLimits& limits) {
  double leaves = 0;
  for_each_brick(survey.rules.domain, [&](const BrickCoord& brick) {
    const BrickState state = survey.state.of(brick);
    if (!state.one() || !survey.rules.kept.holds(state.label())) return;
    leaves += kBrickCells / std::pow(8.0, levels.of(state.label()));
  });
  const double tets = leaves * kTetsOfLeaf;
  if (tets <= kTetSlack * static_cast<double>(limits.max_tets)) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrFormat(
      "the sizes of labels ask for about %.3g tets; the limit is %d. Use larger sizes, a "
      "larger spacing or a smaller box",
      tets, limits.max_tets));
}

}  // namespace

absl::StatusOr<std::vector<CellSet>> cells_above_sizes(const LabelSurvey& survey,
                                                       std::span<const double> largest_leaf,
                                                       double spacing,
                                                       const MeshRequest& request,
                                                       const MeshLimits& limits,
                                                       const Cancellation& cancellation) {
  const LabelLevels levels(largest_leaf, spacing, request.levels);
  std::vector<CellSet> refined;
  for (int level = 1; level <= request.levels; ++level) {
    if (!levels.any_end_at(level - 1)) continue;
    if (refined.empty()) {
      if (auto s = check_leaves(survey, levels, limits); !s.ok()) return s;
    }
    refined.resize(static_cast<std::size_t>(level) + 1);
    refined.back() = refined_at(survey, levels, level, cancellation);
  }
  return refined;
}

}  // namespace tet
