#include "core/vdb/decoder/await_order.h"

#include <csignal>
#include <sched.h>
#include <sys/syscall.h>
#include <unistd.h>
#include <utility>

#include "core/vdb/decoder/decode_order.h"
#include "core/vdb/decoder/sandbox.h"

namespace tet {
namespace {

/// A copy that is the parent's child, not ours: who gives it orders must be able to await its
/// end, and it ends with that thread as we do. The C library knows nothing of it, which only
/// matters to threads and to raise().
pid_t copy_process() {
  return static_cast<pid_t>(::syscall(SYS_clone, CLONE_PARENT | SIGCHLD, 0, 0, 0, 0));
}

/// What the copy has to do again: a copy inherits neither the socket nor its end.
bool begin_as_copy(Descriptor own_socket, int socket) {
  return ::dup2(own_socket.number(), socket) == socket && enter_custody().ok() &&
         send_ready(socket);
}

/// True in both, if there are two.
bool become_two(Descriptor socket_of_copy, int socket) {
  const pid_t copy = copy_process();
  if (copy == 0) return begin_as_copy(std::move(socket_of_copy), socket);
  return copy > 0 && send_copied(socket, copy);
}

}  // namespace

std::optional<ReceivedOrder> await_order(int socket) {
  while (true) {
    ReceivedWish wish = receive_wish(socket);
    if (auto* const order = std::get_if<ReceivedOrder>(&wish)) return std::move(*order);
    auto* const copy = std::get_if<ReceivedCopyWish>(&wish);
    // What is copied again and again loads for all of them. Without OpenVDB a copy says why.
    if (copy != nullptr) (void)prepare_openvdb();
    if (copy == nullptr || !become_two(std::move(copy->socket), socket)) return std::nullopt;
  }
}

}  // namespace tet
