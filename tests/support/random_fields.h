// Random fields by family and seed: smooth ones, and the most hostile that a grid can hold.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/volume/volume.h"

namespace tet::test {

/// Components and Euler characteristic of a boundary.
struct Topology {
  std::uint64_t components = 0;
  std::int64_t euler_characteristic = 0;
};

struct RandomField {
  Volume volume;  ///< a level set with voxels of 1
  /// How far from zero phi may be where the boundary of a mesh at voxel spacing lies, as two
  /// secant steps end near a smooth field's surface; 0 where nothing is known.
  double max_surface_phi = 0;
  /// Where every feature is several voxels wide, so that meshes must have it.
  std::optional<Topology> topology;
};

/// - "signs": any value in every voxel, so any sign at every node;
/// - "zeros": small whole numbers, zero among them: exact zeros and ties in abundance;
/// - "plateaus": smooth noise in steps, with zeros over whole regions;
/// - "denormals": the smallest floats there are, zeros and ones;
/// - "magnitudes": anything from the smallest float to the largest;
/// - "specks": features of one voxel: grains, pinholes, rods and sheets;
/// - "planes": solids between planes that go exactly through lattice nodes;
/// - "noise": smooth noise, with walls and necks of any width;
/// - "shapes": balls, tori and hollow balls apart from each other, of known topology.
std::span<const std::string_view> field_families();

/// A field of about `edge` voxels cubed; outside beyond them. Equal arguments give equal
/// fields.
RandomField random_field(std::string_view family, std::uint32_t seed, int edge);

}  // namespace tet::test
