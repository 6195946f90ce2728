// CGAL's Mesh_3, as its manual meshes a labelled image.
#pragma once

#include "bench/rivals/contender.h"
#include "bench/rivals/grains.h"

namespace tet::rivals {

/// How Mesh_3 is asked for a mesh.
struct Mesh3Request {
  double cell_size = 0;   ///< bound of a tet's circumradius, voxels
  bool optimized = true;  ///< by perturbation and exudation, as it is unless told otherwise
};

PlainMesh mesh_with_mesh3(const LabelCube& cube, const Mesh3Request& request);

}  // namespace tet::rivals
