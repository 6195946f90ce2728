// One connection's bytes, plain or over TLS, without ever waiting.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>

#include <absl/strings/string_view.h>
#include <openssl/ssl.h>

#include "core/base/posix/descriptor.h"
#include "server/rpc/forwarded.h"

namespace tet {

struct SslFree {
  void operator()(SSL* ssl) const noexcept { SSL_free(ssl); }
};
using SslSession = std::unique_ptr<SSL, SslFree>;

enum class Io {
  kDone,       ///< some bytes went
  kWaitRead,   ///< when the socket is readable, again
  kWaitWrite,  ///< when it is writable, again
  kClosed,     ///< by the other side, or it broke
};

/// Not thread-safe.
class HttpSocket {
 public:
  /// `ssl` is null where the port is plain.
  HttpSocket(Descriptor descriptor, SslSession ssl, std::string peer);

  int number() const noexcept { return descriptor_.number(); }

  /// Goes on with the handshake of TLS; done at once without.
  Io handshake();
  /// Fills the beginning of `into` with what has come; says in `got` how many bytes that are.
  Io read(std::span<char> into, std::size_t& got);
  /// Says in `written` how many of `bytes` were taken; `more` tells that others follow at once.
  Io write(absl::string_view bytes, bool more, std::size_t& written);
  /// How many bytes were written, and not acknowledged by the other side's kernel yet; of TLS
  /// those that it makes of them.
  std::size_t unacknowledged() const noexcept;
  /// Tells the other side that nothing more comes, while it may still send.
  void end_writing() noexcept;

  /// Who is at the other end; with the certificate's subject once the handshake is done.
  const ForwardedPeer& peer() const noexcept { return peer_; }

 private:
  Io failed(int returned) noexcept;

  Descriptor descriptor_;
  SslSession ssl_;
  ForwardedPeer peer_;
};

}  // namespace tet
