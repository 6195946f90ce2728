// How much of something each client has at once.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>

namespace tet {

/// Thread-safe.
class ClientTally {
 public:
  /// Takes one more; false where the client has `most` already.
  bool enter(const std::string& client, std::uint64_t most) {
    const std::lock_guard lock(mutex_);
    std::uint64_t& count = of_client_[client];
    if (count >= most) return false;
    ++count;
    return true;
  }

  void leave(const std::string& client) {
    const std::lock_guard lock(mutex_);
    const auto found = of_client_.find(client);
    if (--found->second == 0) of_client_.erase(found);
  }

 private:
  std::mutex mutex_;
  std::map<std::string, std::uint64_t> of_client_;
};

}  // namespace tet
