// Memory for chunks that are on their way to clients, shared by all streams.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>

namespace tet {

/// Blocks of chunks that are made and that the transport has not let go of. A stream asks for a
/// block before it makes a chunk; where there is none it waits, and the clients take turns.
///
/// Two blocks a client may have whatever others hold, and for these an eighth of all is kept.
/// It leaves as much of the rest free as it takes: alone it gets seven sixteenths of all, and
/// ten whose readers take nothing get equal parts, of which an eleventh is free. So whoever
/// comes finds room, and does not wait until others lose their streams.
///
/// Thread safety: any thread may call any member. Leases may outlive the budget: gRPC lets go
/// of blocks when it likes.
class SendBudget {
 public:
  using Clock = std::chrono::steady_clock;

  class Lease;
  using Grant = std::function<void(std::shared_ptr<Lease>)>;

  /// At least two blocks.
  SendBudget(std::uint64_t bytes, std::uint64_t block_bytes);

  /// `recall` has idle memory given up, which is charged here, and is false where there is
  /// none. It is called whenever somebody cannot have what it asks for; to be set before that.
  void recall_with(std::function<bool()> recall) { recall_ = std::move(recall); }

  /// Asks for a block. `grant` is called once: here, or when there is room, on whichever thread
  /// made it.
  void ask(const void* who, const std::string& client, Grant grant);
  /// `bytes` for a client that can do without them: null where they are not to be had now,
  /// where others wait, or where more than half of all would be in use.
  std::shared_ptr<Lease> take(const std::string& client, std::uint64_t bytes);
  /// Forgets what `who` has asked for and not been granted.
  void leave(const void* who);

  /// More than half is in use, beside bytes that nobody uses now: streams should not make
  /// chunks ahead.
  bool is_tight(std::uint64_t idle_bytes) const;
  /// Somebody who has not even two blocks has waited since before `then`.
  bool kept_waiting_since(Clock::time_point then) const;
  std::uint64_t used_bytes() const;

 private:
  struct State;
  std::shared_ptr<Lease> take_now(const std::string& client, std::uint64_t bytes);

  std::shared_ptr<State> state_;
  std::function<bool()> recall_;
};

/// A block's worth of memory, until it is destroyed.
class SendBudget::Lease {
 public:
  Lease(std::shared_ptr<State> state, std::string client, std::uint64_t bytes);
  ~Lease();
  Lease(const Lease&) = delete;
  Lease& operator=(const Lease&) = delete;

  /// Keeps only `bytes` of it.
  void shrink_to(std::uint64_t bytes);

 private:
  std::shared_ptr<State> state_;
  const std::string client_;
  std::uint64_t bytes_;
};

}  // namespace tet
