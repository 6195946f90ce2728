#include "server/meshing/send_budget.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "core/base/fair_queue.h"

namespace tet {

namespace {

/// A stream goes on with a block that is sent and one that is made meanwhile.
constexpr std::uint64_t kFewBlocks = 2;
/// An eighth is for clients with no more.
constexpr std::uint64_t kKeptForFew = 8;

}  // namespace

struct SendBudget::State : std::enable_shared_from_this<State> {
  struct Asked {
    const void* who = nullptr;
    std::string client;
    Clock::time_point since;
    Grant grant;
  };
  struct Granted {
    Grant grant;
    std::shared_ptr<Lease> lease;
  };

  State(std::uint64_t total, std::uint64_t block)
      : bytes(std::max(total, 2 * block)), block_bytes(block) {}

  std::uint64_t held_by(const std::string& client) const {
    const auto found = of_client.find(client);
    return found == of_client.end() ? 0 : found->second;
  }

  /// Whether a client may have one more block.
  bool may_have(const std::string& client) const {
    if (used + block_bytes > bytes) return false;
    const std::uint64_t held = held_by(client) + block_bytes, left = bytes - used - block_bytes;
    return has_few(client) || held + bytes / kKeptForFew <= left;
  }

  bool has_few(const std::string& client) const {
    return held_by(client) < kFewBlocks * block_bytes;
  }

  void give_back(const std::string& client, std::uint64_t given) {
    std::vector<Granted> granted;
    {
      const std::lock_guard lock(mutex);
      used -= given;
      const auto found = of_client.find(client);
      if ((found->second -= given) == 0) of_client.erase(found);
      granted = grant_waiting();
    }
    for (Granted& next : granted) next.grant(std::move(next.lease));
  }

  std::vector<Granted> grant_waiting() {
    std::vector<Granted> granted;
    while (auto next = waiting.take([&](const auto& client) { return may_have(client); })) {
      used += block_bytes;
      of_client[next->client] += block_bytes;
      granted.push_back(
          {std::move(next->grant),
           std::make_shared<Lease>(shared_from_this(), next->client, block_bytes)});
    }
    return granted;
  }

  const std::uint64_t bytes, block_bytes;
  mutable std::mutex mutex;  ///< guards all below; never held while somebody is granted
  std::uint64_t used = 0;
  std::map<std::string, std::uint64_t> of_client;  ///< none is 0
  FairQueue<Asked> waiting;
};

SendBudget::SendBudget(std::uint64_t bytes, std::uint64_t block_bytes)
    : state_(std::make_shared<State>(bytes, block_bytes)) {}

void SendBudget::ask(const void* who, const std::string& client, Grant grant) {
  std::vector<State::Granted> granted;
  bool lacks = false;
  {
    const std::lock_guard lock(state_->mutex);
    state_->waiting.push(client, {who, client, Clock::now(), std::move(grant)});
    granted = state_->grant_waiting();
    lacks = state_->waiting.any([](const State::Asked&) { return true; });
  }
  for (State::Granted& next : granted) next.grant(std::move(next.lease));
  if (lacks && recall_) recall_();  // what is given up is granted
}

std::shared_ptr<SendBudget::Lease> SendBudget::take(const std::string& client,
                                                    std::uint64_t bytes) {
  auto taken = take_now(client, bytes);
  return taken == nullptr && recall_ && recall_() ? take_now(client, bytes) : taken;
}

std::shared_ptr<SendBudget::Lease> SendBudget::take_now(const std::string& client,
                                                        std::uint64_t bytes) {
  const std::lock_guard lock(state_->mutex);
  if (bytes > state_->bytes / 2 || state_->used > state_->bytes / 2 - bytes) return nullptr;
  if (state_->waiting.any([](const State::Asked&) { return true; })) return nullptr;
  state_->used += bytes;
  state_->of_client[client] += bytes;
  return std::make_shared<Lease>(state_, client, bytes);
}

void SendBudget::leave(const void* who) {
  std::vector<State::Asked> gone;  // destroyed without the lock
  const std::lock_guard lock(state_->mutex);
  gone = state_->waiting.take_all(
      [&](auto, const State::Asked& asked) { return asked.who == who; });
}

bool SendBudget::is_tight(std::uint64_t idle_bytes) const {
  const std::lock_guard lock(state_->mutex);
  return state_->used > state_->bytes / 2 + idle_bytes;
}

bool SendBudget::kept_waiting_since(Clock::time_point then) const {
  const std::lock_guard lock(state_->mutex);
  return state_->waiting.any([&](const State::Asked& asked) {
    return asked.since < then && state_->has_few(asked.client);
  });
}

std::uint64_t SendBudget::used_bytes() const {
  const std::lock_guard lock(state_->mutex);
  return state_->used;
}

SendBudget::Lease::Lease(std::shared_ptr<State> state, std::string client, std::uint64_t bytes)
    : state_(std::move(state)), client_(std::move(client)), bytes_(bytes) {}

SendBudget::Lease::~Lease() {
  if (bytes_ > 0) state_->give_back(client_, bytes_);
}

void SendBudget::Lease::shrink_to(std::uint64_t bytes) {
  if (bytes >= bytes_) return;
  state_->give_back(client_, bytes_ - bytes);
  bytes_ = bytes;
}

}  // namespace tet
