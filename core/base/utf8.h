// Text that travels: names go into messages, logs and files that hold UTF-8 only.
#pragma once

#include <string_view>

namespace tet {

/// Whether the bytes are UTF-8: no overlong forms, no surrogates, nothing beyond U+10FFFF.
bool is_utf8(std::string_view text) noexcept;

}  // namespace tet
