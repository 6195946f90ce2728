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

/// Shared memory for one mesh after the other, over as many streams as they take. Trusts
/// nothing that the server says. Not thread-safe.
class SharedChunks {
 public:
  /// Begins another stream at the server whose socket file this is, empty for one that has
  /// none. Returns what the request is to say, empty where there is no shared memory, and
  /// waits for that until `cancellation` at most.
  std::string begin(const std::string& grpc_path, const Cancellation& cancellation);

  /// Maps the memory that a header tells of. Errors: kUnavailable (it cannot be used: the next
  /// stream goes without), kDataLoss (nobody has asked for it).
  absl::Status open(const v1::SharedMemory& told);
  bool is_open() const noexcept { return open_; }
  /// Whether memory is mapped, whether or not a stream uses it.
  bool holds_memory() const noexcept { return memory_.has_value(); }

  /// A frame of the stream is whole: the next one's header tells of memory again.
  void pause() noexcept;
  /// The stream has ended as it should: what it used serves the next.
  void rest() noexcept;
  /// Whether another stream may have this.
  bool rests() const noexcept { return rests_; }

  /// Copies columns from `offset` on, each into as many bytes as it has; returns the checksum
  /// of what was copied, whatever the server does to the memory meanwhile. Errors: kDataLoss
  /// (they do not lie within the memory).
  absl::StatusOr<std::uint32_t> copy(std::int64_t offset, const ChunkColumns& to) const;

  /// What was copied is not what the server told of: the memory was taken back, as when its
  /// server ends. Returns kUnavailable, so that the chunk is asked for again, and sent.
  absl::Status distrust(std::uint64_t index) noexcept;

  /// The chunk was copied, or came otherwise: its block is free.
  void acknowledge(std::uint64_t index) noexcept;

 private:
  bool connect(const std::string& grpc_path, const Cancellation& cancellation);

  bool refused_ = false;  ///< it could not be used once
  bool open_ = false, rests_ = false;
  Descriptor side_;
  std::string path_, token_;  ///< of `side_`
  /// That of the last stream, until another comes: where the server can free it meanwhile.
  std::optional<SharedMemory> memory_;
};

}  // namespace tet
