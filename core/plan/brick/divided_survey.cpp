#include "core/plan/brick/divided_survey.h"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <optional>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/plan/brick/survey_bytes.h"
#include "core/plan/brick/survey_findings.h"
#include "core/plan/budget.h"

namespace tet {
namespace {

std::size_t blocks_of(std::size_t bricks, std::size_t block_bricks) {
  return (bricks + block_bricks - 1) / block_bricks;
}

std::vector<BrickCoord> bricks_of_block(const std::vector<BrickCoord>& bricks,
                                        std::size_t block_bricks,
                                        std::size_t block) {
  const std::size_t begin = block * block_bricks;
  const std::size_t end = std::min(begin + block_bricks, bricks.size());
  return {bricks.begin() + static_cast<std::ptrdiff_t>(begin),
          bricks.begin() + static_cast<std::ptrdiff_t>(end)};
}

template <class T>
void append(std::vector<T>& all, std::vector<T>& more) {
  all.insert(all.end(), std::make_move_iterator(more.begin()),
             std::make_move_iterator(more.end()));
}

/// Adds what was surveyed of the bricks that come next.
void append(Survey& survey, Survey& block) {
  for (PartsOfBrick& parts : block.parts) {
    parts.brick += static_cast<std::uint32_t>(survey.bricks.size());
  }
  append(survey.bricks, block.bricks);
  append(survey.stuffed, block.stuffed);
  append(survey.finest, block.finest);
  append(survey.fans, block.fans);
  append(survey.geometry.of_brick, block.geometry.of_brick);
  append(survey.geometry.blocks, block.geometry.blocks);
  survey.geometry.block_bytes += block.geometry.block_bytes;
  append(survey.thin, block.thin);
  append(survey.counts, block.counts);
  append(survey.sheets, block.sheets);
  append(survey.parts, block.parts);
  survey.box_cuts_surface = survey.box_cuts_surface || block.box_cuts_surface;
}

/// What another host found; nothing where it is not there, or not what it should be.
std::optional<Survey> find_block(const PreparedMesh& prepared,
                                 const SurveyedBlocks& surveyed,
                                 std::size_t block,
                                 const std::vector<BrickCoord>& bricks) {
  const auto bytes = surveyed.find(block);
  if (!bytes) return std::nullopt;
  auto survey = read_survey(*bytes, bricks, prepared.space.rules.both_sides);
  if (survey && prepared.space.skip_topology) {
    // A row for each brick, as where the block is surveyed here: later rows keep their places.
    survey->counts.assign(survey->bricks.size(), {});
    survey->sheets.assign(survey->bricks.size(), {});
    survey->parts.clear();
  }
  return survey;
}

}  // namespace

absl::StatusOr<std::size_t> count_survey_blocks(const Shape& shape,
                                                const MeshRequest& request,
                                                const MeshLimits& limits,
                                                std::size_t block_bricks,
                                                const Cancellation& cancellation) {
  if (grids_of(shape) != nullptr || request.labels) return 1;
  const auto prepared = prepare_mesh(shape, request, limits, cancellation);
  if (!prepared.ok()) return prepared.status();
  if (request.manifold || is_made_whole(request)) return 1;
  return std::max<std::size_t>(blocks_of(prepared->bricks.near_surface.size(), block_bricks),
                               1);
}

absl::StatusOr<std::vector<std::byte>> survey_block(const Shape& shape,
                                                    const MeshRequest& request,
                                                    const MeshLimits& limits,
                                                    std::size_t block_bricks,
                                                    std::size_t block,
                                                    const Cancellation& cancellation) {
  auto prepared = prepare_mesh(shape, request, limits, cancellation);
  if (!prepared.ok()) return prepared.status();
  const std::vector<BrickCoord>& bricks = prepared->bricks.near_surface;
  const std::size_t blocks = blocks_of(bricks.size(), block_bricks);
  if (block >= blocks || request.manifold || is_made_whole(request)) {
    return absl::InvalidArgumentError(
        absl::StrFormat("block %d of a survey of %d blocks", block, blocks));
  }
  prepared->space.kept_geometry_bytes = 0;  // it would be most of the bytes
  prepared->space.skip_topology = false;    // whoever puts the blocks together may want it
  const auto in_block = bricks_of_block(bricks, block_bricks, block);
  const absl::StatusOr<Survey> survey =
      survey_bricks(prepared->field, in_block, prepared->space, cancellation, nullptr);
  if (!survey.ok()) return survey.status();
  return write_survey(*survey, in_block);
}

absl::StatusOr<Survey> join_survey(const PreparedMesh& prepared,
                                   const SurveyedBlocks& surveyed,
                                   const Cancellation& cancellation,
                                   MeshProgress* progress) {
  const std::vector<BrickCoord>& bricks = prepared.bricks.near_surface;
  if (surveyed.find == nullptr || prepared.space.manifold) {
    return survey_bricks(prepared.field, bricks, prepared.space, cancellation, progress);
  }
  MeshedSpace space = prepared.space;
  Survey survey;
  survey.has_topology = !space.skip_topology;
  RareFindings rare;
  const std::size_t blocks = blocks_of(bricks.size(), surveyed.block_bricks);
  for (std::size_t block = 0; block < blocks; ++block) {
    if (auto status = check_cancelled(cancellation); !status.ok()) return status;
    const auto in_block = bricks_of_block(bricks, surveyed.block_bricks, block);
    if (auto found = find_block(prepared, surveyed, block, in_block)) {
      append(survey, *found);
    } else {
      auto here = survey_bricks(prepared.field, in_block, space, cancellation, nullptr);
      if (!here.ok()) return here;
      space.kept_geometry_bytes -= here->geometry.block_bytes;
      append(survey, *here);
    }
    if (auto status = check_survey_budget(survey.bricks.size(), rare.bytes_of(survey), space);
        !status.ok()) {
      return status;
    }
    if (progress == nullptr) continue;
    if (block == 0) progress->expect(bricks.size());
    progress->done += in_block.size();
  }
  return survey;
}

}  // namespace tet
