// From a mesh's columns to a batch of tets that is to be measured.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/base/tet_batch.h"
#include "core/mesh/tet_mesh.h"

namespace tet {

/// Loads `count` tets from `first` on, as they are stored; lanes beyond repeat the last one.
void load_batch(const MeshView& view,
                std::uint64_t first,
                std::size_t count,
                TetBatch& batch) noexcept;

}  // namespace tet
