// What a public stream holds.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "client/library/api/work.h"
#include "client/library/chunk_supply.h"
#include "tetstream/stream.h"

namespace tetstream {

struct MeshStream::Impl {
  explicit Impl(const WorkOptions& options) : work(options) {}

  Work work;
  /// Makes what is read, when it is asked for the first time.
  std::function<Result<std::unique_ptr<tet::ChunkSupply>>(const tet::Cancellation&)> begin;
  std::unique_ptr<tet::ChunkSupply> source;
  const tet::MeshHeader* header = nullptr;
  Chunk chunk;
  Status failure;
  bool ended = false;
};

}  // namespace tetstream
