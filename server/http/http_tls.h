// TLS for the HTTP port, with the certificates that the service's own port has.
#pragma once

#include <cstdint>
#include <memory>

#include <openssl/ssl.h>

#include "server/http/http_socket.h"
#include "server/rpc/tls.h"

namespace tet {

/// Begins sessions with the files as they are now. Not thread-safe.
class HttpTls {
 public:
  /// `tls` outlives it.
  explicit HttpTls(ServerTls& tls) : tls_(tls) {}

  /// Returns null when OpenSSL cannot take the files; the log then says so.
  SslSession begin();

 private:
  struct ContextFree {
    void operator()(SSL_CTX* context) const noexcept { SSL_CTX_free(context); }
  };
  using Context = std::unique_ptr<SSL_CTX, ContextFree>;

  static Context context_of(const TlsMaterial& material);

  ServerTls& tls_;
  std::uint64_t generation_ = 0;
  Context context_;
};

}  // namespace tet
