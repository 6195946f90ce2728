#include "core/vdb/decoder/decoder_protocol.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <span>
#include <string_view>
#include <sys/socket.h>
#include <utility>

#include "core/base/failure_name.h"
#include "core/base/printable.h"
#include "core/volume/grid_info.h"

namespace tet {
namespace {

constexpr std::uint32_t kReady = 0x74657401;
constexpr std::uint32_t kOrder = 0x74657402;
constexpr std::uint32_t kAnswer = 0x74657403;
constexpr std::uint32_t kCopyWish = 0x74657404;
constexpr std::uint32_t kCopied = 0x74657405;
constexpr std::size_t kMostDescriptors = 2;

/// The only name of a failure that a decoder may give.
constexpr std::string_view kOutOfMemory = "DECODER_MEMORY";

/// Text of at most `kSize` bytes, in a message of one size.
template <std::size_t kSize>
struct Text {
  std::uint32_t size = 0;
  std::array<char, kSize> bytes{};

  void set(std::string_view text) {
    size = static_cast<std::uint32_t>(std::min(text.size(), kSize));
    std::copy_n(text.begin(), size, bytes.begin());
  }
  std::string get() const { return {bytes.data(), std::min<std::size_t>(size, kSize)}; }
};

struct OrderMessage {
  std::uint32_t magic = kOrder;
  DecodeTask task = DecodeTask::kVolume;
  std::uint32_t component = 0;
  std::uint32_t needs_openvdb = 1;
  DecodeLimits limits;
  std::int64_t file_bytes = 0;
  Text<256> file_name;
  Text<kMaxGridNameBytes> grid_name;
};

struct CopiedMessage {
  std::uint32_t magic = kCopied;
  std::int32_t copy = 0;
};

struct AnswerMessage {
  std::uint32_t magic = kAnswer;
  std::uint32_t code = 0;
  std::uint32_t out_of_memory = 0;
  Text<kMaxFailureBytes> message;
};

template <class Message>
bool send_message(int socket, const Message& message) {
  return ::send(socket, &message, sizeof(message), MSG_NOSIGNAL) == ssize_t{sizeof(message)};
}

/// Room for one byte more tells a longer message apart.
template <class Message>
bool receive_message(int socket, Message& message) {
  std::array<char, sizeof(Message) + 1> bytes;
  ssize_t size = 0;
  do {
    size = ::recv(socket, bytes.data(), bytes.size(), MSG_DONTWAIT);
  } while (size < 0 && errno == EINTR);
  if (size != ssize_t{sizeof(Message)}) return false;
  std::memcpy(&message, bytes.data(), sizeof(Message));
  return true;
}

/// A message's frame for sendmsg and recvmsg, with room for descriptors.
struct Frame {
  template <class Message>
  explicit Frame(Message& message) : data{&message, sizeof(message)} {
    header.msg_iov = &data;
    header.msg_iovlen = 1;
    header.msg_control = control.data();
    header.msg_controllen = control.size();
  }

  void attach(std::span<const int> descriptors) {
    header.msg_controllen = CMSG_SPACE(descriptors.size_bytes());
    cmsghdr* const first = CMSG_FIRSTHDR(&header);
    first->cmsg_level = SOL_SOCKET;
    first->cmsg_type = SCM_RIGHTS;
    first->cmsg_len = CMSG_LEN(descriptors.size_bytes());
    std::memcpy(CMSG_DATA(first), descriptors.data(), descriptors.size_bytes());
  }

  /// Takes the descriptors that came; the rest are closed.
  std::array<Descriptor, kMostDescriptors> descriptors() const {
    std::array<Descriptor, kMostDescriptors> came;
    const cmsghdr* const first = CMSG_FIRSTHDR(&header);
    if (first == nullptr) return came;
    for (std::size_t i = 0; CMSG_LEN((i + 1) * sizeof(int)) <= first->cmsg_len; ++i) {
      int number = -1;
      std::memcpy(&number, CMSG_DATA(first) + i * sizeof(int), sizeof(int));
      came[i] = Descriptor(number);
    }
    return came;
  }

