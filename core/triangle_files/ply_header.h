// The header of a PLY file: which elements follow, and how they are stored.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>

namespace tet {

enum class PlyFormat : std::uint8_t { kAscii, kLittleEndian, kBigEndian };

struct PlyType {
  enum Kind : std::uint8_t { kSigned, kUnsigned, kFloat } kind = kFloat;
  std::size_t size = 4;  ///< bytes
};

struct PlyProperty {
  std::string name;
  PlyType type;
  std::optional<PlyType> count_type;  ///< of a list's length; nothing for a single value
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;  ///< never empty
};

struct PlyHeader {
  PlyFormat format = PlyFormat::kAscii;
  std::vector<PlyElement> elements;  ///< in the order of the body
  std::size_t body = 0;              ///< the byte where it starts
};

/// Errors: kInvalidArgument with the line.
absl::StatusOr<PlyHeader> read_ply_header(std::string_view bytes);

}  // namespace tet
