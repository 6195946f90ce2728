#include "server/shared_memory/side_connection.h"

#include <sys/socket.h>
#include <utility>

#include "core/base/posix/packet_socket.h"
#include "proto/wire/side_messages.h"

namespace tet {

namespace {

/// Messages taken in one go: other connections wait meanwhile.
constexpr int kMostAtOnce = 64;

}  // namespace

bool SideConnection::tell_token() noexcept {
  return send_packet(socket_, std::as_bytes(std::span(token_)));
}

bool SideConnection::hand_over(const SealedMemory& memory, std::weak_ptr<SideUser> user) {
  {
    const std::lock_guard lock(mutex_);
    if (over_ || has_untaken(socket_)) return false;
    user_ = std::move(user);
  }
  return send_packet(socket_, side_message(memory.bytes().size()), memory.descriptor());
}

bool SideConnection::tell(std::span<const std::byte> message) noexcept {
  return send_packet(socket_, message);
}

void SideConnection::take_back() noexcept {
  const std::lock_guard lock(mutex_);
  user_.reset();
}

void SideConnection::close() noexcept {
  take_back();
  ::shutdown(socket_.number(), SHUT_RDWR);
}

/// Without one the connection is over, so that nobody is handed one that is not heeded.
std::shared_ptr<SideUser> SideConnection::user() {
  const std::lock_guard lock(mutex_);
  auto user = user_.lock();
  over_ = over_ || user == nullptr;
  return user;
}

bool SideConnection::is_over() noexcept {
  const std::lock_guard lock(mutex_);
  return over_;
}

bool SideConnection::take() {
  const bool more = take_messages();
  const std::lock_guard lock(mutex_);
  over_ = over_ || !more;
  return more;
}

/// Who is told is asked once a message is here: one that was sent to the next user must not go
/// to the one before.
bool SideConnection::take_messages() {
  for (int i = 0; i < kMostAtOnce; ++i) {
    SideMessage message{};
    const Packet packet = take_packet(socket_, message);
    if (packet == Packet::kNone) return true;
    const std::shared_ptr<SideUser> told = user();
    if (told == nullptr) return false;  // whoever has no memory has nothing to say
    if (packet == Packet::kEnd) {
      told->ended();
      return false;
    }
    told->acknowledged(side_number(message));
  }
  return true;
}

}  // namespace tet
