// A chunk's message as a file: its bytes, and what a trailer needs to know of them.
#pragma once

#include <cstdint>
#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "proto/wire/block_pool.h"
#include "server/meshing/chunk_maker.h"
#include "server/ops/disk.h"

namespace tet {

/// The file's bytes are the chunk's MeshEvent, then 1,480 bytes: tets, bytes of the columns,
/// and the members of QualityStats in their order; all of 8 bytes, little-endian.

/// Bytes of that file.
std::uint64_t stored_bytes(const ChunkMessage& chunk);

/// SHA-256 of the file that `chunk` becomes, 64 hexadecimal digits: the file's name.
std::string digest_of(const ChunkMessage& chunk);

/// Errors: the disk's.
absl::Status write_chunk(const ChunkMessage& chunk, File& file);

/// Reads a chunk into a block that lets go of `held` with the last of its bytes.
/// Errors: kDataLoss (its SHA-256 is not `digest`), and the disk's.
absl::StatusOr<ChunkMessage> read_chunk(const File& file,
                                        const std::string& digest,
                                        BlockPool& blocks,
                                        std::shared_ptr<SendBudget::Lease> held);

}  // namespace tet
