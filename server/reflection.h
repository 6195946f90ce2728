// Whether a server tells strangers which calls it has.
#pragma once

#include <grpcpp/server_builder.h>

#include "server/ops/config.h"

namespace tet {

/// To be called before any server is built: gRPC gives reflection to all of a process then.
void prepare_reflection();

/// Takes it from this one, unless the settings ask for it.
void choose_reflection(grpc::ServerBuilder& builder, const Config& config);

}  // namespace tet
