// The tags of a small XML file, one after the other: no more of XML than files of numbers need.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tet {

struct XmlTag {
  std::string_view name;
  bool closes = false;         ///< "</Name>"
  bool closes_itself = false;  ///< "<Name/>"
  std::vector<std::pair<std::string_view, std::string>> attributes;
  std::size_t begin = 0, end = 0;  ///< in the text, brackets included

  const std::string* find(std::string_view name) const noexcept;
};

/// Finds the next tag from `at` on; nothing where the text ends before one does. Comments and
/// declarations are passed over. Entities other than the five of XML are refused, and there is
/// no DTD. Throws ImageRefusal.
std::optional<XmlTag> next_tag(std::string_view text, std::size_t at);

}  // namespace tet
