// When a caller wants its answer by.
#pragma once

#include <grpcpp/server_context.h>

#include "core/base/cancel.h"

namespace tet {

/// The call's deadline; the end of time where it has none, or one so far away that clocks
/// cannot say it: a client may ask for eleven thousand years.
Cancellation::Clock::time_point deadline_of(const grpc::CallbackServerContext& context);

}  // namespace tet
