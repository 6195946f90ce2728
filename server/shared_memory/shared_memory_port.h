// The socket file at which clients of this host ask for shared memory.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <sys/types.h>
#include <utility>

#include <absl/status/statusor.h>

#include "core/base/posix/descriptor.h"
#include "core/base/posix/socket_file.h"
#include "server/http/event_loop.h"
#include "server/http/listener_watch.h"
#include "server/shared_memory/side_connection.h"

namespace tet {

class SideClaim;

/// Tells each client that connects 16 random bytes. Whoever sends them with a call, which is
/// authorized as all calls are, is whoever holds the connection: then a stream claims it,
/// alone. A stream that ends well gives it back, for the client's next stream. Connections that
/// nobody claims end after a minute, and one user has only so many of them; those that a stream
/// has given back count for themselves, as whoever may not call has none.
///
/// Thread safety: any thread may call `claim`.
class SharedMemoryPort {
 public:
  static constexpr std::size_t kMostUnclaimed = 1024, kMostUnclaimedOfUser = 256;
  static constexpr std::size_t kMostResting = 1024, kMostRestingOfUser = 256;

  /// Listens beside the socket file `grpc_path`. Errors: those of SocketFile.
  static absl::StatusOr<std::unique_ptr<SharedMemoryPort>> open(const std::string& grpc_path,
                                                                mode_t rights);
  ~SharedMemoryPort();

  /// The connection that was told `token`; none where there is none, or it is claimed.
  SideClaim claim(const std::string& token);

 private:
  friend class SideClaim;
  using Clock = std::chrono::steady_clock;
  enum class Kind : bool { kUnclaimed, kResting };

  /// A connection that nobody has claimed, or that a stream has given back.
  struct Waiting {
    std::shared_ptr<SideConnection> connection;
    uid_t user = 0;
    Kind kind = Kind::kUnclaimed;
    Clock::time_point since;
  };

  SharedMemoryPort(SocketFile file, Descriptor listener);
  Accepted accept_one();
  void tick();
  bool add(Descriptor socket);
  bool wait_for_claim(const std::shared_ptr<SideConnection>& connection, uid_t user, Kind kind);
  void heed(const std::shared_ptr<SideConnection>& connection);
  void forget(const std::shared_ptr<SideConnection>& connection);
  void end_old();

  SocketFile file_;
  const Descriptor listener_;
  std::mutex mutex_;
  std::map<std::string, Waiting> waiting_;  ///< by token
  ListenerWatch watch_;                     ///< of the loop
  EventLoop loop_;                          // last: its thread uses the others
};

/// One stream's connection: it ends with the stream, unless it is given back.
class SideClaim {
 public:
  SideClaim() = default;
  SideClaim(SharedMemoryPort& port, std::shared_ptr<SideConnection> connection, uid_t user)
      : port_(&port), connection_(std::move(connection)), user_(user) {}
  ~SideClaim() { end(); }
  SideClaim(SideClaim&& other) noexcept { *this = std::move(other); }
  SideClaim& operator=(SideClaim&& other) noexcept;

  /// Null where there is none.
  const std::shared_ptr<SideConnection>& connection() const noexcept { return connection_; }
  /// Who is at its other end.
  Readers readers() const noexcept;

  /// Ends the connection.
  void end() noexcept;
  /// Lets another stream claim it, before the port is destroyed.
  void give_back();

 private:
  SharedMemoryPort* port_ = nullptr;
  std::shared_ptr<SideConnection> connection_;
  uid_t user_ = 0;
};

}  // namespace tet
