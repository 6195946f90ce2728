#include "server/http/http_socket.h"

#include <algorithm>
#include <cerrno>
#include <linux/sockios.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <utility>

#include <absl/strings/string_view.h>
#include <openssl/err.h>

#include "server/rpc/tls.h"

namespace tet {

HttpSocket::HttpSocket(Descriptor descriptor, SslSession ssl, std::string peer)
    : descriptor_(std::move(descriptor)), ssl_(std::move(ssl)) {
  peer_.address = std::move(peer);
  if (ssl_ != nullptr) SSL_set_fd(ssl_.get(), descriptor_.number());
}

Io HttpSocket::handshake() {
  if (ssl_ == nullptr || SSL_is_init_finished(ssl_.get()) == 1) return Io::kDone;
  ERR_clear_error();
  const int returned = SSL_accept(ssl_.get());
  if (returned != 1) return failed(returned);
  if (X509* const certificate = SSL_get0_peer_certificate(ssl_.get())) {
    peer_.subject = subject_of(*certificate);
  }
  return Io::kDone;
}

Io HttpSocket::read(std::span<char> into, std::size_t& got) {
  got = 0;
  if (ssl_ != nullptr) {
    ERR_clear_error();
    const int returned = SSL_read_ex(ssl_.get(), into.data(), into.size(), &got);
    return returned == 1 ? Io::kDone : failed(returned);
  }
  const ssize_t taken = ::recv(descriptor_.number(), into.data(), into.size(), MSG_DONTWAIT);
  got = static_cast<std::size_t>(std::max<ssize_t>(taken, 0));
  if (taken > 0) return Io::kDone;
  const bool later = taken < 0 && (errno == EAGAIN || errno == EINTR);
  return later ? Io::kWaitRead : Io::kClosed;
}

Io HttpSocket::write(absl::string_view bytes, bool more, std::size_t& written) {
  written = 0;
  if (ssl_ != nullptr) {
    ERR_clear_error();
    const int returned = SSL_write_ex(ssl_.get(), bytes.data(), bytes.size(), &written);
    return returned == 1 ? Io::kDone : failed(returned);
  }
  const int flags = MSG_DONTWAIT | MSG_NOSIGNAL | (more ? MSG_MORE : 0);
  const ssize_t sent = ::send(descriptor_.number(), bytes.data(), bytes.size(), flags);
  if (sent >= 0) {
    written = static_cast<std::size_t>(sent);
    return Io::kDone;
  }
  return errno == EAGAIN || errno == EINTR ? Io::kWaitWrite : Io::kClosed;
}

std::size_t HttpSocket::unacknowledged() const noexcept {
  int bytes = 0;
  const bool known = ::ioctl(descriptor_.number(), SIOCOUTQ, &bytes) == 0;
  return known ? static_cast<std::size_t>(std::max(bytes, 0)) : 0;
}

void HttpSocket::end_writing() noexcept {
  if (ssl_ != nullptr && SSL_is_init_finished(ssl_.get()) == 1) SSL_shutdown(ssl_.get());
  ::shutdown(descriptor_.number(), SHUT_WR);
}

Io HttpSocket::failed(int returned) noexcept {
  switch (SSL_get_error(ssl_.get(), returned)) {
    case SSL_ERROR_WANT_READ:
      return Io::kWaitRead;
    case SSL_ERROR_WANT_WRITE:
      return Io::kWaitWrite;
    default:
      return Io::kClosed;
  }
}

}  // namespace tet
