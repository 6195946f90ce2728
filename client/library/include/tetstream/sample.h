// phi, its slope and values of fields at points, without a mesh.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tetstream/export.h"
#include "tetstream/mesh.h"
#include "tetstream/request.h"
#include "tetstream/scene.h"
#include "tetstream/status.h"
#include "tetstream/volume.h"

namespace tetstream {

/// What is said of some points, in their order.
struct PointSamples {
  std::vector<double> phi;     ///< one a point, negative inside
  std::vector<double> slopes;  ///< three a point: how fast phi grows along x, y and z
  std::vector<float> fields;   ///< `field_values` a point, one array after the other
  std::vector<FieldArray> arrays;
  std::uint32_t field_values = 0;
  /// For people: which side of a grid's surface was taken for the inside, and why, where
  /// neither its class nor the request says it.
  std::string inside_guess;
};

/// Samples what a mesh of the request would be made from, at x, y and z of each point (world
/// units): docs/transfer.md. What is said of a point depends on the volume, the request and the
/// point alone, and is the same, byte for byte, here and on a server: see Client::sample.
/// Errors: those of mesh, kInvalidArgument (a point that is not finite, or no three numbers;
/// labels).
TETSTREAM_API Result<PointSamples> sample(const Volume& volume,
                                          std::span<const double> points,
                                          const Request& request = {},
                                          const WorkOptions& options = {});
TETSTREAM_API Result<PointSamples> sample(const Scene& scene,
                                          std::span<const double> points,
                                          const Request& request = {},
                                          const WorkOptions& options = {});

}  // namespace tetstream
