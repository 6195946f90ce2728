// Who gets how much of what there is.
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace tet {

/// Deals `count` leases, each to whoever holds the fewest (of equals to the first by name), and
/// says how many each gets. `held` is not empty; those who get none are left out.
std::map<std::string, std::int64_t> share_out(std::int64_t count,
                                              const std::map<std::string, std::int64_t>& held);

}  // namespace tet
