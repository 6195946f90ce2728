// A plan of one shape's mesh, which lies on one lattice: it can be improved, and its vertices
// have values of fields.
#pragma once

#include <memory>
#include <vector>

#include "core/field/phi_field.h"
#include "core/mesh/improve/improve.h"
#include "core/mesh/lattice_to_world.h"
#include "core/plan/mesh_request.h"
#include "core/plan/movable_plan.h"

namespace tet {

/// What a mesh on one lattice was made from, and where the lattice lies.
struct MeshSource {
  PhiField field;  ///< refers to the plan's shape, or to `stand_in`
  LatticeToWorld to_world;
  std::vector<VertexField> fields = {};
  std::shared_ptr<const Scene> stand_in = nullptr;  ///< kept for the field: PreparedMesh
};

class LatticePlan : public MovablePlan {
 public:
  const PhiField& field() const noexcept { return source_.field; }
  const LatticeToWorld& to_world() const noexcept { return source_.to_world; }

  Improvement improve(TetMesh& mesh, const Cancellation& cancellation) const final;
  void fill_fields(const ChunkExtent& extent, const ChunkColumns& columns) const noexcept final;

 protected:
  LatticePlan(MeshFacts facts, MeshSource source);

 private:
  /// A kind of mesh that knows more of its vertices than their positions says so here.
  virtual KnownOfVertices known_of_vertices() const noexcept { return {}; }

  const MeshSource source_;
};

}  // namespace tet
