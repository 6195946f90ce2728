// The zero surface of phi, found without any mesh: points on it, its area, and what it
// encloses.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/brick_box.h"
#include "core/base/cancel.h"
#include "core/base/types.h"
#include "core/field/phi_field.h"

namespace tet {

/// A point on the surface, and the area that it stands for.
struct SurfacePoint {
  WorldPoint at;
  double area = 0;
};

struct TrueSurface {
  std::vector<SurfacePoint> points;  ///< spread evenly, as many as were asked for at most
  double area = 0;
  /// Volume that the surface encloses; it tells nothing where a domain cuts the surface.
  double enclosed_volume = 0;
};

/// Samples phi in each of `bricks`, all that the surface passes, of which those outside
/// `domain` are left out. The surface is first taken as flat within a sixth of a lattice cell;
/// how far the true one is from that is then measured at the points, and added to the volume.
/// Parallel; one value for any number of threads. Errors: kCancelled, kDeadlineExceeded.
absl::StatusOr<TrueSurface> find_true_surface(const PhiField& field,
                                              const std::vector<BrickCoord>& bricks,
                                              const std::optional<BrickBox>& domain,
                                              std::size_t most_points,
                                              const Cancellation& cancellation);

}  // namespace tet
