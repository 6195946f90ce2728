// Compressed runs of values, looked at from the outside.
#pragma once

#include <cstdint>

#include "core/vdb/walk/vdb_cursor.h"
#include "core/vdb/walk/vdb_outline.h"

namespace tet {

/// Walks over `bytes` bytes as they were stored with `compression`: as they are, or after a
/// length with zlib or blosc. Nothing is decompressed; every length within is checked against
/// its neighbours, so that what decompresses it can fail but neither read nor write too far.
void walk_chunk(VdbCursor& cursor, std::uint64_t bytes, const VdbCompression& compression);

/// Walks over a blosc buffer of `length` bytes that holds `bytes` bytes.
void walk_blosc(VdbCursor& cursor, std::uint64_t length, std::uint64_t bytes);

}  // namespace tet
