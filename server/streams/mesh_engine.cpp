#include "server/streams/mesh_engine.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "proto/wire/chunk_frame.h"
#include "server/ops/memory.h"

namespace tet {

namespace {

// What plans have in their turns. Those of one kind are as many at once as there are threads
// for chunks; one; and two, so that one very large plan does not keep all others waiting.
constexpr std::chrono::milliseconds kShortTurn{50}, kLongerTurn{500};

/// Files that are verified and grids that are checked at once: their bytes come from a disk.
constexpr std::size_t kLoadsAtOnce = 4, kLoadsOfClient = 2;

constexpr std::size_t kBlockBytes = kChunkBytes + ChunkFrame::kMaxOverhead;
// More than one stream, or a few, ever hold.
constexpr std::size_t kIdleBlocks = kIdleBlockBytes / kBlockBytes;

/// Where others have waited this long for a block, whoever takes nothing of its own for so long
/// loses it.
constexpr std::chrono::seconds kKeptWaiting{1}, kPressedStall{5};

/// Where somebody was refused for want of room so lately, who has surely tried again since if
/// it is still wanted, a session may be idle for no longer than that.
constexpr std::chrono::seconds kRoomLacked{20}, kPressedIdle{30};

/// A quarter of what there is for chunks may be idle, until somebody lacks it.
constexpr std::uint64_t kIdleShare = 4;

/// A plan may keep this much of the surface's geometry: enough for meshes of ten million tets.
constexpr std::uint64_t kKeptGeometryBytes = std::uint64_t{12} << 20;

MeshLimits mesh_limits(const Config& config) {
  MeshLimits limits;
  limits.max_tets = config.max_tets;
  limits.max_plan_bytes = std::min(kLongestPlanBytes, config.plan_bytes);
  limits.kept_geometry_bytes = kKeptGeometryBytes;
  return limits;
}

PlanTurns::Kinds plan_turns(const Config& config) {
  const std::uint64_t most = mesh_limits(config).max_plan_bytes;
  return {{{kShortTurn, std::min(kShortPlanBytes, most), false},
           {kLongerTurn, std::min(kLongerPlanBytes, most), false},
           {std::chrono::seconds(config.plan_seconds), most, true}}};
}

DecoderSettings decoder_settings(const Config& config) {
  DecoderSettings settings;
  settings.program.path = config.decoder;
  settings.processes = static_cast<int>(config.decoders);
  settings.max_time = std::chrono::seconds(config.decode_seconds);
  return settings;
}

}  // namespace

MeshEngine::MeshEngine(const Config& server_config,
                       CallRegistry& call_registry,
                       GridStore& store)
    : config(server_config),
      calls(call_registry),
      blocks(kBlockBytes, kIdleBlocks),
      send_budget(config.send_bytes, kBlockBytes),
      kept_memory(config.send_bytes / kIdleShare),
      turns({short_tasks, longer, large}, plan_turns(config)),
      planner({short_tasks, loads, turns},
              decoders,
              store,
              {config.resident_bytes, config.plan_bytes},
              mesh_limits(config)),
      pool(static_cast<int>(config.threads)),
      longer(static_cast<int>(config.threads), 1, SIZE_MAX, &calls.clients()),
      large(static_cast<int>(config.threads), kLongPlansAtOnce, 1, &calls.clients()),
      loads(static_cast<int>(config.threads), kLoadsAtOnce, kLoadsOfClient, &calls.clients()),
      decoders(decoder_settings(config)) {
  send_budget.recall_with([this] { return kept_memory.give_up_all(); });
}

Admission::Place MeshEngine::admit(const Call& call,
                                   Cancellation::Clock::time_point deadline,
                                   Admission::Answer answer) {
  const auto count = [this, answer = std::move(answer)](absl::StatusOr<Ticket> ticket) {
    if (!ticket.ok()) return answer(std::move(ticket));
    activity.meshes.fetch_add(1);
    answer(Ticket(this, [this, admitted = *std::move(ticket)](void*) mutable {
      admitted.reset();
      activity.meshes.fetch_sub(1);  // last: a mesh that is not counted has no place, either
    }));
  };
  return calls.admission().queue_mesh(call.client(), deadline, count);
}

void MeshEngine::check_stalls(Stallable::Clock::time_point now) {
  std::chrono::seconds limit(config.stall_seconds);
  if (send_budget.kept_waiting_since(now - kKeptWaiting)) {
    limit = std::min(limit, kPressedStall);
  }
  stalls.check(now, limit);
}

std::chrono::seconds MeshEngine::session_idle() const {
  const std::chrono::seconds most(config.session_idle_seconds);
  const bool is_pressed = planner.has_refused_since(LastTime::Clock::now() - kRoomLacked);
  return is_pressed ? std::min(most, kPressedIdle) : most;
}

}  // namespace tet
