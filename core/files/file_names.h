// Names as formats take them: short, of few characters, no two alike.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tet {

/// What a format takes as a name.
struct NameRule {
  std::size_t most_bytes = 80;
  bool letter_first = true;
  bool ignores_case = false;  ///< names that differ by case alone are one
  /// The only characters that it does not take; where there are none, it takes letters, digits
  /// and `_` alone.
  std::string_view bad_characters = {};
  char in_their_place = '_';
  /// Names of the format's own; in small letters where it ignores case.
  std::span<const std::string_view> taken = {};
};

/// The names with `_` for each character that the format does not take, cut to what the rule
/// allows, at a character's end. Where two become one the later is numbered: `a_b`, `a_b_2`.
std::vector<std::string> names_in_file(std::span<const std::string> names,
                                       const NameRule& rule);

/// Names arrays of one or three components likewise, where a format has each component as an
/// array of its own, which is called like the whole or with `_x`, `_y` and `_z` behind that: no
/// two of those are alike.
std::vector<std::string> array_names_in_file(std::span<const std::string> names,
                                             std::span<const std::uint32_t> components,
                                             const NameRule& rule);

/// What components of an array of one or three have behind its name.
std::span<const std::string_view> component_endings(std::uint32_t components) noexcept;

/// The `name` of each group.
template <class Group>
std::vector<std::string> names_of(const std::vector<Group>& groups) {
  std::vector<std::string> names;
  names.reserve(groups.size());
  for (const Group& group : groups) names.push_back(group.name);
  return names;
}

/// The `components` of each array.
template <class Array>
std::vector<std::uint32_t> components_of(const std::vector<Array>& arrays) {
  std::vector<std::uint32_t> components;
  components.reserve(arrays.size());
  for (const Array& array : arrays) components.push_back(array.components);
  return components;
}

}  // namespace tet
