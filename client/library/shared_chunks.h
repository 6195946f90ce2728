// Chunks in memory that a server of this host writes and this process reads.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <grpcpp/support/byte_buffer.h>

#include "core/base/cancel.h"
#include "core/base/posix/descriptor.h"
#include "core/base/posix/sealed_memory.h"
#include "core/mesh/tet_mesh.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet {

namespace v1 = ::tetstream::v1;

/// What was found out about what was copied, whatever the server does to its memory meanwhile.
struct CopiedChunk {
  std::uint32_t checksum = 0;
  bool ids_are_within = true;  ///< those of its tets, the mesh
};

/// Shared memory for one mesh after the other, over as many streams as they take. Trusts
/// nothing that the server says. Not thread-safe.
class SharedChunks {
 public:
  /// Whether an event has come in the stream meanwhile, or its end.
  using InStream = std::function<bool()>;

  /// An answer waits for others no longer than `answers_within`: a server must not take a
  /// client for stalled that has copied all there is, or takes its time for each chunk. The
  /// server is waited for no longer than `patience`: one that is there takes its time only
  /// where the whole host does.
  explicit SharedChunks(
      std::chrono::milliseconds answers_within = std::chrono::milliseconds(250),
      std::chrono::milliseconds patience = std::chrono::seconds(10)) noexcept
      : answers_within_(answers_within), patience_(patience) {}

  /// Begins another stream at the server whose socket file this is, empty for one that has
  /// none. Returns what the request is to say, empty where there is no shared memory, and
  /// waits for that until `cancellation` at most.
  std::string begin(const std::string& grpc_path, const Cancellation& cancellation);
  /// Says in a request what `begin` has returned, and that events may come here.
  template <class Request>
  void ask(Request& request, const std::string& grpc_path, const Cancellation& cancellation) {
    request.set_shared_memory(begin(grpc_path, cancellation));
    request.set_shared_memory_events(!request.shared_memory().empty());
  }

  /// Maps the memory that a header tells of. Errors: kUnavailable (it cannot be used: the next
  /// stream goes without), kDataLoss (nobody has asked for it), kCancelled, kDeadlineExceeded.
  absl::Status open(const v1::SharedMemory& told, const Cancellation& cancellation);
  bool is_open() const noexcept { return open_; }
  /// Whether memory is mapped, whether or not a stream uses it.
  bool holds_memory() const noexcept { return memory_.has_value(); }

  /// Waits for the next event, until `cancellation` at most. False where it comes in the
  /// stream: the server has said so, or is gone, or what `in_stream` asks for now and then is
  /// there.
  bool take_event(grpc::ByteBuffer& event,
                  const Cancellation& cancellation,
                  const InStream& in_stream);

  /// A frame of the stream is whole: the next one's header tells of memory again.
  void pause() noexcept;
  /// The stream has ended as it should: what it used serves the next.
  void rest() noexcept;
  /// Whether another stream may have this.
  bool rests() const noexcept { return rests_; }

  /// Copies columns from `offset` on, each into as many bytes as it has. Errors: kDataLoss
  /// (they do not lie within the memory).
  absl::StatusOr<CopiedChunk> copy(std::int64_t offset,
                                   const ChunkColumns& to,
                                   const MeshHeader& header) const;

  /// What was copied is not what the server told of. Memory that its server can free was taken
  /// back, as when that ends: returns kUnavailable, so that the chunk is asked for again, and
  /// sent. Any other is what the server has made: kDataLoss, as of a message.
  absl::Status distrust(std::uint64_t index);

  /// The chunk was copied, or came otherwise: its block is free. The server may hear of it
  /// later, with others.
  void acknowledge(std::uint64_t index) noexcept;

 private:
  using Clock = std::chrono::steady_clock;

  bool connect(const std::string& grpc_path, const Cancellation& cancellation);
  std::chrono::milliseconds patience(const Cancellation& cancellation) const;
  void answer() noexcept;
  bool is_time_to_look() noexcept;

  bool refused_ = false;  ///< it could not be used once
  bool open_ = false, rests_ = false;
  std::chrono::milliseconds answers_within_, patience_;
  Clock::time_point answered_{};
  Clock::time_point looked_{};                  ///< into the stream
  bool events_ = false, next_is_here_ = false;  ///< and not in the stream
  std::uint64_t answer_after_ = 1;              ///< so many chunks
  std::uint64_t unanswered_ = 0, last_ = 0;     ///< chunks, and the last of them
  Descriptor side_;
  std::string path_, token_;  ///< of `side_`
  /// That of the last stream, until another comes: where the server can free it meanwhile.
  std::optional<SharedMemory> memory_;
};

}  // namespace tet
