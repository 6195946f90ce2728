// The numbers of an image, decoded: as they are stored, in this machine's order of bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/posix/byte_source.h"
#include "core/image/image_outline.h"

namespace tet {

/// Calls `visit(std::span<const T>)` with the type that the array's numbers are of.
template <class Visit>
auto visit_values(ScalarType type, std::span<const std::byte> bytes, const Visit& visit) {
  const auto as = [&]<class T>(T) {
    return visit(std::span(reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)));
  };
  switch (type) {
    case ScalarType::kInt8:
      return as(std::int8_t{});
    case ScalarType::kUint8:
      return as(std::uint8_t{});
    case ScalarType::kInt16:
      return as(std::int16_t{});
    case ScalarType::kUint16:
      return as(std::uint16_t{});
    case ScalarType::kInt32:
      return as(std::int32_t{});
    case ScalarType::kUint32:
      return as(std::uint32_t{});
    case ScalarType::kInt64:
      return as(std::int64_t{});
    case ScalarType::kUint64:
      return as(std::uint64_t{});
    case ScalarType::kFloat32:
      return as(float{});
    case ScalarType::kFloat64:
      break;
  }
  return as(double{});
}

/// An image with what its header tells once it is unpacked. Throws ImageRefusal: also where a
/// packed one, which may be longer than it claims, takes more than so many bytes to be read.
ImageOutline full_outline(const ByteSource& source, std::uint64_t most_reading_bytes);

/// All numbers of an array of `outline`. Throws ImageRefusal: truncated, broken, not as long as
/// the header says.
std::vector<std::byte> read_values(const ByteSource& source,
                                   const ImageOutline& outline,
                                   const ImageArray& array);

}  // namespace tet
