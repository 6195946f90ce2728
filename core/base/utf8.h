// Text that travels: names go into messages, logs and files that hold UTF-8 only.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace tet {

/// Whether the bytes are UTF-8: no overlong forms, no surrogates, nothing beyond U+10FFFF.
bool is_utf8(std::string_view text) noexcept;

/// Returns text that is UTF-8 as it is. Other text is read as Latin-1, as far as that fits into
/// so many bytes.
std::string as_utf8(std::string_view text, std::size_t most_bytes);

/// The whole characters of UTF-8 that fit into so many bytes, without those that control a
/// terminal (U+0080 to U+009F).
std::string cut_utf8(std::string_view text, std::size_t most_bytes);

}  // namespace tet
