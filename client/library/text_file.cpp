#include "client/library/text_file.h"

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <span>
#include <unistd.h>

#include <absl/strings/str_cat.h>

#include "core/base/posix/descriptor.h"
#include "core/base/posix/transfer.h"

namespace tet {
namespace {

constexpr std::size_t kPieceBytes = 65536;

/// Milliseconds between two looks at a cancellation that shows nothing to poll(2), such as a
/// deadline. Others end the wait at once.
constexpr int kTick = 50;

/// Waits until there is something to be read, or the end. read(2) alone is begun again after a
/// signal, and so would hear of none.
absl::Status wait_for_bytes(int file, const Cancellation& cancellation) {
  for (;;) {
    if (auto status = check_cancelled(cancellation); !status.ok()) return status;
    std::array<pollfd, 2> either{{{file, POLLIN, 0}, {cancellation.descriptor(), POLLIN, 0}}};
    if (::poll(either.data(), either.size(), kTick) > 0 && either[0].revents != 0) {
      return absl::OkStatus();
    }
  }
}

absl::Status cannot_read(const std::string& path) {
  return absl::NotFoundError(absl::StrCat("cannot read ", path, ": ", std::strerror(errno)));
}

absl::StatusOr<std::string> read_all(int file,
                                     const std::string& path,
                                     const Cancellation& cancellation) {
  std::string text;
  for (;;) {
    if (auto status = wait_for_bytes(file, cancellation); !status.ok()) return status;
    const std::size_t end = text.size();
    text.resize(end + kPieceBytes);
    const std::int64_t got = read_what_came(file, std::span(text).subspan(end));
    text.resize(end + static_cast<std::size_t>(got > 0 ? got : 0));
    if (got == 0) return text;
    if (got < 0 && errno != EAGAIN) return cannot_read(path);
  }
}

}  // namespace

absl::StatusOr<std::string> read_text_file(const std::string& path,
                                           const Cancellation& cancellation) {
  // Else open(2) waits for somebody who writes to a pipe.
  const Descriptor file = open_descriptor(path, O_RDONLY | O_NONBLOCK);
  if (!file.is_open()) return cannot_read(path);
  return read_all(file.number(), path, cancellation);
}

absl::StatusOr<std::string> read_text_file(const std::string& path) {
  return read_text_file(path, Cancellation());
}

absl::StatusOr<std::string> read_standard_input(const Cancellation& cancellation) {
  return read_all(STDIN_FILENO, "the standard input", cancellation);
}

absl::Status about(const std::string& path, const absl::Status& status) {
  return {status.code(), absl::StrCat(path, ": ", status.message())};
}

}  // namespace tet
