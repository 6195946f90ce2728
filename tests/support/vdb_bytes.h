// .vdb files as bytes in memory, true ones and lies.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/vdb/openvdb/vdb_grids.h"
#include "core/vdb/walk/vdb_cursor.h"
#include "core/vdb/walk/vdb_outline.h"

namespace tet::test {

struct VdbWriting {
  std::uint32_t compression = openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK;
  bool offsets = true;  ///< as files have them, and streams do not
};

/// What OpenVDB writes of these grids.
std::string vdb_bytes(const openvdb::GridCPtrVec& grids, const VdbWriting& writing = {});

/// Files of a few kilobytes, of every kind of compression, with one grid and with several.
std::vector<std::string> small_files();

absl::StatusOr<VdbOutline> walk_bytes(const std::string& bytes,
                                      std::vector<VdbField>* fields = nullptr);

/// The `nth` field of that name.
VdbField find_field(const std::string& bytes, const std::string& what, std::size_t nth);

/// Gives the `nth` field of that name this value (little-endian), and leaves all other bytes.
std::string with_lie(std::string bytes,
                     const std::string& what,
                     std::size_t nth,
                     std::uint64_t value);

}  // namespace tet::test
