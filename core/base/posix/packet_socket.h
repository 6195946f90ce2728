// Short messages between two processes of one host, with an open file beside one of them.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <sys/types.h>

#include "core/base/posix/descriptor.h"

namespace tet {

/// Listens on a socket file (SOCK_SEQPACKET), never waiting. None is open where that fails, and
/// `errno` tells why.
Descriptor listen_for_packets(const std::string& path, int backlog) noexcept;

/// The next connection that waits there, never waiting; none is open where there is none, and
/// `errno` tells why.
Descriptor accept_packets(const Descriptor& listener) noexcept;

/// Connects, never waiting. None is open where nobody listens or the queue is full.
Descriptor connect_for_packets(const std::string& path) noexcept;

/// The user at the other end; nothing where the system does not tell.
std::optional<uid_t> user_of_peer(const Descriptor& socket) noexcept;

/// Sends a message, and with it `passed` where that is open, never waiting. False where it
/// could not be sent whole.
bool send_packet(const Descriptor& socket,
                 std::span<const std::byte> message,
                 const Descriptor& passed) noexcept;
bool send_packet(const Descriptor& socket, std::span<const std::byte> message) noexcept;

/// Whether the other end has not yet taken all that was sent to it.
bool has_untaken(const Descriptor& socket) noexcept;
/// Whether nothing has come, and the other end is there.
bool is_quiet(const Descriptor& socket) noexcept;

enum class Packet { kTaken, kNone, kEnd };

/// Takes the next message, never waiting. Files that came with it are closed. kEnd where there
/// are no more, or it is not as long as `message`.
Packet take_packet(const Descriptor& socket, std::span<std::byte> message) noexcept;

/// Takes the next message into the beginning of `message`, and says how long it is, never
/// waiting. Files that came with it are closed. kEnd where there are no more, or it is longer.
Packet take_any_packet(const Descriptor& socket,
                       std::span<std::byte> message,
                       std::size_t& size) noexcept;
/// Waits for that for `patience` at most, and no longer than until `stop`, a descriptor or -1,
/// can be read.
Packet await_any_packet(const Descriptor& socket,
                        std::span<std::byte> message,
                        std::size_t& size,
                        std::chrono::milliseconds patience,
                        int stop = -1) noexcept;

/// Waits for the next message for `patience` at most, and no longer than until `stop`, a
/// descriptor or -1, can be read. Takes the file that came with the message into `passed`, if
/// it is one. False where none came or it is not as long as `message`.
bool await_packet(const Descriptor& socket,
                  std::span<std::byte> message,
                  std::chrono::milliseconds patience,
                  Descriptor& passed,
                  int stop = -1) noexcept;

}  // namespace tet
