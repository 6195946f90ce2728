// What is meshed in this process: files become shapes.
#pragma once

#include <optional>

#include <absl/status/statusor.h>

#include "client/command/arguments/mesh_options.h"
#include "client/command/process/progress_bar.h"
#include "core/base/cancel.h"
#include "core/plan/shape.h"

namespace tet {

struct ReadShape {
  Shape shape;
  std::optional<ConversionReport> surface;  ///< where the input is one
};

/// The input of a command; run it on a TaskPool. Errors: those of read_volume, read_scene and
/// surface_to_volume.
absl::StatusOr<ReadShape> read_shape(const MeshOptions& options,
                                     ProgressBar& bar,
                                     const Cancellation& interruption);

/// The request with the grids of its sizing and its fields. Errors: those of read_volume and
/// read_field.
absl::StatusOr<MeshRequest> read_request(const MeshOptions& options,
                                         const Cancellation& interruption);

}  // namespace tet
