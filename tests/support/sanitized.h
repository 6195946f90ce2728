// How much of a long test a sanitizer sees.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace tet::test {

/// True in a build for a sanitizer, in which everything takes ten times as long. It sees what
/// each path does to memory and threads; whether a promise holds on one more random input is
/// for the other builds. So a test that walks the same path with many inputs walks it with
/// fewer there.
#ifdef TET_SANITIZED
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

/// A number of turns, a size: one for a sanitizer, another for all other builds.
template <class Number>
constexpr Number sanitized_or(Number sanitized, Number other) noexcept {
  return kSanitized ? sanitized : other;
}

/// All `inputs`; for a sanitizer `count` of them, from the first to the last, evenly spread.
template <class Input>
std::vector<Input> few_of(std::vector<Input> inputs, std::size_t count) {
  if (!kSanitized || count >= inputs.size()) return inputs;
  std::vector<Input> few;
  for (std::size_t i = 0; i < count; ++i) {
    few.push_back(std::move(inputs[count == 1 ? 0 : i * (inputs.size() - 1) / (count - 1)]));
  }
  return few;
}

}  // namespace tet::test
