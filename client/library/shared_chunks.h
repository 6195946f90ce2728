// Chunks in memory that a server of this host writes and this process reads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/base/posix/descriptor.h"
#include "core/base/posix/sealed_memory.h"
#include "core/mesh/tet_mesh.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

/// One mesh's shared memory, over as many streams as it takes. Trusts nothing that the server
/// says. Not thread-safe.
class SharedChunks {
 public:
  /// Begins another stream at the server whose socket file this is, empty for one that has
  /// none. Returns what the request is to say, empty where there is no shared memory, and
  /// waits for that until `cancellation` at most.
  std::string begin(const std::string& grpc_path, const Cancellation& cancellation);

  /// Maps the memory that a header tells of. Errors: kUnavailable (it cannot be used: the next
  /// stream goes without), kDataLoss (nobody has asked for it).
  absl::Status open(const v1::SharedMemory& told);
  bool is_open() const noexcept { return memory_.has_value(); }

  /// Copies columns from `offset` on, each into as many bytes as it has; returns the checksum
  /// of what was copied, whatever the server does to the memory meanwhile. Errors: kDataLoss
  /// (they do not lie within the memory).
  absl::StatusOr<std::uint32_t> copy(std::int64_t offset, const ChunkColumns& to) const;

  /// The chunk was copied, or came otherwise: its block is free.
  void acknowledge(std::uint64_t index) noexcept;

 private:
  bool refused_ = false;  ///< it could not be used once
  Descriptor side_;
  std::optional<SharedMemory> memory_;
};

}  // namespace tet
