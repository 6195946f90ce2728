// What several owners wait for, taken in turns.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tet {

/// Items in the order in which each owner put them, but one owner after another: who has a
/// hundred waiting delays who has one by one.
///
/// Not thread-safe.
template <class Item>
class FairQueue {
 public:
  /// Names an item while it waits; never 0.
  using Place = std::uint64_t;

  Place push(const std::string& owner, Item item) {
    of_owner_[owner].push_back({++last_place_, std::move(item)});
    ++size_;
    return last_place_;
  }

  /// Counts as this owner's turn, though it found no need to wait.
  void had_turn(const std::string& owner) { last_owner_ = owner; }

  /// The first item of the next owner for whom `may(owner)` is true.
  template <class May>
  std::optional<Item> take(const May& may) {
    const auto after_last = of_owner_.upper_bound(last_owner_);
    for (auto it = after_last; it != of_owner_.end(); ++it) {
      if (may(it->first)) return take_first(it);
    }
    for (auto it = of_owner_.begin(); it != after_last; ++it) {
      if (may(it->first)) return take_first(it);
    }
    return std::nullopt;
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

  Item take_first(typename Owners::iterator owner) {
    last_owner_ = owner->first;
    Item item = std::move(owner->second.front().item);
    owner->second.pop_front();
    if (owner->second.empty()) of_owner_.erase(owner);
    --size_;
    return item;
  }

  Owners of_owner_;  ///< none is empty
  std::string last_owner_;
  Place last_place_ = 0;
  std::size_t size_ = 0;
};

}  // namespace tet
