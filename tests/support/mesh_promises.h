// Everything that a mesh promises, checked on one random field after another.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/parallel.h"
#include "core/plan/mesh_request.h"

namespace tet::test {

/// One random field and how to mesh it: uniform, and graded.
struct FieldCase {
  std::string family;
  std::uint32_t seed = 1;
  int edge = 64;  ///< of the field, voxels
  Preset preset = Preset::kDefault;
  double spacing = 1;  ///< voxels
};

/// What `field_trial` has to be told to try a case again.
std::string arguments_of(const FieldCase& field_case);

struct Outcome {
  std::uint64_t tets = 0;  ///< of both meshes
  double min_dihedral_deg = 180, max_dihedral_deg = 0;
  std::string violation;  ///< the first broken promise in words; empty when all are kept
};

/// Meshes the field uniform and graded, and checks of each mesh that
///
/// - it conforms, and its tets are positive (tests/support/conformity.h);
/// - its dihedral angles keep the preset's bounds, and the reported angles and volume are those
///   it has;
/// - the boundary of the inside lies where the surface passes (the first guarantee): at zero
///   nodes, on lattice edges whose ends have strictly opposite signs, or, between two sides,
///   amid four such points; and on smooth fields where phi is near zero;
/// - everything is on its side (the second guarantee): no inside tet has an outside node, and
///   no outside tet an inside one, where nodes without a neighbour of the other sign cannot
///   have moved; without outside, every other vertex lies where the surface passes; all nodes
///   that are alike with their 14 neighbours are vertices of the uniform mesh; and both meshes
///   have the same volume and as many boundary triangles;
/// - on fields whose features are resolved, the boundary is a manifold of the field's own
///   topology (the third guarantee); where a manifold was asked for it is one on any field; and
///   it is the topology that was counted with the mesh.
///
/// Two seeds in three give the graded mesh a random sizing. Every third seed asks for a
/// manifold, every eighth for improved angles, which takes vertices off the lattice: what is
/// said of their places is then not checked. Every fourth seed's graded mesh is made anew with
/// other numbers of threads and another chunk size: the columns must be equal byte by byte. A
/// field of which nothing can be meshed passes. Source of the guarantees: Labelle & Shewchuk
/// 2007, section 4.2.
Outcome check_promises(const FieldCase& field_case, TaskPool& pool);

}  // namespace tet::test
