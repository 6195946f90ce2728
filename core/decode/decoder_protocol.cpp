#include "core/decode/decoder_protocol.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <string_view>
#include <sys/socket.h>

#include <absl/strings/ascii.h>

#include "core/base/failure_name.h"
#include "core/grid/grid_info.h"

namespace tet {
namespace {

constexpr std::uint32_t kReady = 0x74657401;
constexpr std::uint32_t kOrder = 0x74657402;
constexpr std::uint32_t kAnswer = 0x74657403;
constexpr std::size_t kDescriptors = 2;

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
  DecodeLimits limits;
  std::int64_t file_bytes = 0;
  Text<256> file_name;
  Text<kMaxGridNameBytes> grid_name;
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

/// A message's frame for sendmsg and recvmsg, with room for the descriptors.
struct Frame {
  explicit Frame(OrderMessage& message) : data{&message, sizeof(message)} {
    header.msg_iov = &data;
    header.msg_iovlen = 1;
    header.msg_control = control.data();
    header.msg_controllen = control.size();
  }
  iovec data;
  alignas(cmsghdr) std::array<char, CMSG_SPACE(kDescriptors * sizeof(int))> control{};
  msghdr header{};
};

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

std::string printable(std::string text) {
  std::replace_if(
      text.begin(), text.end(),
      [](char c) { return !absl::ascii_isprint(static_cast<unsigned char>(c)); }, '?');
  return text;
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
  message.limits = order.limits;
  message.file_bytes = order.file_bytes;
  message.file_name.set(end_of(order.file_name, message.file_name.bytes.size()));
  message.grid_name.set(order.grid_name);
  Frame frame(message);
  cmsghdr* const control = CMSG_FIRSTHDR(&frame.header);
  control->cmsg_level = SOL_SOCKET;
  control->cmsg_type = SCM_RIGHTS;
  control->cmsg_len = CMSG_LEN(kDescriptors * sizeof(int));
  const std::array<int, kDescriptors> descriptors{file, result};
  std::memcpy(CMSG_DATA(control), descriptors.data(), sizeof(descriptors));
  return ::sendmsg(socket, &frame.header, MSG_NOSIGNAL) == ssize_t{sizeof(message)};
}

std::optional<ReceivedOrder> receive_order(int socket) {
  OrderMessage message;
  Frame frame(message);
  ssize_t size = 0;
  do {
    size = ::recvmsg(socket, &frame.header, MSG_CMSG_CLOEXEC);
  } while (size < 0 && errno == EINTR);
  const cmsghdr* const control = CMSG_FIRSTHDR(&frame.header);
  if (size != ssize_t{sizeof(message)} || message.magic != kOrder || control == nullptr ||
      control->cmsg_len != CMSG_LEN(kDescriptors * sizeof(int))) {
    return std::nullopt;
  }
  std::array<int, kDescriptors> descriptors;
  std::memcpy(descriptors.data(), CMSG_DATA(control), sizeof(descriptors));
  return ReceivedOrder{
      DecodeOrder{message.task, message.limits, message.file_bytes, message.file_name.get(),
                  message.grid_name.get()},
      Descriptor(descriptors[0]), Descriptor(descriptors[1])
  };
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
                      printable(message.message.get()));
  return message.out_of_memory == 1 ? named_failure(kOutOfMemory, std::move(answer)) : answer;
}

}  // namespace tet
