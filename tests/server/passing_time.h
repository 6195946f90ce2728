// Time for calls that wait for their clients, without waiting for it.
#pragma once

#include <chrono>
#include <cstdint>
#include <stop_token>
#include <thread>

#include "server/server.h"
#include "server/streams/mesh_engine.h"

namespace tet::test {

/// While it lives, so many seconds have always passed since whatever a call waits for. A server
/// that gives up after one second gives up whoever is slow because the machine is, too: so a
/// test leaves the limits long, brings a call to where it waits, and then lets time pass. What
/// is being written at that moment has waited as long: it must have more time, or be done.
class PassingTime {
 public:
  PassingTime(const Server& server, std::uint64_t seconds)
      : thread_([&engine = const_cast<MeshEngine&>(server.engine()),
                 ahead = std::chrono::seconds(seconds)](const std::stop_token& stopping) {
          while (!stopping.stop_requested()) {
            engine.check_stalls(Stallable::Clock::now() + ahead);
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
          }
        }) {}

 private:
  std::jthread thread_;
};

}  // namespace tet::test
