// What a server needs before it can mesh: its request, and the files that it is about.
#pragma once

#include <optional>

#include <absl/status/statusor.h>

#include "client/command/arguments/mesh_options.h"
#include "client/command/process/progress_bar.h"
#include "client/library/mesh_client.h"
#include "core/base/cancel.h"

namespace tet {

struct PreparedRequest {
  v1::MeshRequest message;
  std::optional<ConversionReport> surface;  ///< where the input is one
};

/// The request for a command's input, once the server has what it needs of it. Errors: those of
/// upload_input and read_scene_message.
absl::StatusOr<PreparedRequest> prepare_request(MeshClient& client,
                                                const MeshOptions& options,
                                                ProgressBar& bar,
                                                const Cancellation& interruption);

}  // namespace tet
