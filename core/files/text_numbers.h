// Numbers as text, written in place.
#pragma once

#include <charconv>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "core/mesh/tet_mesh.h"

namespace tet {

/// Each of these writes at `place`, where there is room, and returns where it ended.
inline char* put_text(char* place, std::string_view text) noexcept {
  std::memcpy(place, text.data(), text.size());
  return place + text.size();
}

template <std::unsigned_integral Number>
char* put_number(char* place, Number number) noexcept {
  return std::to_chars(place, place + 20, number).ptr;
}

/// The shortest text that reads as the same number of that type.
inline char* put_coordinate(char* place, double value, CoordinateType type) noexcept {
  constexpr std::size_t kRoom = 32;
  return type == CoordinateType::kFloat32
             ? std::to_chars(place, place + kRoom, static_cast<float>(value)).ptr
             : std::to_chars(place, place + kRoom, value).ptr;
}

/// Takes at most 20 characters: the last digits go where they must.
inline char* put_short_coordinate(char* place, double value, CoordinateType type) noexcept {
  constexpr std::ptrdiff_t kMost = 20;
  char* end = put_coordinate(place, value, type);
  for (int digits = 17; end - place > kMost; --digits) {
    end = std::to_chars(place, place + 32, value, std::chars_format::general, digits).ptr;
  }
  return end;
}

}  // namespace tet
