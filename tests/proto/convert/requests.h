// Requests that tests begin with.
#pragma once

#include "tetstream/v1/meshes.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

/// A request for the mesh of a grid, and nothing besides.
v1::MeshRequest valid_request();
/// A valid request for both sides within the unit cube.
v1::MeshRequest boxed_request();
/// A valid request with a region of every kind of place.
v1::MeshRequest request_with_regions();
/// A valid request for the mesh of a ball of radius 2.
v1::MeshRequest scene_request();
/// That ball, with leaves of one half around its centre.
v1::MeshRequest sized_request();

}  // namespace tet
