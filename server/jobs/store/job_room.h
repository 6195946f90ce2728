// How many jobs each namespace may still be given before somebody has to count them.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>

namespace tet {

/// Counting takes the longer the more jobs there are: what one count found is good for some of
/// those that follow. Thread safety: any thread may call any member.
class JobRoom {
 public:
  /// Room for one more; false where none is known of.
  bool take(const std::string& space) {
    const std::lock_guard lock(mutex_);
    std::int64_t& room = of_space_[space];
    return room > 0 && room-- > 0;
  }

  void set(const std::string& space, std::int64_t room) {
    const std::lock_guard lock(mutex_);
    of_space_[space] = room;
  }

 private:
  std::mutex mutex_;
  std::map<std::string, std::int64_t> of_space_;
};

}  // namespace tet
