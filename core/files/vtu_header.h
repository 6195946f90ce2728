// What the XML of a .vtu file says of the columns behind it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>

#include "core/remap/data_mesh.h"

namespace tet {

/// A column that lies behind the XML.
struct VtuColumn {
  std::string name;
  NumberType type = NumberType::kFloat64;
  std::uint32_t components = 1;
  std::uint64_t offset = 0;  ///< of its size, from the beginning of the data
};

struct VtuHeader {
  std::uint64_t points = 0, cells = 0;
  unsigned size_bytes = 8;       ///< of the number in front of each column: 4 or 8
  std::uint64_t data_start = 0;  ///< of the data, in the file
  std::optional<VtuColumn> places, connectivity, offsets, types;
  std::vector<VtuColumn> point_data, cell_data;
  WholeArrays of_whole;
};

/// VTK's number of a tet with four corners.
inline constexpr std::uint8_t kVtuTetra = 10;

/// The longest XML that is read.
inline constexpr std::size_t kMaxVtuHeaderBytes = std::size_t{1} << 20;

/// Reads the beginning of a file, as far as its data. Counts are what the file says: nothing is
/// allocated for them. Errors: kInvalidArgument (not such a file, or one whose data is not raw:
/// says what to do).
absl::StatusOr<VtuHeader> parse_vtu_header(std::string_view beginning);

/// Bytes of a number.
std::size_t size_of(NumberType type) noexcept;
/// As .vtu files name it.
const char* vtu_name_of(NumberType type) noexcept;

}  // namespace tet
