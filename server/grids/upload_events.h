// What an upload waits for before its next turn.
#pragma once

#include <atomic>

namespace tet {

/// Events of one upload: who waits for them, and which are still to come. Each is known by its
/// name and not by their number, as whoever gives up must know that nobody works on the piece.
/// Thread-safe.
class UploadEvents {
 public:
  enum Event : unsigned { kMessage = 1, kWritten = 2, kDigested = 4 };

  /// The next turn comes when all of `events` have happened; there is at least one.
  void await(unsigned events) noexcept { awaited_.store(events); }
  /// Whether it was the last, so that it is the caller's turn.
  bool happened(Event event) noexcept { return awaited_.fetch_and(~event) == event; }
  /// Has the turn where the message is all that is awaited: it is awaited no more. Else nothing
  /// changes, and this is false.
  bool give_up() noexcept {
    unsigned only_a_message = kMessage;
    return awaited_.compare_exchange_strong(only_a_message, kGivenUp);
  }

 private:
  static constexpr unsigned kGivenUp = 8;  ///< never happens

  std::atomic<unsigned> awaited_{0};
};

}  // namespace tet
