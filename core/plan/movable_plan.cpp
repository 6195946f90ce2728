#include "core/plan/movable_plan.h"

#include <cstddef>

#include "core/base/parallel.h"

namespace tet {

Statistics statistics_before_moves(const MeshRequest& request) {
  return request.improve ? Statistics::kSkipped : statistics_of(request);
}

void MovablePlan::add_fields(TetMesh& mesh) const {
  mesh.header.fields = header().fields;
  if (mesh.header.fields.empty()) return;
  constexpr std::size_t kVerticesPerRange = 4096;
  const std::uint64_t vertices = mesh.header.vertex_count;
  mesh.fields = ByteBuffer(ChunkSizes(mesh.header, vertices, 0).fields);
  for_each_range(vertices, kVerticesPerRange, [&](std::size_t begin, std::size_t end) {
    const ChunkExtent extent{begin, end - begin, 0, 0};
    fill_fields(extent, mesh.columns_of(extent));
  });
}

}  // namespace tet
