#include "server/jobs/store/share_out.h"

#include <functional>
#include <queue>
#include <utility>
#include <vector>

namespace tet {

std::map<std::string, std::int64_t> share_out(std::int64_t count,
                                              const std::map<std::string, std::int64_t>& held) {
  using Holder = std::pair<std::int64_t, std::string>;
  std::priority_queue<Holder, std::vector<Holder>, std::greater<>> fewest_first;
  for (const auto& [name, leases] : held) fewest_first.emplace(leases, name);
  std::map<std::string, std::int64_t> shares;
  for (std::int64_t i = 0; i < count; ++i) {
    auto [leases, name] = fewest_first.top();
    fewest_first.pop();
    ++shares[name];
    fewest_first.emplace(leases + 1, std::move(name));
  }
  return shares;
}

}  // namespace tet
