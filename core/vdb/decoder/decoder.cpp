#include "core/vdb/decoder/decoder.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <optional>
#include <poll.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#include <utility>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/base/failure_name.h"
#include "core/vdb/decoder/spawn.h"
#include "core/vdb/parts/find_decoder.h"

namespace tet {
namespace {

using Clock = std::chrono::steady_clock;

/// How soon a cancellation is seen.
constexpr std::chrono::milliseconds kPollInterval{20};

absl::Status unavailable(const std::string& message) {
  return named_failure("DECODER_UNAVAILABLE", absl::UnavailableError(message));
}

absl::Status undecodable(std::string_view name,
                         const std::string& file,
                         const std::string& why) {
  return named_failure(name, absl::InvalidArgumentError(
                                 absl::StrFormat("'%s' could not be decoded: %s", file, why)));
}

absl::Status timed_out(const DecodeOrder& order, Clock::duration limit) {
  return undecodable("DECODER_TIMEOUT", order.file_name,
                     absl::StrFormat("it took longer than %.3g s",
                                     std::chrono::duration<double>(limit).count()));
}

/// Its own limits end it with other signals, and it can send none: somebody else did, most
/// likely the system, for want of memory that others may have taken.
absl::Status killed(const DecodeOrder& order) {
  return named_failure("DECODER_MEMORY", absl::ResourceExhaustedError(absl::StrFormat(
                                             "'%s' was not decoded: the decoder was killed, as "
                                             "the system does where memory is short",
                                             order.file_name)));
}

absl::Status gone() { return unavailable("a decoder ended before it had anything to do"); }

struct SocketPair {
  Descriptor ours, theirs;
};

absl::StatusOr<SocketPair> make_sockets() {
  std::array<int, 2> ends;
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    return unavailable(
        absl::StrCat("there is no socket for a decoder: ", std::strerror(errno)));
  }
  return SocketPair{Descriptor(ends[0]), Descriptor(ends[1])};
}

/// Ends the process if it has not ended, and tells how it did.
siginfo_t end_process(const Descriptor& process) {
  ::syscall(SYS_pidfd_send_signal, process.number(), SIGKILL, nullptr, 0);
  siginfo_t how{};
  while (::waitid(P_PIDFD, static_cast<id_t>(process.number()), &how, WEXITED) != 0 &&
         errno == EINTR) {
  }
  return how;
}

/// Milliseconds to wait, never so long that a cancellation waits too.
int poll_timeout(Clock::time_point deadline) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
  return static_cast<int>(
      std::clamp(left, std::chrono::milliseconds(0), kPollInterval).count());
}

/// Whether the process ends of itself before it has to: its socket closes a little earlier.
bool ends_by_itself(const Descriptor& process,
                    Clock::time_point last,
                    const std::function<bool()>& cancelled) {
  pollfd end{process.number(), POLLIN, 0};
  while (::poll(&end, 1, poll_timeout(last)) <= 0) {
    if (Clock::now() >= last || (cancelled && cancelled())) return false;
  }
  return true;
}

}  // namespace

absl::StatusOr<Decoder> Decoder::start(const DecoderProgram& program) {
  const absl::StatusOr<std::string> path = find_decoder(program.path);
  if (!path.ok()) return path.status();
  absl::StatusOr<SocketPair> sockets = make_sockets();
  if (!sockets.ok()) return sockets.status();
  const absl::StatusOr<pid_t> pid =
      spawn(*path, program.environment, sockets->theirs.number(), kDecoderSocket);
  if (!pid.ok()) return pid.status();
  return watch(*pid, std::move(sockets->ours), program.patience);
}

absl::StatusOr<Decoder> Decoder::copy(const std::function<bool()>& cancelled) {
  absl::StatusOr<SocketPair> sockets = make_sockets();
  if (!sockets.ok()) return sockets.status();
  if (!send_copy_wish(socket_.number(), sockets->theirs.number())) {
    end_with_copies();
    return gone();
  }
  sockets->theirs.close();
  const Event event = wait(Clock::now() + patience_.start, cancelled);
  const std::optional<pid_t> pid =
      event == Event::kMessage ? receive_copied(socket_.number()) : std::nullopt;
  if (pid) return watch(*pid, std::move(sockets->ours), patience_);
  end_with_copies();
  if (event == Event::kCancelled) return absl::CancelledError("cancelled");
  return gone();
}

