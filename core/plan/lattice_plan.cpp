#include "core/plan/lattice_plan.h"

#include <utility>

#include "core/plan/sample_fields.h"

namespace tet {

LatticePlan::LatticePlan(MeshFacts facts, MeshSource source)
    : MovablePlan(std::move(facts)), source_(std::move(source)) {}

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

}  // namespace tet
