#include "core/base/posix/packet_socket.h"

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <fstream>
#include <optional>
#include <pthread.h>
#include <string>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

#include <gtest/gtest.h>

#include "tests/support/eventually.h"

namespace tet {
namespace {

using namespace std::chrono_literals;

std::atomic<int> g_signals{0};

/// While it lives, SIGUSR1 interrupts whoever waits, and is counted.
class InterruptingSignal {
 public:
  InterruptingSignal() {
    g_signals = 0;
    struct sigaction action {};
    action.sa_handler = [](int) { ++g_signals; };
    EXPECT_EQ(::sigaction(SIGUSR1, &action, &old_), 0);
  }
  ~InterruptingSignal() { ::sigaction(SIGUSR1, &old_, nullptr); }
  InterruptingSignal(const InterruptingSignal&) = delete;
  InterruptingSignal& operator=(const InterruptingSignal&) = delete;

 private:
  struct sigaction old_ {};
};

struct Pair {
  Descriptor ours, theirs;

  Pair() {
    std::array<int, 2> ends{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()), 0);
    ours = Descriptor(ends[0]);
    theirs = Descriptor(ends[1]);
  }
};

/// A thread that calls `wait`, asleep by now.
class Waiting {
 public:
  template <class Wait>
  explicit Waiting(const Wait& wait)
      : thread_([this, wait] {
          number_ = ::gettid();
          wait();
        }) {
    EXPECT_TRUE(test::eventually([this] { return number_ != 0 && is_asleep(); }));
  }

  /// Interrupts it a few times while it sleeps, has the message sent, and awaits its end.
  void interrupt_and_send(const Descriptor& theirs) {
    constexpr int kSignals = 3;
    for (int sent = 0; sent < kSignals; ++sent) {
      ::pthread_kill(thread_.native_handle(), SIGUSR1);
      EXPECT_TRUE(test::eventually([&] { return g_signals > sent; }));
    }
    const std::array<std::byte, 1> message{std::byte{7}};
    EXPECT_TRUE(send_packet(theirs, message));
    thread_.join();
  }

 private:
  bool is_asleep() const {
    std::ifstream status("/proc/self/task/" + std::to_string(number_) + "/stat");
    std::string text;
    return std::getline(status, text) && text.at(text.rfind(')') + 2) == 'S';
  }

  std::atomic<pid_t> number_{0};
  std::thread thread_;
};

TEST(PacketSocket, AwaitsAMessageThoughSignalsCome) {
  const InterruptingSignal signal;
  const Pair pair;
  std::array<std::byte, 1> taken{};
  bool came = false;
  Waiting waiting([&] {
    Descriptor passed;
    came = await_packet(pair.ours, taken, 1h, passed);
  });
  waiting.interrupt_and_send(pair.theirs);
  EXPECT_TRUE(came);
  EXPECT_EQ(taken[0], std::byte{7});
}

TEST(PacketSocket, AwaitsAMessageOfAnySizeThoughSignalsCome) {
  const InterruptingSignal signal;
  const Pair pair;
  std::array<std::byte, 1> taken{};
  std::optional<Packet> packet;
  Waiting waiting([&] {
    std::size_t size = 0;
    packet = await_any_packet(pair.ours, taken, size, 1h);
  });
  waiting.interrupt_and_send(pair.theirs);
  EXPECT_EQ(packet, Packet::kTaken);
}

TEST(PacketSocket, GivesUpAfterItsPatience) {
  const Pair pair;
  std::array<std::byte, 1> taken{};
  Descriptor passed;
  EXPECT_FALSE(await_packet(pair.ours, taken, 1ms, passed));
}

}  // namespace
}  // namespace tet
