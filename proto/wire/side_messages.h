// What goes through the socket beside a stream whose chunks are in shared memory: eight bytes,
// a little-endian number each; and where the client wants them, events. docs/wire_format.md
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace tet {

using SideMessage = std::array<std::byte, 8>;

/// Events that are longer stay in the stream. Those of chunks in shared memory have a hundred.
inline constexpr std::size_t kMostSideEventBytes = 512;
/// In the place of an event: the next one is in the stream. No event begins with such a byte.
inline constexpr std::array<std::byte, 1> kNextIsInStream{};

/// The ending of the socket file beside that of gRPC.
inline constexpr char kSideSocketEnding[] = ".memory";

inline SideMessage side_message(std::uint64_t number) noexcept {
  SideMessage message{};
  for (std::size_t i = 0; i < message.size(); ++i) {
    message[i] = static_cast<std::byte>(number >> (8 * i));
  }
  return message;
}

inline std::uint64_t side_number(const SideMessage& message) noexcept {
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < message.size(); ++i) {
    number |= std::to_integer<std::uint64_t>(message[i]) << (8 * i);
  }
  return number;
}

}  // namespace tet
