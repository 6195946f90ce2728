// What all mesh calls share: the threads, the plans, the scratch memory, and the limits.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/parallel.h"
#include "core/decode/decoder_pool.h"
#include "core/pipeline/mesh_plan.h"
#include "proto/wire/block_pool.h"
#include "server/calls.h"
#include "server/config.h"
#include "server/planner.h"

namespace tet {

/// Scratch memory that tasks take turns with. Thread-safe.
class WorkspacePool {
 public:
  MeshWorkspace take();
  void give_back(MeshWorkspace workspace);

 private:
  std::mutex mutex_;
  std::vector<MeshWorkspace> idle_;
};

/// What the server is doing, for logs and tests.
struct Activity {
  std::atomic<std::int64_t> meshes{0};            ///< streams and estimates that run
  std::atomic<std::int64_t> chunks_in_flight{0};  ///< tasks posted and not done
  std::atomic<std::int64_t> chunks_made{0};       ///< since the start
};

/// Counts a mesh call as running until it is destroyed.
using MeshTicket = std::shared_ptr<void>;

struct MeshEngine {
  MeshEngine(const Config& server_config, CallRegistry& call_registry, GridStore& store);

  /// Errors: those of Call::admission, kResourceExhausted (over `max_streams`).
  absl::StatusOr<MeshTicket> admit(const Call& call);

  const Config config;
  CallRegistry& calls;
  Activity activity;
  WorkspacePool workspaces;
  BlockPool blocks;
  Planner planner;
  TaskPool pool;         ///< its tasks end before what is above, which they use
  DecoderPool decoders;  ///< last: what it decodes becomes tasks
};

}  // namespace tet
