// The parts of a report on shapes of tets and on how true the surface is, as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/fidelity/fidelity.h"
#include "core/mesh/tet_shapes.h"
#include "core/second_order/middle_nodes.h"

namespace tet {

/// Keys: not_positive; scaled_jacobian, radius_ratio and edge_ratio (min, mean, max, histogram
/// of fiftieths); edge_lengths (min, max, bins_per_octave, first_bin_spacings, histogram); and
/// worst (tet, at, and the three ratios of each).
nlohmann::ordered_json shapes_json(const ShapeStats& shapes);

/// Keys: mesh_to_surface and surface_to_mesh (max, rms, max_spacings, rms_spacings, at,
/// samples), hausdorff, hausdorff_spacings, mesh_area, surface_area, mesh_volume, and where no
/// box cuts the surface enclosed_volume and volume_error, which is relative.
nlohmann::ordered_json fidelity_json(const Fidelity& fidelity);

/// Keys: nodes, curved, straightened, volume, least_jacobian_share. Measures the mesh.
nlohmann::ordered_json second_order_json(const TetMesh& mesh, const MiddleNodes& middles);

}  // namespace tet