  iovec data;
  alignas(cmsghdr) std::array<char, CMSG_SPACE(kMostDescriptors * sizeof(int))> control{};
  msghdr header{};
};

/// Sends a message with descriptors.
template <class Message>
bool send_with(int socket, Message message, std::span<const int> descriptors) {
  Frame frame(message);
  frame.attach(descriptors);
  return ::sendmsg(socket, &frame.header, MSG_NOSIGNAL) == ssize_t{sizeof(message)};
}

bool may_answer(std::uint32_t code) {
  switch (static_cast<absl::StatusCode>(code)) {
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kNotFound:
    case absl::StatusCode::kFailedPrecondition:
    case absl::StatusCode::kResourceExhausted:
      return true;
    default:
      return false;
  }
}

/// The end of a long name says more than its beginning.
std::string_view end_of(std::string_view name, std::size_t size) {
  return name.substr(name.size() - std::min(name.size(), size));
}

}  // namespace

bool send_ready(int socket) { return send_message(socket, kReady); }

bool receive_ready(int socket) {
  std::uint32_t ready = 0;
  return receive_message(socket, ready) && ready == kReady;
}

bool send_order(int socket, const DecodeOrder& order, int file, int result) {
  OrderMessage message;
  message.task = order.task;
  message.component = order.component;
  message.needs_openvdb = order.needs_openvdb ? 1 : 0;
  message.limits = order.limits;
  message.file_bytes = order.file_bytes;
  message.file_name.set(end_of(order.file_name, message.file_name.bytes.size()));
  message.grid_name.set(order.grid_name);
  return send_with(socket, message, std::array{file, result});
}

bool send_copy_wish(int socket, int socket_of_copy) {
  return send_with(socket, kCopyWish, std::array{socket_of_copy});
}

bool send_copied(int socket, pid_t copy) {
  return send_message(socket, CopiedMessage{kCopied, copy});
}

std::optional<pid_t> receive_copied(int socket) {
  CopiedMessage message;
  if (!receive_message(socket, message) || message.magic != kCopied) return std::nullopt;
  return message.copy;
}

ReceivedWish receive_wish(int socket) {
  OrderMessage message;
  Frame frame(message);
  ssize_t size = 0;
  do {
    size = ::recvmsg(socket, &frame.header, MSG_CMSG_CLOEXEC);
  } while (size < 0 && errno == EINTR);
  auto [first, second] = frame.descriptors();
  if (size == ssize_t{sizeof(kCopyWish)} && message.magic == kCopyWish && first.is_open()) {
    return ReceivedCopyWish{std::move(first)};
  }
  if (size != ssize_t{sizeof(message)} || message.magic != kOrder || !second.is_open()) {
    return std::monostate();
  }
  return ReceivedOrder{
      DecodeOrder{message.task, message.limits, message.file_bytes, message.file_name.get(),
                  message.grid_name.get(), message.component, message.needs_openvdb != 0},
      std::move(first), std::move(second)};
}

bool send_answer(int socket, const absl::Status& answer) {
  AnswerMessage message;
  message.code = static_cast<std::uint32_t>(answer.code());
  message.out_of_memory = failure_name(answer) == kOutOfMemory ? 1 : 0;
  const absl::string_view text = answer.message();
  message.message.set({text.data(), text.size()});
  return send_message(socket, message);
}

std::optional<absl::Status> receive_answer(int socket) {
  AnswerMessage message;
  if (!receive_message(socket, message) || message.magic != kAnswer) return std::nullopt;
  if (message.code == 0) return absl::OkStatus();
  if (!may_answer(message.code)) return std::nullopt;
  absl::Status answer(static_cast<absl::StatusCode>(message.code),
                      printable(message.message.get(), kMaxFailureBytes));
  return message.out_of_memory == 1 ? named_failure(kOutOfMemory, std::move(answer)) : answer;
}

}  // namespace tet
