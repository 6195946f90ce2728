// Decoder processes that stand ready, and the requests that wait for them.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/fair_queue.h"
#include "core/vdb/decoder/decoder_supply.h"
#include "core/vdb/decoder/file_request.h"
#include "core/vdb/decoder/sealed_block.h"

namespace tet {

struct DecoderSettings {
  DecoderProgram program;
  int processes = 0;  ///< at once; 0 takes one for every core
  std::chrono::milliseconds max_time{120'000};
  /// What any file has by the clock, within `max_time`, however little it may take of a
  /// processor; for tests.
  std::chrono::milliseconds least_time{0};
};

/// Keeps one decoder ready for each file that may be decoded at once, and replaces it after its
/// one file; one that was not needed waits for the next.
///
/// A file that a decoder cannot survive costs its own request an error and nobody else
/// anything. Thread safety: any thread may call `decode`. The destructor cancels what waits and
/// what runs, and returns when every `done` has.
class DecoderPool {
 public:
  using Done = std::function<void(absl::StatusOr<SealedBlock>)>;

  explicit DecoderPool(DecoderSettings settings);
  ~DecoderPool();
  DecoderPool(const DecoderPool&) = delete;
  DecoderPool& operator=(const DecoderPool&) = delete;

  /// Calls `done` on a thread of the pool, which it must not hold up. The next decode is of the
  /// client whose decodes have taken least time in all: see FairQueue. `cancelled` is polled,
  /// and null never cancels. Errors: those of check_request and Decoder::decode; kUnavailable
  /// with DECODER_UNAVAILABLE (no decoder can be started) or SHUTTING_DOWN.
  void decode(const std::string& client,
              FileRequest request,
              std::function<bool()> cancelled,
              Done done);

 private:
  struct Job {
    std::string client;
    FileRequest request;
    std::function<bool()> cancelled;
    Done done;
  };

  void work();
  std::optional<Job> next_job();
  void charge(const Job& job, std::chrono::nanoseconds use);
  absl::StatusOr<SealedBlock> run(const Job& job, DecoderSupply& supply);
  absl::StatusOr<SealedBlock> run_contained(const Job& job, DecoderSupply& supply);

  const DecoderSettings settings_;
  std::mutex mutex_;
  std::condition_variable changed_;
  FairQueue<Job> jobs_;
  std::atomic<bool> closing_{false};
  std::vector<std::thread> threads_;  // last: they use all of the above
};

/// Decodes one file in the calling thread, which waits. Errors: those of DecoderPool::decode.
absl::StatusOr<SealedBlock> decode_once(const FileRequest& request,
                                        const DecoderSettings& settings,
                                        const std::function<bool()>& cancelled);

}  // namespace tet