/// There may be a copy that nobody has been told of. It is a child of this process, too, and in
/// the group that this one has led since it was started.
void Decoder::end_with_copies() {
  if (!process_.is_open()) return;  // its number may be another's
  ::kill(-pid_, SIGKILL);
  siginfo_t how{};
  while (::waitid(P_PGID, static_cast<id_t>(pid_), &how, WEXITED) == 0 || errno == EINTR) {
  }
  process_.close();
}

/// Takes over a child of this thread.
absl::StatusOr<Decoder> Decoder::watch(pid_t pid,
                                       Descriptor socket,
                                       const DecoderPatience& patience) {
  // The system call is made by its number, as glibc 2.36's header for it is for C only.
  Descriptor process(static_cast<int>(::syscall(SYS_pidfd_open, pid, 0)));
  if (process.is_open()) return Decoder(pid, std::move(process), std::move(socket), patience);
  const std::string error = std::strerror(errno);
  ::kill(pid, SIGKILL);
  ::waitpid(pid, nullptr, 0);
  return unavailable(absl::StrCat("a decoder cannot be watched: ", error));
}

Decoder::~Decoder() {
  if (process_.is_open()) end_process(process_);
}

Decoder::Event Decoder::wait(Clock::time_point deadline,
                             const std::function<bool()>& cancelled) const {
  while (true) {
    // The socket also tells the end of the process: it holds the other end alone.
    pollfd socket{socket_.number(), POLLIN, 0};
    if (::poll(&socket, 1, poll_timeout(deadline)) > 0) return Event::kMessage;
    if (cancelled && cancelled()) return Event::kCancelled;
    if (Clock::now() >= deadline) return Event::kDeadline;
  }
}

absl::Status Decoder::wait_until_ready(const std::function<bool()>& cancelled) {
  const Event event = wait(Clock::now() + patience_.start, cancelled);
  if (event == Event::kCancelled) return absl::CancelledError("cancelled");
  if (event == Event::kMessage && receive_ready(socket_.number())) return absl::OkStatus();
  return unavailable("the decoder program does not start");
}

absl::StatusOr<SealedBlock> Decoder::decode(const DecodeOrder& order,
                                            int file,
                                            const DecodeEnd& end) {
  const absl::StatusOr<Descriptor> result = make_sealable_memory();
  if (!result.ok()) return result.status();
  if (!send_order(socket_.number(), order, file, result->number())) return gone();
  switch (wait(Clock::now() + end.limit, end.cancelled)) {
    case Event::kDeadline:
      return timed_out(order, end.limit);
    case Event::kCancelled:
      return absl::CancelledError("cancelled");
    case Event::kMessage:
      break;
  }
  const std::optional<absl::Status> answer = receive_answer(socket_.number());
  if (!answer) return explain_death(order, end.cancelled);
  if (!answer->ok()) return *answer;
  absl::StatusOr<SealedBlock> block =
      SealedBlock::map(result->number(), order.limits.result_bytes);
  if (absl::IsInvalidArgument(block.status())) {
    return undecodable("DECODER_RESULT", order.file_name,
                       std::string(block.status().message()));
  }
  return block;
}

absl::Status Decoder::explain_death(const DecodeOrder& order,
                                    const std::function<bool()>& cancelled) {
  const bool ended = ends_by_itself(process_, Clock::now() + patience_.last_moment, cancelled);
  const siginfo_t how = end_process(process_);
  process_.close();
  if (!ended) {
    return undecodable("DECODER_CRASHED", order.file_name,
                       "the decoder did not answer as a decoder does");
  }
  if (how.si_code == CLD_EXITED) {
    return undecodable(
        "DECODER_CRASHED", order.file_name,
        absl::StrFormat("the decoder ended with %d and no answer", how.si_status));
  }
  if (how.si_status == SIGXCPU) {
    return undecodable(
        "DECODER_TIMEOUT", order.file_name,
        absl::StrFormat("it took more than %d s of processor time", order.limits.cpu_seconds));
  }
  if (how.si_status == SIGXFSZ) {
    return undecodable(
        "DECODER_MEMORY", order.file_name,
        absl::StrFormat("the result has more than %d bytes", order.limits.result_bytes));
  }
  if (how.si_status == SIGKILL) return killed(order);
  return undecodable("DECODER_CRASHED", order.file_name,
                     absl::StrFormat("the decoder crashed (signal %d)", how.si_status));
}

}  // namespace tet
