// The values of a request's fields at vertices that have their final places.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/mesh/tet_mesh.h"
#include "core/plan/vertex_field.h"

namespace tet {

/// Samples every field at each of some vertices of a mesh with this header: rows as TetMesh has
/// them. Where a vertex lies is its stored position, as it was rounded, from the header's
/// origin; of a vector each component is sampled by itself, along the world's axes as the grid
/// has them.
void sample_fields(std::span<const VertexField> fields,
                   const MeshHeader& header,
                   std::span<const std::byte> positions,
                   std::span<std::byte> values) noexcept;

/// Writes of some vertices in which faces of the box each lies, one byte each, as the last
/// value of its row.
void write_cut_faces(std::span<const std::uint8_t> faces,
                     const MeshHeader& header,
                     std::span<std::byte> values) noexcept;

}  // namespace tet
