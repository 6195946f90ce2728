// Waiting for what another thread or process does.
#pragma once

#include <chrono>
#include <thread>

namespace tet::test {

/// How long a test waits for what has to come. It is no claim about speed: it only ends tests
/// that would wait for ever, and must be long enough for a machine that compiles beside them:
/// of two dozen busy processes a server's jobs, which give way to all others, get a
/// four-hundredth.
constexpr std::chrono::minutes kGenerousEnd{10};

/// Whether `condition` comes to hold. Give it an event that is bound to come, never a sleep.
template <class Condition>
bool eventually(const Condition& condition) {
  const auto end = std::chrono::steady_clock::now() + kGenerousEnd;
  while (!condition()) {
    if (std::chrono::steady_clock::now() >= end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

}  // namespace tet::test
