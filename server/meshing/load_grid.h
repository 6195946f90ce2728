// From a stored file to a grid in memory, through a decoder.
#pragma once

#include <cstdint>

#include "core/vdb/decoder/decoder_pool.h"
#include "server/grids/volume_cache.h"
#include "server/meshing/large_plans.h"

namespace tet {

/// Has a stored grid read by a decoder. The file and what is handed back are checked on threads
/// for that, those of `loads`: either takes as long as it is large. A grid takes at most
/// `max_bytes` of memory. Errors, as `done` gets them: those of verify_stored,
/// DecoderPool::decode, volume_of and labels_of.
VolumeCache::Loader grid_loader(LargePlans& loads,
                                DecoderPool& decoders,
                                std::uint64_t max_bytes);

}  // namespace tet
