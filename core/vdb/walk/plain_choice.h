// Which grids are read without OpenVDB: those of real numbers on voxels along the axes, which
// are nearly all that are meshed.
//
// Finding the symbols of OpenVDB's library takes four times as long as reading a small file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "core/vdb/walk/memory_charge.h"
#include "core/vdb/walk/vdb_outline.h"

namespace tet {

/// The grid that is meant, an index of `outline.grids`, if it is one of these: the only grid of
/// the file, or that of the name.
std::optional<std::size_t> find_plain_grid(const VdbOutline& outline,
                                           const std::string& grid_name,
                                           GridUse use,
                                           std::uint32_t component);

/// Whether all grids are of these, so that they can be listed.
bool are_plain_grids(const VdbOutline& outline);

}  // namespace tet
