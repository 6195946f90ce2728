// A place at the mesher that somebody else has.
#pragma once

#include <future>
#include <utility>

#include <absl/status/statusor.h>
#include <gtest/gtest.h>

#include "server/server.h"

namespace tet::test {

/// Waits for the place if need be, and has it until it is let go of.
class HeldPlace {
 public:
  explicit HeldPlace(const Server& server) {
    std::promise<absl::StatusOr<Ticket>> answer;
    auto answered = answer.get_future();
    server.engine().calls.admission().queue_mesh(
        "somebody else", Admission::Clock::time_point::max(),
        [&](absl::StatusOr<Ticket> ticket) { answer.set_value(std::move(ticket)); });
    absl::StatusOr<Ticket> ticket = answered.get();
    EXPECT_TRUE(ticket.ok()) << ticket.status();
    if (ticket.ok()) ticket_ = *std::move(ticket);
  }

  void let_go() { ticket_.reset(); }

 private:
  Ticket ticket_;
};

}  // namespace tet::test
