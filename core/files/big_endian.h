// Numbers with their largest byte first, as classic netCDF files have them.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <type_traits>

namespace tet {

template <class Number>
std::array<std::byte, sizeof(Number)> big_endian(Number number) noexcept {
  static_assert(std::is_arithmetic_v<Number> && std::endian::native == std::endian::little);
  auto bytes = std::bit_cast<std::array<std::byte, sizeof(Number)>>(number);
  std::ranges::reverse(bytes);
  return bytes;
}

/// A row of them, without padding.
template <class Number, std::size_t N>
std::array<std::byte, N * sizeof(Number)> big_endian(
    const std::array<Number, N>& numbers) noexcept {
  std::array<std::byte, N * sizeof(Number)> row;
  for (std::size_t i = 0; i < N; ++i) {
    const auto bytes = big_endian(numbers[i]);
    std::ranges::copy(bytes, row.begin() + static_cast<std::ptrdiff_t>(i * sizeof(Number)));
  }
  return row;
}

}  // namespace tet
