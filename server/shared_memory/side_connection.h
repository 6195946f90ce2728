// A client's end of shared memory: one connection, for one stream.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "core/base/posix/descriptor.h"
#include "core/base/posix/sealed_memory.h"

namespace tet {

/// Whoever uses a connection. Called on the port's thread; never waits.
class SideUser {
 public:
  virtual ~SideUser() = default;
  /// The client has done with a chunk, or says so.
  virtual void acknowledged(std::uint64_t index) = 0;
  /// Nothing more comes: the client has closed its end, or sent what is no message.
  virtual void ended() = 0;
};

/// The connection through which a client is handed memory and says what of it is free again.
/// Thread-safe.
class SideConnection {
 public:
  static constexpr std::size_t kTokenBytes = 16;

  SideConnection(Descriptor socket, std::string token)
      : socket_(std::move(socket)), token_(std::move(token)) {}

  const Descriptor& socket() const noexcept { return socket_; }
  const std::string& token() const noexcept { return token_; }

  /// Tells the client its token. False where it does not take that at once.
  bool tell_token() noexcept;
  /// Hands the client its memory; from now on `user` is told what it says.
  bool hand_over(const SealedMemory& memory, std::weak_ptr<SideUser> user);
  /// Ends the connection; what was sent arrives all the same.
  void close() noexcept;

  /// Takes what the client has sent; false where there is nothing more to come. The port's.
  bool take();

 private:
  const Descriptor socket_;
  const std::string token_;
  std::mutex mutex_;
  std::weak_ptr<SideUser> user_;
};

}  // namespace tet
