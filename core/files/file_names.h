// Names as formats take them: short, of few characters, no two alike.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace tet {

/// What a format takes as a name.
struct NameRule {
  std::size_t most_bytes = 80;
  bool letter_first = true;
  bool ignores_case = false;  ///< names that differ by case alone are one
};

/// The names with letters, digits and `_` alone (`_` stands for each other character), cut to
/// what the rule allows. Where two become one the later is numbered: `a_b`, `a_b_2`.
std::vector<std::string> names_in_file(std::span<const std::string> names,
                                       const NameRule& rule);

/// The `name` of each group.
template <class Group>
std::vector<std::string> names_of(const std::vector<Group>& groups) {
  std::vector<std::string> names;
  names.reserve(groups.size());
  for (const Group& group : groups) names.push_back(group.name);
  return names;
}

}  // namespace tet
