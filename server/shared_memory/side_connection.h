// A client's end of shared memory: one connection, for one stream at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
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
  /// Hands the client its memory; from now on `user` is told what it says. False where the
  /// client has not even taken what it was sent before, or does not take this.
  bool hand_over(const SealedMemory& memory, std::weak_ptr<SideUser> user);
  /// Tells the client something, in this order. False where it does not take that at once.
  bool tell(std::span<const std::byte> message) noexcept;
  /// The memory has no user any more. A client that says anything before it is handed memory
  /// again is listened to no longer.
  void take_back() noexcept;
  /// Ends the connection; what was sent arrives all the same.
  void close() noexcept;
  /// Whether nobody takes what the client sends any more.
  bool is_over() noexcept;

  /// Takes what the client has sent; false where there is nothing more to come. The port's.
  bool take();

 private:
  std::shared_ptr<SideUser> user();
  bool take_messages();

  const Descriptor socket_;
  const std::string token_;
  std::mutex mutex_;
  std::weak_ptr<SideUser> user_;
  bool over_ = false;
};

}  // namespace tet
