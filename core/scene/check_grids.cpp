#include "core/scene/check_grids.h"

#include <algorithm>
#include <cstddef>
#include <set>
#include <string>
#include <utility>
#include <variant>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_join.h>

#include "core/scene/check_nodes.h"
#include "core/scene/scene.h"
#include "core/volume/inside.h"

namespace tet::scene {
namespace {

struct Interval {
  double low = 0, high = 0;
};

/// Which values of an operator's parts matter to where its own lie in `asked`.
Interval asked_of_parts(const Instruction& op, const Interval& asked) {
  // Two parts blend while they are less than the smoothing apart, and the blend lies up to a
  // quarter of it beyond the nearer one.
  constexpr double kBlend = 1.25;
  const double size = op.size[0];
  switch (op.op) {
    case Op::kNegate:
      return {-asked.high, -asked.low};
    case Op::kOffset:
      return {asked.low + size, asked.high + size};
    case Op::kShell: {
      const double farthest = std::max(asked.high + size, 0.0);
      return {-farthest, farthest};
    }
    case Op::kMin:
      return {asked.low, asked.high + kBlend * size};
    case Op::kMax:
      return {asked.low - kBlend * size, asked.high};
    default:
      return asked;
  }
}

/// Where each instruction's own values matter, from the last one's zero down.
std::vector<Interval> asked_of(const std::vector<Instruction>& program) {
  std::vector<Interval> asked(program.size());
  for (std::size_t i = program.size(); i-- > 0;) {
    const Instruction& op = program[i];
    if (is_leaf(op.op)) continue;
    asked[i - 1] = asked_of_parts(op, asked[i]);
    if (is_binary(op.op)) asked[program[i - 1].first - 1] = asked[i - 1];
  }
  return asked;
}

/// Between which of its values a grid knows how far away its surface is: all that is on the
/// background's side of it counts as the background.
Interval known_to(const Instruction& leaf, const GridSource& grid) {
  const auto phi = [&](float value) {
    return leaf.size[1] * (static_cast<double>(value) - leaf.size[0]);
  };
  const auto [min, max] = grid.bounds.all();
  const double background = phi(grid.volume->background);
  const Interval all{std::min(phi(min), phi(max)), std::max(phi(min), phi(max))};
  return background < 0 ? Interval{background, all.high} : Interval{all.low, background};
}

double iso_of(const GridSolid& grid) {
  return grid.iso.value_or(default_iso(*grid.volume, grid.inside));
}

absl::Status check_leaf(const std::string& path,
                        const Instruction& leaf,
                        const Interval& asked,
                        const GridSource& grid) {
  const Interval known = known_to(leaf, grid);
  if (!(known.low < 0 && known.high > 0)) {
    const auto [min, max] = grid.bounds.all();
    return absl::InvalidArgumentError(
        absl::StrFormat("%s has no surface at iso %g: its values are from %g to %g", path,
                        leaf.size[0], min, max));
  }
  const double own = 1 / leaf.frame.scale;
  if (own * asked.low > known.low && own * asked.high < known.high) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrFormat(
      "%s knows distances from %g to %g, and offsets, shells or blends of it ask for %g to %g: "
      "take less, or a grid with a wider band",
      path, known.low, known.high, own * asked.low, own * asked.high));
}

}  // namespace

absl::Status check_grid_count(const Description& description) {
  std::set<std::pair<std::string, std::string>> grids;
  for (std::size_t i = 0; i < description.nodes.size(); ++i) {
    const auto* grid = std::get_if<GridSolid>(&description.nodes[i].kind);
    if (grid == nullptr) continue;
    grids.emplace(grid->file, grid->name);
    if (grids.size() <= Scene::kMaxGrids) continue;
    return absl::InvalidArgumentError(absl::StrCat(
        path_of(description, i), " is one grid too many; the limit is ", Scene::kMaxGrids));
  }
  return absl::OkStatus();
}

absl::Status check_insides(const Description& description) {
  for (std::size_t i = 0; i < description.nodes.size(); ++i) {
    const auto* grid = std::get_if<GridSolid>(&description.nodes[i].kind);
    if (grid == nullptr) continue;
    absl::Status status = check_side(*grid->volume, grid->inside);
    // Where no value lies on the other side there is no surface, which is told elsewhere.
    const ValueRange range = value_range(*grid->volume);
    const double iso = iso_of(*grid);
    if (status.ok() && range.min <= iso && iso <= range.max) {
      status = check_background(*grid->volume, grid->inside, iso);
    }
    if (status.ok()) continue;
    return absl::InvalidArgumentError(
        absl::StrCat(path_of(description, i), ".", status.message()));
  }
  return absl::OkStatus();
}

std::string guessed_insides(const Description& description) {
  std::set<std::string> guesses;  // once for all leaves of one grid
  for (const Node& node : description.nodes) {
    const auto* grid = std::get_if<GridSolid>(&node.kind);
    if (grid == nullptr) continue;
    std::string guess = describe_guess(*grid->volume, grid->inside, iso_of(*grid));
    if (!guess.empty()) guesses.insert(std::move(guess));
  }
  return absl::StrJoin(guesses, "\n");
}

absl::Status check_loaded(const Description& description) {
  for (std::size_t i = 0; i < description.nodes.size(); ++i) {
    const auto* grid = std::get_if<GridSolid>(&description.nodes[i].kind);
    if (grid == nullptr || grid->volume != nullptr) continue;
    return absl::InvalidArgumentError(absl::StrCat(path_of(description, i), " is not loaded"));
  }
  return absl::OkStatus();
}

absl::Status check_grid_levels(const Description& description,
                               const std::vector<Instruction>& program,
                               std::span<const GridSource> grids) {
  const std::vector<Interval> asked = asked_of(program);
  for (std::size_t i = 0; i < program.size(); ++i) {
    const Instruction& leaf = program[i];
    if (leaf.op != Op::kGrid) continue;
    const absl::Status status =
        check_leaf(path_of(description, leaf.node), leaf, asked[i], grids[leaf.grid]);
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace tet::scene
