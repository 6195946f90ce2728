// What the server holds and does at this moment, for the metrics.
#pragma once

#include <vector>

#include "server/grids/grid_store.h"
#include "server/ops/metrics.h"
#include "server/rpc/access.h"
#include "server/rpc/tls.h"
#include "server/streams/mesh_engine.h"

namespace tet {

/// Calls, meshes, the store, the grids in memory and the plans kept.
std::vector<Reading> read_server(const MeshEngine& engine, const GridStore& store);

/// Whether tokens and certificates are those of their files, and until when; `tls` may be null.
/// Asks the disk.
std::vector<Reading> read_credentials(Access& access, ServerTls* tls);

}  // namespace tet
