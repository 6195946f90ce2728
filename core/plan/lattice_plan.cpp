#include "core/plan/lattice_plan.h"

#include <cstddef>
#include <utility>

#include "core/base/parallel.h"
#include "core/plan/sample_fields.h"

namespace tet {

Statistics statistics_on_lattice(const MeshRequest& request) {
  return request.improve ? Statistics::kSkipped : statistics_of(request);
}

LatticePlan::LatticePlan(MeshFacts facts, MeshSource source)
    : MeshPlan(std::move(facts)), source_(std::move(source)) {}

Improvement LatticePlan::improve(TetMesh& mesh, const Cancellation& cancellation) const {
  return improve_mesh(mesh, field(), to_world(), known_of_vertices(), cancellation);
}

void LatticePlan::fill_fields(const ChunkExtent& extent,
                              const ChunkColumns& columns) const noexcept {
  if (!source_.fields.empty()) {
    sample_fields(source_.fields, header(), columns.positions, columns.fields);
  }
  const KnownOfVertices known = known_of_vertices();
  if (known.stay.empty()) return;
  write_cut_faces(known.stay.subspan(extent.first_vertex, extent.vertex_count), header(),
                  columns.fields);
}

void LatticePlan::add_fields(TetMesh& mesh) const {
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
