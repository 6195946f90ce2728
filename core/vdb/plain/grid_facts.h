// What is said of a grid and made of its values, whoever read them.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <absl/status/statusor.h>

#include "core/volume/volume.h"
#include "core/volume/volume_builder.h"

namespace tet {

/// A grid's class as OpenVDB has it: "level set", "fog volume", "staggered" or
/// "unknown", of what a file says.
std::string grid_class_of(std::string_view stored);

/// Says what voxels are that are no cubes; empty of cubes.
std::string describe_voxels(const VoxelTransform& transform);

/// What the conversion of a surface left in a grid's metadata, by name: in characters that can
/// be printed, and no more than is worth showing.
std::string surface_text(std::span<const std::pair<std::string, std::string>> metadata);

/// The volume of a grid's bricks, values, cubes and `constants`. Errors: those of index_volume;
/// kFailedPrecondition (it is to be meshed, and holds nothing).
absl::StatusOr<Volume> finish_volume(Volume volume, std::vector<ConstantBrick> constants);

/// Says which side is inside: by the grid's class, as grid_class_of has it, and else by the
/// values, as what it may be called says nothing of an inside.
void set_kind(std::string_view grid_class, Volume& volume);

}  // namespace tet
