// Runs of values as a .vdb file stores them, unpacked without OpenVDB.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/vdb/walk/vdb_cursor.h"
#include "core/vdb/walk/vdb_outline.h"

namespace tet {

/// Unpacks the runs of one file, one after another. Not thread-safe.
class RunUnpacker {
 public:
  explicit RunUnpacker(const VdbCompression& compression) : compression_(compression) {}

  /// Fills `bytes` with the next run, which must have been walked over: it is stored as it is,
  /// or after a length with zlib or blosc. Throws WalkRefusal where it does not unpack.
  void read(VdbCursor& cursor, std::span<std::byte> bytes);

 private:
  const std::byte* packed_bytes(VdbCursor& cursor, std::size_t count);

  VdbCompression compression_;
  std::vector<std::byte> packed_;  // what is longer than a window gives at once
};

/// The float that a half float stands for, exactly.
float half_to_float(std::uint16_t half) noexcept;

}  // namespace tet
