// What reading a grid may take.
#pragma once

#include <cstdint>

#include "core/vdb/walk/charge_file.h"

namespace tet {

struct LoadLimits {
  std::uint64_t max_bytes = std::uint64_t{16} << 30;          ///< of the volume in memory
  std::uint64_t max_reading_bytes = std::uint64_t{48} << 30;  ///< of the volume and all else
  /// The caller has walked this very file (core/vdb/walk/walk_vdb.h) and checked what it takes
  /// (core/vdb/walk/memory_charge.h), in this process or in another: both are left out.
  bool walked = false;
};

}  // namespace tet
