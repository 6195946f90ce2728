#include "server/shared_memory/side_connection.h"

#include <span>
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
    user_ = std::move(user);
  }
  return send_packet(socket_, side_message(memory.bytes().size()), memory.descriptor());
}

void SideConnection::close() noexcept {
  {
    const std::lock_guard lock(mutex_);
    user_.reset();
  }
  ::shutdown(socket_.number(), SHUT_RDWR);
}

bool SideConnection::take() {
  std::shared_ptr<SideUser> user;
  {
    const std::lock_guard lock(mutex_);
    user = user_.lock();
  }
  for (int i = 0; i < kMostAtOnce; ++i) {
    SideMessage message{};
    const Packet packet = take_packet(socket_, message);
    if (packet == Packet::kNone) return true;
    if (packet == Packet::kTaken && user != nullptr) {
      user->acknowledged(side_number(message));
      continue;
    }
    // Whoever has no memory has nothing to say.
    if (user != nullptr) user->ended();
    return false;
  }
  return true;
}

}  // namespace tet
