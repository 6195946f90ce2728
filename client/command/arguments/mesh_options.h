// What `tetstream mesh` was asked for.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "client/command/arguments/surface_input.h"
#include "client/library/channel.h"
#include "core/image/place_array.h"
#include "core/plan/mesh_request.h"

namespace tet {

struct MeshOptions {
  std::string input, output;
  std::string format;              ///< of the output; empty takes what its ending says
  std::vector<std::string> grids;  ///< empty takes the only meshable grid
  bool all_grids = false;          ///< all that can be meshed, instead
  bool trust = false;              ///< read the .vdb file in this process
  SurfaceChoices surface;          ///< where the input is one
  ArrayPlace place;                ///< of an array of NumPy, where it is not the usual one
  MeshRequest request;
  int threads = 0;          ///< 0 takes every core
  std::string server;       ///< HOST:PORT; empty meshes in this process
  ChannelOptions channel;   ///< how that is spoken to
  bool compact = false;     ///< half a byte a tet from the server, and the mesh is made here
  bool packed = false;      ///< four bytes a tet, and it is unpacked here
  bool skip_cache = false;  ///< also where the server has the mesh as a job's result
  std::string report;       ///< path; empty writes none
  int order = 1;            ///< of the tets: with 2 they have a node in the middle of each edge

  /// The meshes of more than one grid are joined.
  bool has_several_grids() const noexcept { return all_grids || grids.size() > 1; }
};

}  // namespace tet
