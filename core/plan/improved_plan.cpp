#include "core/plan/improved_plan.h"

#include <algorithm>
#include <span>
#include <utility>

#include "core/mesh/quality.h"
#include "core/plan/fill_watch.h"

namespace tet {
namespace {

MeshFacts facts_of_improved(const MeshPlan& plan,
                            const Improvement& improvement,
                            Statistics statistics) {
  return {.shape = plan.shape(),
          .header = plan.header(),
          .thin_walls = plan.thin_walls(),
          .statistics = statistics,
          .boundary = plan.boundary(),
          .improvement = improvement,
          .surface_bricks = plan.surface_bricks()};
}

}  // namespace

ImprovedPlan::ImprovedPlan(std::shared_ptr<const MovablePlan> unimproved,
                           ByteBuffer positions,
                           const Improvement& improvement,
                           Statistics statistics)
    : MeshPlan(facts_of_improved(*unimproved, improvement, statistics)),
      unimproved_(std::move(unimproved)),
      positions_(std::move(positions)) {}

ChunkExtent ImprovedPlan::chunk(std::uint64_t index) const noexcept {
  return unimproved_->chunk(index);
}

QualityStats ImprovedPlan::fill_chunk(std::uint64_t index,
                                      MeshWorkspace& workspace,
                                      ChunkColumns columns) const noexcept {
  ChunkColumns without_fields = columns;
  without_fields.fields = {};
  unimproved_->fill_chunk(index, workspace, without_fields);
  if (workspace.get<FillWatch>().stops()) return {};  // tets that nobody wrote are no tets
  const ChunkExtent extent = chunk(index);
  const std::size_t first = ChunkSizes(header(), extent.first_vertex, 0).positions;
  std::ranges::copy(positions_.bytes().subspan(first, columns.positions.size()),
                    columns.positions.begin());
  if (!columns.fields.empty()) unimproved_->fill_fields(extent, columns);
  if (statistics() == Statistics::kSkipped) return {};
  return measure_tets(
      {header().coordinate_type, header().index_type, positions_.bytes(), columns.tets},
      header().spacing);
}

std::uint64_t ImprovedPlan::bytes() const noexcept {
  return unimproved_->bytes() + positions_.size();
}

}  // namespace tet
