// One decoder process, from its start to its end.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <sys/types.h>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/posix/descriptor.h"
#include "core/vdb/decoder/decoder_protocol.h"
#include "core/vdb/decoder/sealed_block.h"

namespace tet {

/// How long a decoder may take by the clock for what is no matter of its file: much longer than
/// it takes, as a machine may be busy with other things. Tests wait longer still.
struct DecoderPatience {
  /// A machine that starts no program within this is not one to wait for.
  std::chrono::milliseconds start{10'000};
  /// A process that has closed its socket is gone in a moment, which a busy machine draws out:
  /// how it ended tells what was wrong with the file.
  std::chrono::milliseconds last_moment{5'000};
};

struct DecoderProgram {
  std::string path;                      ///< empty finds it: see find_decoder
  std::vector<std::string> environment;  ///< "NAME=value"; a decoder inherits none
  DecoderPatience patience;
};

/// When a decode has to end, whether it is done or not.
struct DecodeEnd {
  std::chrono::steady_clock::duration limit;
  /// Polled every few milliseconds; null never cancels. Must not throw.
  std::function<bool()> cancelled;
};

/// A process that decodes one file and is gone: no byte of one file can be in the result of
/// another. It also ends with the thread that started or copied it.
///
/// Not thread-safe.
class Decoder {
 public:
  /// Starts the program and does not wait for it. Errors: kUnavailable.
  static absl::StatusOr<Decoder> start(const DecoderProgram& program);

  /// Has it become two, and does not wait until the copy is ready. This one must be ready, must
  /// have no order yet, and can be copied again. Call it on the thread that started it. Errors:
  /// kUnavailable, kCancelled; after either there is no copy that was not told of, and this one
  /// and its other copies may be gone, too.
  absl::StatusOr<Decoder> copy(const std::function<bool()>& cancelled);

  /// Kills the process and waits until nothing of it is left.
  ~Decoder();
  Decoder(Decoder&& other) noexcept = default;
  Decoder& operator=(Decoder&& other) = delete;

  /// Waits until it is ready for an order. Errors: kUnavailable (it never will be), kCancelled.
  absl::Status wait_until_ready(const std::function<bool()>& cancelled);

  /// Has it read `file`; once. Errors: what the decoder says of the file; kInvalidArgument with
  /// DECODER_CRASHED, DECODER_TIMEOUT, DECODER_MEMORY or DECODER_RESULT; kResourceExhausted
  /// with DECODER_MEMORY (killed from outside: another try may succeed); kCancelled;
  /// kUnavailable (it was gone before it had the order: another one may do it).
  absl::StatusOr<SealedBlock> decode(const DecodeOrder& order, int file, const DecodeEnd& end);

  /// The decoder's process, for tests that do it harm.
  pid_t pid() const noexcept { return pid_; }

 private:
  enum class Event { kMessage, kDeadline, kCancelled };

  Decoder(pid_t pid, Descriptor process, Descriptor socket, const DecoderPatience& patience)
      : pid_(pid),
        process_(std::move(process)),
        socket_(std::move(socket)),
        patience_(patience) {}

  static absl::StatusOr<Decoder> watch(pid_t pid,
                                       Descriptor socket,
                                       const DecoderPatience& patience);
  Event wait(std::chrono::steady_clock::time_point deadline,
             const std::function<bool()>& cancelled) const;
  absl::Status explain_death(const DecodeOrder& order, const std::function<bool()>& cancelled);
  void end_with_copies();

  pid_t pid_;
  Descriptor process_;  ///< a pidfd; closed once the process is reaped
  Descriptor socket_;
  DecoderPatience patience_;
};

}  // namespace tet
