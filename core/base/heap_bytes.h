// What a vector takes beyond itself.
#pragma once

#include <cstdint>
#include <vector>

namespace tet {

/// Bytes of its elements and of the room it has for more; not what these point to.
template <class Value>
std::uint64_t heap_bytes(const std::vector<Value>& values) noexcept {
  return values.capacity() * sizeof(Value);
}

/// Adds up the heap bytes of several vectors.
template <class... Vectors>
std::uint64_t all_heap_bytes(const Vectors&... vectors) noexcept {
  return (heap_bytes(vectors) + ...);
}

}  // namespace tet
