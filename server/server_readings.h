// What the server holds and does at this moment, for the metrics.
#pragma once

#include <vector>

#include "server/grid_store.h"
#include "server/mesh_engine.h"
#include "server/metrics.h"

namespace tet {

/// Calls, meshes, the store, the grids in memory and the plans kept.
std::vector<Reading> read_server(const MeshEngine& engine, const GridStore& store);

}  // namespace tet
