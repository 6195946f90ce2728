// What reading an open file would take, found by walking over it.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include <absl/status/statusor.h>

#include "core/vdb/walk/memory_charge.h"
#include "core/vdb/walk/vdb_outline.h"

namespace tet {

/// A file that is open for reading, and what messages call it. Whoever opened it keeps it open.
struct OpenGridFile {
  int descriptor = -1;
  std::int64_t size_bytes = 0;
  std::string name;
};

/// Walks over all of the file, unless it is `cancelled` meanwhile, and gives `charge_of` what
/// it holds. Errors: those of walk_vdb and check_memory, told of the file.
absl::StatusOr<MemoryCharge> charge_file(
    const OpenGridFile& file,
    const std::function<MemoryCharge(const VdbOutline&)>& charge_of,
    std::uint64_t max_volume_bytes,
    std::uint64_t max_reading_bytes,
    const std::function<bool()>& cancelled = nullptr);

}  // namespace tet
