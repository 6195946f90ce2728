// A decoder that a hostile file has taken over. What it does is its name's ending:
//   decoder.segfault, decoder.hang, ...
// One that hangs over an order says so first: its number is in decoder.hang.hangs
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <sched.h>
#include <string>
#include <string_view>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <thread>
#include <unistd.h>
#include <variant>
#include <vector>

#include "core/base/failure_name.h"
#include "core/vdb/decoder/await_order.h"
#include "core/vdb/decoder/decode_order.h"
#include "core/vdb/decoder/decoder_protocol.h"
#include "core/vdb/decoder/sandbox.h"
#include "core/vdb/decoder/sealed_block.h"
#include "tests/core/vdb/hanging_decoder.h"

namespace tet {
namespace {

/// An order, and what came with it.
struct Taken {
  const ReceivedOrder& received;

  int result() const { return received.result.number(); }
  int file() const { return received.file.number(); }
  void write(std::string_view bytes) const {
    if (::write(result(), bytes.data(), bytes.size()) < 0) ::_exit(9);
  }
  void answer(const absl::Status& status = absl::OkStatus()) const {
    send_answer(kDecoderSocket, status);
  }
  void sandbox() const {
    const absl::Status safe =
        enter_sandbox(received.order.limits, kDecoderSocket, file(), result());
    if (!safe.ok()) ::_exit(8);
  }
  absl::Status decode() const { return carry_out(received.order, file(), result()); }
};

[[noreturn]] void sleep_for_ever() {
  while (true) std::this_thread::sleep_for(std::chrono::hours(1));
}

std::string g_program;

[[noreturn]] void hang() {
  std::ofstream(g_program + test::kHangs) << ::getpid() << "\n";
  sleep_for_ever();
}

/// Becomes two as a decoder does, and tells nobody of the copy, which hangs.
[[noreturn]] void copy_in_silence(bool ends) {
  ReceivedWish wish = receive_wish(kDecoderSocket);
  const auto* const copy = std::get_if<ReceivedCopyWish>(&wish);
  if (copy == nullptr) ::_exit(9);
  if (::syscall(SYS_clone, CLONE_PARENT | SIGCHLD, 0, 0, 0, 0) == 0) {
    if (::dup2(copy->socket.number(), kDecoderSocket) < 0 || !enter_custody().ok()) ::_exit(9);
    hang();
  }
  if (!ends) sleep_for_ever();
  test::hanging_decoder(g_program);
  ::_exit(0);
}

[[noreturn]] void crash() {
  std::signal(SIGSEGV, SIG_DFL);  // a sanitizer would make an exit code of it
  ::kill(::getpid(), SIGSEGV);
  ::_exit(7);
}

void spin() {
  while (true) asm volatile("");
}

/// Memory until there is no more.
void grow() {
  std::vector<std::vector<char>> hoard;
  while (true) hoard.emplace_back(std::size_t{1} << 20, 'x');
}

void write_without_end(const Taken& taken) {
  const std::string piece(1 << 16, 'x');
  while (true) taken.write(piece);
}

/// Seals what a decoder would not write.
void hand_back(const Taken& taken, std::string_view bytes) {
  taken.write(bytes);
  if (!seal_memory(taken.result()).ok()) ::_exit(9);
  taken.answer();
}

/// Decodes as it should, then changes one byte of the result.
void corrupt(const Taken& taken) {
  const int honest = ::memfd_create("honest", MFD_ALLOW_SEALING);
  if (!carry_out(taken.received.order, taken.file(), honest).ok()) ::_exit(9);
  std::string bytes(static_cast<std::size_t>(::lseek(honest, 0, SEEK_END)), '\0');
  if (::pread(honest, bytes.data(), bytes.size(), 0) < 0) ::_exit(9);
  bytes[32] = static_cast<char>(bytes[32] ^ 0x55);  // of the number of bricks
  hand_back(taken, bytes);
}

void leave_holes(const Taken& taken) {
  if (::ftruncate(taken.result(), 1 << 20) != 0) ::_exit(9);
  hand_back(taken, "");
}

/// Does what the grid's name says, so that one server can have requests of both kinds.
void decode_but_for(const Taken& taken) {
  if (taken.received.order.grid_name == "crash") crash();
  if (taken.received.order.grid_name == "hang") hang();
  taken.sandbox();
  taken.answer(taken.decode());
  ::_exit(0);
}

void speak(std::string_view deed, const Taken& taken) {
  if (deed == "nonsense") ::send(kDecoderSocket, "nonsense", 8, MSG_NOSIGNAL);
  if (deed == "lies") taken.answer(absl::UnauthenticatedError("log in again"));
  if (deed == "shouts") {
    taken.answer(named_failure(
        "GOVERNMENT_SECRET", absl::InvalidArgumentError("\x1b[2J\n" + std::string(2000, 'A'))));
  }
}

void hand_back_nonsense(std::string_view deed, const Taken& taken) {
  if (deed == "unsealed") {
    taken.write("data");
    taken.answer();
  }
  if (deed == "empty") hand_back(taken, "");
  if (deed == "short") hand_back(taken, "tet-vol\n");
  if (deed == "holes") leave_holes(taken);
  if (deed == "corrupt") corrupt(taken);
}

void end_badly(std::string_view deed) {
  if (deed == "segfault") crash();
  if (deed == "hang") hang();
  if (deed == "exit") ::_exit(5);
  if (deed == "close") {
    ::close(kDecoderSocket);
    sleep_for_ever();
  }
}

/// Opens a file once it may no longer, on a thread that was there before the sandbox.
void open_on_an_earlier_thread(const Taken& taken) {
  std::atomic<bool> safe = false;
  std::thread accomplice([&] {
    safe.wait(false);  // asleep, as the threads of libraries are
    ::open("/etc/passwd", O_RDONLY);
    ::_exit(6);
  });
  taken.sandbox();
  safe = true;
  safe.notify_all();
  accomplice.join();
}

/// Four threads that are still starting when the sandbox is entered, as those of libraries may
/// be: they do what they will never do again, and then sleep.
void decode_beside_starting_threads(const Taken& taken) {
  static std::atomic<bool> never = false;
  for (int i = 0; i < 4; ++i) {
    std::thread([] {
      constexpr int kCallsAtTheStart = 2000;
      cpu_set_t processors;
      for (int call = 0; call < kCallsAtTheStart; ++call) {
        ::sched_getaffinity(0, sizeof processors, &processors);
      }
      never.wait(false);
    }).detach();
  }
  taken.sandbox();
  taken.answer(taken.decode());
  ::_exit(0);
}

void take_too_much(std::string_view deed, const Taken& taken) {
  if (deed == "starting") decode_beside_starting_threads(taken);
  if (deed == "accomplice") open_on_an_earlier_thread(taken);
  taken.sandbox();
  if (deed == "spin") spin();
  if (deed == "grow") grow();
  if (deed == "fill") write_without_end(taken);
  if (deed == "open") ::open("/etc/passwd", O_RDONLY);
  if (deed == "socket") ::socket(AF_INET, SOCK_STREAM, 0);
  if (deed == "exec") ::execl("/bin/true", "true", nullptr);
  if (deed == "fork") ::fork();
  if (deed == "thread") std::thread([] {}).join();
  if (deed == "kill") ::kill(::getppid(), 0);
  if (deed == "execute") {
    static_cast<void>(
        ::mmap(nullptr, 4096, PROT_READ | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
  }
  if (deed == "map") {
    static_cast<void>(::mmap(nullptr, 4096, PROT_READ, MAP_SHARED, taken.file(), 0));
  }
  if (deed == "limits") ::syscall(SYS_prlimit64, 0, RLIMIT_AS, nullptr, nullptr);
}

void act(std::string_view deed, const Taken& taken) {
  if (deed == "decode_but_for") decode_but_for(taken);
  speak(deed, taken);
  hand_back_nonsense(deed, taken);
  end_badly(deed);
  take_too_much(deed, taken);
  ::_exit(6);  // whatever it was, it was allowed
}

}  // namespace
}  // namespace tet

int main(int, char** argv) {
  const std::string_view name = argv[0];
  const std::string_view deed = name.substr(name.rfind('.') + 1);
  if (deed == "stillborn") return 1;
  if (deed == "asleep") tet::sleep_for_ever();
  tet::g_program = name;
  tet::prepare_to_carry_out();
  tet::send_ready(tet::kDecoderSocket);
  if (deed == "silent" || deed == "gone") tet::copy_in_silence(deed == "gone");
  const auto received = tet::await_order(tet::kDecoderSocket);
  if (received) tet::act(deed, {*received});
  return 0;
}
