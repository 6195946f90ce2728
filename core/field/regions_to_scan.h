// Which regions of a volume have to be looked at for its surface.
#pragma once

#include <vector>

#include <absl/status/statusor.h>

#include "core/base/brick_box.h"
#include "core/base/cancel.h"
#include "core/base/types.h"
#include "core/field/phi_field.h"

namespace tet {

/// Regions in which there may be both signs, or one, and nothing else that they lie deep in;
/// by their first bricks: sorted, unique. Errors: kFailedPrecondition (the volume's constants
/// claim more than can be looked at), kCancelled, kDeadlineExceeded.
absl::StatusOr<std::vector<BrickCoord>> regions_to_scan(const PhiField& field,
                                                        const Cancellation& cancellation);

/// What regions_to_scan leaves out of cubes that lie inside.
std::vector<BrickBox> deep_inside(const PhiField& field);

}  // namespace tet
