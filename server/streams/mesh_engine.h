// What all mesh calls share: the threads, the plans, the scratch memory, and the limits.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include <absl/status/statusor.h>

#include "core/base/parallel.h"
#include "core/base/scratch_pool.h"
#include "core/plan/mesh_workspace.h"
#include "core/vdb/decoder/decoder_pool.h"
#include "proto/wire/block_pool.h"
#include "server/jobs/results/result_store.h"
#include "server/meshing/chunk_maker.h"
#include "server/meshing/large_plans.h"
#include "server/meshing/planner.h"
#include "server/meshing/send_budget.h"
#include "server/ops/config.h"
#include "server/rpc/calls.h"
#include "server/rpc/fair_tasks.h"
#include "server/rpc/stall_watch.h"
#include "server/shared_memory/kept_memory.h"
#include "server/shared_memory/shared_memory_port.h"

namespace tet {

/// What the server is doing, for logs and tests.
struct Activity {
  std::atomic<std::int64_t> meshes{0};            ///< streams and estimates that run
  std::atomic<std::int64_t> chunks_in_flight{0};  ///< tasks posted and not done
  std::atomic<std::int64_t> chunks_made{0};       ///< since the start
  std::atomic<std::int64_t> cached_streams{0};    ///< served from results of jobs
  std::atomic<std::int64_t> shared_streams{0};    ///< whose chunks were in shared memory
  /// Memory of grids that sessions have changed.
  std::atomic<std::uint64_t> changed_grid_bytes{0};
  std::atomic<std::uint64_t> point_bytes{0};  ///< of points that are sampled
};

struct MeshEngine {
  MeshEngine(const Config& server_config, CallRegistry& call_registry, GridStore& store);

  /// See Admission::queue_mesh: meshes that are admitted are counted as running, too.
  Admission::Place admit(const Call& call,
                         Cancellation::Clock::time_point deadline,
                         Admission::Answer answer);

  /// What chunks are made with.
  ChunkMemory chunk_memory() noexcept { return {workspaces, packers, blocks}; }

  /// Ends streams whose clients stopped reading: sooner where others wait for their blocks. To
  /// be called every now and then, as what follows.
  void check_stalls(Stallable::Clock::time_point now);
  /// How long a session may wait for its client: no longer than half a minute where its grid or
  /// its plan may be what has left others no room lately.
  std::chrono::seconds session_idle() const;
  /// Whether streams should not make chunks ahead. What idles is not in their way.
  bool is_tight() const { return send_budget.is_tight(kept_memory.bytes()); }
  /// Gives up shared memory that no stream has used for a while.
  void give_up_idle() { kept_memory.give_up_idle(KeptMemory::Clock::now()); }

  const Config config;
  CallRegistry& calls;
  Activity activity;
  ScratchPool<MeshWorkspace> workspaces;
  ScratchPool<ChunkPacker> packers;
  BlockPool blocks;
  SendBudget send_budget;
  KeptMemory kept_memory;  ///< part of what the budget holds
  StallWatch stalls;
  const ResultStore* results = nullptr;  ///< set before the first call, where there are jobs
  SharedMemoryPort* shared_memory = nullptr;  ///< likewise, where there is a socket file
  PlanTurns turns;
  Planner planner;
  // Last, so that their tasks end before what is above, which they use.
  FairTasks short_tasks{pool, &calls.clients()};
  TaskPool pool;  ///< chunks and short plans
  // Each on as many threads again: the system shares the cores.
  LargePlans longer;  ///< plans in turns of half a second
  LargePlans large;
  LargePlans loads;      ///< of grids: files are verified, and what was decoded
  DecoderPool decoders;  ///< what it decodes becomes tasks
};

}  // namespace tet
