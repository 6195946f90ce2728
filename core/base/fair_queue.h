// What several owners wait for, taken in turns.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tet {

/// Items in the order in which each owner put them. The owner that has used least comes next,
/// and of those who have used as much one after another: who has a hundred waiting delays who
/// has one by one, and who takes long by nobody else's turn.
///
/// What is used is what `charge` says. Whoever comes back after a while begins where those are
/// who are served now: nobody saves up for later. Where nothing is charged, the owners
/// alternate.
///
/// Not thread-safe.
template <class Item>
class FairQueue {
 public:
  /// Names an item while it waits; never 0.
  using Place = std::uint64_t;
  using Use = std::chrono::nanoseconds;

  Place push(const std::string& owner, Item item) {
    std::deque<Waiting>& own = of_owner_[owner];
    if (own.empty() && served_ > Use{0}) begin_at(owner, served_);
    own.push_back({++last_place_, std::move(item)});
    ++size_;
    return last_place_;
  }

  /// Counts as this owner's turn, though it found no need to wait.
  void had_turn(const std::string& owner) { last_owner_ = owner; }

  /// What this owner took has used so much.
  void charge(const std::string& owner, Use use) {
    begin_at(owner, served_);
    used_[owner] += use;
  }

  /// The first item of the next owner for whom `may(owner)` is true.
  template <class May>
  std::optional<Item> take(const May& may) {
    auto next = of_owner_.end();
    const auto look_at = [&](auto begin, auto end) {
      for (auto it = begin; it != end; ++it) {
        if (next != of_owner_.end() && used(it->first) >= used(next->first)) continue;
        if (may(it->first)) next = it;
      }
    };
    const auto after_last = of_owner_.upper_bound(last_owner_);
    look_at(after_last, of_owner_.end());
    look_at(of_owner_.begin(), after_last);
    if (next == of_owner_.end()) return std::nullopt;
    served_ = std::max(served_, used(next->first));
    return take_first(next);
  }

  /// Takes out all items that `chosen(place, item)` names, in no useful order.
  template <class Chosen>
  std::vector<Item> take_all(const Chosen& chosen) {
    std::vector<Item> taken;
    for (auto it = of_owner_.begin(); it != of_owner_.end();) {
      std::erase_if(it->second, [&](Waiting& waiting) {
        if (!chosen(waiting.place, waiting.item)) return false;
        taken.push_back(std::move(waiting.item));
        return true;
      });
      it = it->second.empty() ? of_owner_.erase(it) : std::next(it);
    }
    size_ -= taken.size();
    return taken;
  }

  /// The last item of the owner who has most waiting, where these are more than `most`.
  std::optional<Item> take_last_beyond(std::size_t most) {
    const auto fewer = [](const auto& a, const auto& b) {
      return a.second.size() < b.second.size();
    };
    const auto owner = std::max_element(of_owner_.begin(), of_owner_.end(), fewer);
    if (owner == of_owner_.end() || owner->second.size() <= most) return std::nullopt;
    Item item = std::move(owner->second.back().item);
    owner->second.pop_back();
    if (owner->second.empty()) of_owner_.erase(owner);
    --size_;
    return item;
  }

  template <class Condition>
  bool any(const Condition& is_so) const {
    for (const auto& [owner, items] : of_owner_) {
      for (const Waiting& waiting : items) {
        if (is_so(waiting.item)) return true;
      }
    }
    return false;
  }

  std::size_t size() const noexcept { return size_; }
  std::size_t size_of(const std::string& owner) const {
    const auto found = of_owner_.find(owner);
    return found == of_owner_.end() ? 0 : found->second.size();
  }

 private:
  struct Waiting {
    Place place = 0;
    Item item;
  };
  using Owners = std::map<std::string, std::deque<Waiting>>;

  Use used(const std::string& owner) const {
    const auto found = used_.find(owner);
    return found == used_.end() ? served_ : found->second;
  }

  /// Whoever has used less has not been here for a while.
  void begin_at(const std::string& owner, Use least) {
    if (used_.size() > 2 * of_owner_.size() + kForgotten) forget_others();
    Use& use = used_.try_emplace(owner, least).first->second;
    use = std::max(use, least);
  }

  /// Those who would begin anew with as much.
  void forget_others() {
    std::erase_if(used_, [this](const auto& one) {
      return one.second <= served_ && !of_owner_.contains(one.first);
    });
  }

  Item take_first(typename Owners::iterator owner) {
    last_owner_ = owner->first;
    Item item = std::move(owner->second.front().item);
    owner->second.pop_front();
    if (owner->second.empty()) of_owner_.erase(owner);
    --size_;
    return item;
  }

  static constexpr std::size_t kForgotten = 64;

  Owners of_owner_;                  ///< none is empty
  std::map<std::string, Use> used_;  ///< who is not here begins with `served_`
  Use served_{0};                    ///< what the last had used when it was its turn
  std::string last_owner_;
  Place last_place_ = 0;
  std::size_t size_ = 0;
};

}  // namespace tet
