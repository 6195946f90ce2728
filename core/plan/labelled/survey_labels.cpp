#include "core/plan/labelled/survey_labels.h"

#include <atomic>
#include <cstddef>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/base/parallel.h"
#include "core/base/scratch_pool.h"

namespace tet {
namespace {

constexpr std::size_t kLookedAtPerRange = 8;

BrickBox with_upper_bricks(const BrickBox& domain) noexcept {
  const BrickCoord max = domain.max;
  return {domain.min, {max.x + 1, max.y + 1, max.z + 1}};
}

absl::Status too_large(std::uint64_t most) {
  return absl::ResourceExhaustedError(absl::StrFormat(
      "the bricks where labels meet take more than %d bytes while the mesh is counted. Use a "
      "larger spacing, a smaller box, or fewer labels",
      most));
}

}  // namespace

Label LabelSurvey::corner_label(std::int64_t x, std::int64_t y, std::int64_t z) const noexcept {
  const auto down = [](std::int64_t v) { return static_cast<std::int32_t>(v >> 3); };
  const BrickState found = state.of({down(x), down(y), down(z)});
  if (found.one()) return found.label();
  const auto corner = static_cast<std::size_t>((x & 7) * 64 + (y & 7) * 8 + (z & 7));
  return brick[found.place()]->label[kCorner][corner];
}

CellSet LabelSurvey::finest() const {
  CellSet cells{at, {}};
  cells.cells.reserve(brick.size());
  for (const auto& found : brick) cells.cells.push_back(found->finest);
  return cells;
}

absl::StatusOr<LabelSurvey> survey_labels(const LabelSource& source,
                                          const LabelRules& rules,
                                          std::uint64_t most_bytes,
                                          const Cancellation& cancellation,
                                          MeshProgress* progress) {
  LabelSurvey survey;
  survey.rules = rules;
  survey.state = LabelStates(with_upper_bricks(rules.domain));
  std::vector<std::unique_ptr<LabelledBrick>> found(survey.state.size());
  if (progress != nullptr) progress->expect(found.size());
  std::atomic<std::uint64_t> bytes{survey.state.bytes()};
  ScratchPool<LabelWorkspace> workspaces;
  for_each_range(found.size(), kLookedAtPerRange, [&](std::size_t begin, std::size_t end) {
    const std::unique_ptr<LabelSampler> sampler = source.sampler();
    sampler->stop_when(cancellation);
    ScratchPool<LabelWorkspace>::Turn workspace(workspaces);
    for (std::size_t i = begin; i < end && !cancellation.requested(); ++i) {
      if (bytes.load(std::memory_order_relaxed) > most_bytes) return;
      FoundLabels labels =
          survey_labelled_brick(*sampler, survey.state.brick(i), rules, *workspace);
      survey.state[i] = BrickState::of_label(labels.one);
      if (labels.brick != nullptr) bytes += labels.brick->bytes();
      found[i] = std::move(labels.brick);
      if (progress != nullptr) progress->done.fetch_add(1, std::memory_order_relaxed);
    }
  });
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  if (bytes > most_bytes) return too_large(most_bytes);
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i] == nullptr) continue;
    survey.state[i] = BrickState::at(static_cast<std::uint32_t>(survey.at.size()));
    survey.at.push_back(survey.state.brick(i));
    survey.brick.push_back(std::move(found[i]));
  }
  survey.bytes = bytes;
  return survey;
}

}  // namespace tet
