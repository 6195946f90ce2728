#include "server/shared_memory/kept_memory.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace tet {

namespace {

bool are_same(const std::weak_ptr<SideConnection>& a,
              const std::shared_ptr<SideConnection>& b) noexcept {
  return !a.owner_before(b) && !b.owner_before(a);
}

}  // namespace

/// What is removed, for the caller to destroy without the lock: others are then granted what
/// it was charged for.
template <class Goes>
std::vector<KeptMemory::Kept> KeptMemory::remove_if(const Goes& goes) {
  const auto first = std::stable_partition(kept_.begin(), kept_.end(),
                                           [&](const Kept& kept) { return !goes(kept); });
  std::vector<Kept> gone(std::make_move_iterator(first), std::make_move_iterator(kept_.end()));
  kept_.erase(first, kept_.end());
  for (const Kept& kept : gone) bytes_ -= kept.memory->size().bytes();
  return gone;
}

void KeptMemory::keep(const std::shared_ptr<SideConnection>& connection,
                      std::shared_ptr<RingMemory> memory) {
  std::vector<Kept> gone;
  const std::lock_guard lock(mutex_);
  bytes_ += memory->size().bytes();
  kept_.push_back({connection, std::move(memory), Clock::now()});
  auto stays = kept_.begin();
  for (; bytes_ > most_bytes_; ++stays) bytes_ -= stays->memory->size().bytes();
  gone.assign(std::make_move_iterator(kept_.begin()), std::make_move_iterator(stays));
  kept_.erase(kept_.begin(), stays);
}

std::shared_ptr<RingMemory> KeptMemory::take(const std::shared_ptr<SideConnection>& connection,
                                             const std::string& client,
                                             RingSize least) {
  std::vector<Kept> found;
  {
    const std::lock_guard lock(mutex_);
    found = remove_if([&](const Kept& kept) { return are_same(kept.connection, connection); });
  }
  if (found.empty()) return nullptr;
  std::shared_ptr<RingMemory>& memory = found.front().memory;
  const RingSize& size = memory->size();
  const bool serves = memory->client() == client && size.block_bytes == least.block_bytes &&
                      size.blocks >= least.blocks;
  return serves ? std::move(memory) : nullptr;
}

void KeptMemory::give_up_idle(Clock::time_point now) {
  std::vector<Kept> gone;
  const std::lock_guard lock(mutex_);
  gone = remove_if(
      [&](const Kept& kept) { return now - kept.since > idle_ || kept.connection.expired(); });
}

bool KeptMemory::give_up_all() {
  std::vector<Kept> gone;
  const std::lock_guard lock(mutex_);
  gone = remove_if([](const Kept&) { return true; });
  return !gone.empty();
}

std::uint64_t KeptMemory::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

}  // namespace tet
