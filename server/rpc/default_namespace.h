// The namespace of callers that name none.
#pragma once

#include <string_view>

namespace tet {

/// The namespace of everyone where there are no tokens.
inline constexpr std::string_view kDefaultSpace = "default";

}  // namespace tet
