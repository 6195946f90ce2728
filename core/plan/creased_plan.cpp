#include "core/plan/creased_plan.h"

#include <algorithm>
#include <utility>

namespace tet {
namespace {

MeshFacts facts_with_labels(const MeshPlan& plan, std::vector<FaceLabel> labels) {
  MeshFacts facts{.shape = plan.shape(),
                  .header = plan.header(),
                  .thin_walls = plan.thin_walls(),
                  .statistics = plan.statistics(),
                  .boundary = plan.boundary(),
                  .improvement = plan.improvement(),
                  .surface_bricks = plan.surface_bricks()};
  facts.header.face_labels = std::move(labels);
  return facts;
}

}  // namespace

CreasedPlan::CreasedPlan(std::shared_ptr<const MeshPlan> undivided,
                         std::vector<FaceLabel> labels,
                         ByteBuffer face_labels)
    : MeshPlan(facts_with_labels(*undivided, std::move(labels))),
      undivided_(std::move(undivided)),
      face_labels_(std::move(face_labels)) {}

ChunkExtent CreasedPlan::chunk(std::uint64_t index) const noexcept {
  return undivided_->chunk(index);
}

QualityStats CreasedPlan::fill_chunk(std::uint64_t index,
                                     MeshWorkspace& workspace,
                                     ChunkColumns columns) const noexcept {
  const QualityStats stats = undivided_->fill_chunk(index, workspace, columns);
  const std::size_t first = ChunkSizes::before(header(), chunk(index)).face_labels;
  std::ranges::copy(face_labels_.bytes().subspan(first, columns.face_labels.size()),
                    columns.face_labels.begin());
  return stats;
}

std::uint64_t CreasedPlan::bytes() const noexcept {
  return undivided_->bytes() + face_labels_.size();
}

}  // namespace tet
