#include "server/mesh_engine.h"

#include <utility>

#include "proto/wire/chunk_frame.h"
#include "server/status.h"

namespace tet {

MeshWorkspace WorkspacePool::take() {
  {
    const std::lock_guard lock(mutex_);
    if (!idle_.empty()) {
      MeshWorkspace workspace = std::move(idle_.back());
      idle_.pop_back();
      return workspace;
    }
  }
  return {};
}

void WorkspacePool::give_back(MeshWorkspace workspace) {
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(workspace));
}

namespace {

// 32 MiB: more than one stream, or a few, ever hold.
constexpr std::size_t kIdleBlocks = 64;

/// A plan may keep this much of the surface's geometry: enough for meshes of ten million tets.
constexpr std::uint64_t kKeptGeometryBytes = std::uint64_t{16} << 20;

MeshLimits mesh_limits(const Config& config) {
  MeshLimits limits;
  limits.max_tets = config.max_tets;
  limits.kept_geometry_bytes = kKeptGeometryBytes;
  return limits;
}

DecoderSettings decoder_settings(const Config& config) {
  DecoderSettings settings;
  settings.program = config.decoder;
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
      blocks(kChunkBytes + ChunkFrame::kMaxOverhead, kIdleBlocks),
      planner(pool, decoders, store, config.resident_bytes, mesh_limits(config)),
      pool(static_cast<int>(config.threads)),
      decoders(decoder_settings(config)) {}

absl::StatusOr<MeshTicket> MeshEngine::admit(const Call& call) {
  if (const absl::Status status = call.admission(); !status.ok()) return status;
  const std::int64_t running = activity.meshes.fetch_add(1) + 1;
  MeshTicket ticket(
      &activity, [](void* counted) { static_cast<Activity*>(counted)->meshes.fetch_sub(1); });
  if (running > static_cast<std::int64_t>(config.max_streams)) {
    return with_retry(over_limit("meshes being made at once",
                                 static_cast<std::uint64_t>(running), config.max_streams),
                      absl::Seconds(1));
  }
  return ticket;
}

}  // namespace tet
