// Prepared statements of one connection, by their text: as many as are worth keeping.
#pragma once

#include <cstddef>
#include <list>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

namespace tet {

/// The filters of clients are in the text of a list, so that there is no end to what may be
/// prepared: whatever was used longest ago goes where there is no room for another.
///
/// The store's own statements, of which there are about eighty, find room beside as many that
/// clients make up. Each takes some kilobytes, here or in the database's session.
inline constexpr std::size_t kMostStatements = 200;

/// Not thread-safe.
template <class Statement>
class StatementCache {
 public:
  std::size_t size() const { return by_use_.size(); }
  bool is_full() const { return size() >= kMostStatements; }

  /// Counts as a use. Null where there is none; what it points to stays until it is dropped.
  Statement* find(std::string_view sql) {
    const auto found = by_text_.find(sql);
    if (found == by_text_.end()) return nullptr;
    by_use_.splice(by_use_.begin(), by_use_, found->second);
    return &found->second->second;
  }

  /// The one that was used longest ago. There is one.
  const Statement& oldest() const { return by_use_.back().second; }
  void drop_oldest() {
    by_text_.erase(by_use_.back().first);
    by_use_.pop_back();
  }

  /// The text is one that it does not have, and it is not full.
  Statement& add(std::string_view sql, Statement statement) {
    by_use_.emplace_front(std::string(sql), std::move(statement));
    by_text_.emplace(by_use_.front().first, by_use_.begin());
    return by_use_.front().second;
  }

 private:
  using Uses = std::list<std::pair<std::string, Statement>>;

  Uses by_use_;  ///< the last used first
  std::unordered_map<std::string_view, typename Uses::iterator> by_text_;  ///< texts in by_use_
};

}  // namespace tet
