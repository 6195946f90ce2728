// What each client has used, for whoever runs the server.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server/ops/metrics.h"

namespace tet {

/// What one client has used since the server started. Thread-safe.
struct ClientCounts {
  std::atomic<std::uint64_t> calls{0};     ///< that ended
  std::atomic<std::uint64_t> refusals{0};  ///< of these, calls that failed
  std::atomic<std::uint64_t> sent_bytes{0}, received_bytes{0};
  std::atomic<std::chrono::nanoseconds::rep> work_ns{0};  ///< time of threads
};

/// Counts the time from its construction to its destruction as work.
class WorkTimer {
 public:
  explicit WorkTimer(ClientCounts& counts) : counts_(counts) {}
  ~WorkTimer() { counts_.work_ns += (std::chrono::steady_clock::now() - begin_).count(); }
  WorkTimer(const WorkTimer&) = delete;
  WorkTimer& operator=(const WorkTimer&) = delete;

 private:
  ClientCounts& counts_;
  const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// Counts what clients use by their names, as many as an operator has given them: of tokens, of
/// certificates, and of namespaces whose jobs are done. Those who only have an address are
/// counted together, as are names beyond the first `kMostNames`: anyone can come from thousands
/// of addresses, and what has been counted once is told, and kept by whoever asks, for ever.
///
/// Thread safety: any thread may call any member. Counts stay where they are.
class ClientUse {
 public:
  static constexpr std::size_t kMostNames = 64;
  /// As a client is called that has no name; no token, subject or namespace is called so.
  static constexpr char kOthers[] = "(others)";

  /// From now on this client is told by its name, if there is room for it.
  ClientCounts& name(const std::string& client);
  /// The counts of a client that has a name, of the jobs of a namespace, or of all others.
  ClientCounts& of(const std::string& client);

  std::vector<Reading> readings() const;

 private:
  mutable std::mutex mutex_;
  ClientCounts others_;
  std::map<std::string, std::unique_ptr<ClientCounts>> named_;
};

}  // namespace tet
