// What is meshed: samples of a field on a regular grid.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "tetstream/export.h"
#include "tetstream/mesh.h"
#include "tetstream/status.h"

namespace tetstream {

enum class VolumeKind : std::uint8_t {
  kLevelSet,  ///< inside where a value is below the iso value; values in world units
  kDensity,   ///< inside where a value is above the iso value
  kValues,    ///< there is no inside: values for the vertices of another volume's mesh
};

/// Samples that somebody else holds, along three axes.
struct SampleArray {
  /// size[0] * size[1] * size[2] finite values; sample (i, j, k) is at
  /// (i * size[1] + j) * size[2] + k, as in a C array or a numpy array a[x, y, z].
  std::span<const float> values;
  std::array<std::size_t, 3> size{};
  double spacing = 1;  ///< from sample to sample, world units, the same along every axis
  Point origin{};      ///< of sample (0, 0, 0)
  VolumeKind kind = VolumeKind::kLevelSet;
  /// The value outside of the array. Unless given three spacings for a level set, so that what
  /// touches the array's edge is closed there, and 0 otherwise.
  std::optional<float> background = {};
};

/// Triangles that somebody else holds.
struct Triangles {
  std::span<const double> points;            ///< x, y, z of each vertex, world units
  std::span<const std::uint32_t> triangles;  ///< three vertex ids of each triangle
};

/// What becomes of a surface with openings, which has no inside.
enum class OpenSurface : std::uint8_t {
  kRefuse,  ///< nothing: someone has to say what is meant
  kClose,   ///< each opening gets a cap
  kShell,   ///< a solid two voxels thick around the surface
};

/// How a .vdb file is read.
struct VdbOptions {
  std::string grid = {};  ///< its name; empty takes the only one that fits
  /// Read the file in this process. Otherwise the program tetstream-decoder reads it, which can
  /// do nothing else, as is right for files of others.
  bool trusted = false;
};

/// A volume, ready to be meshed any number of times. Copies share it; it is never changed, so
/// any thread may use it.
class TETSTREAM_API Volume {
 public:
  /// Copies an array of samples. Errors: kInvalidArgument (no samples, sizes that do not agree,
  /// a spacing that is not positive), kFailedPrecondition (a value that is not finite).
  static Result<Volume> from_samples(const SampleArray& samples);

  /// Reads a grid of an OpenVDB file. Errors: kNotFound (the file or the grid; the message
  /// lists what there is), kInvalidArgument (no such file format), kFailedPrecondition (a grid
  /// that cannot be meshed, or several and no name), kUnavailable (no tetstream-decoder).
  static Result<Volume> from_vdb(const std::string& path, const VdbOptions& options = {});
  /// Reads a float grid whose values are wanted at vertices: of VolumeKind::kValues.
  static Result<Volume> values_from_vdb(const std::string& path,
                                        const VdbOptions& options = {});

  /// Makes a level set, three voxels to either side, of what a closed surface goes around:
  /// solids that overlap are one, and a shell that is wound inwards within another is a cavity.
  /// Holes that are small are closed. Errors: kInvalidArgument (an id without vertex, no
  /// triangles, a voxel size that is not positive or larger than the inside),
  /// kFailedPrecondition (the surface is open, and `open` refuses it), kResourceExhausted (too
  /// many voxels).
  static Result<Volume> from_triangles(const Triangles& triangles,
                                       double voxel_size,
                                       OpenSurface open = OpenSurface::kRefuse);
  /// Makes a level set of an .obj, .stl or .ply file. Errors also: kNotFound, kInvalidArgument
  /// (with the line or byte).
  static Result<Volume> from_surface_file(const std::string& path,
                                          double voxel_size,
                                          OpenSurface open = OpenSurface::kRefuse);

  VolumeKind kind() const noexcept;
  /// World units.
  double voxel_size() const noexcept;

  /// Writes an OpenVDB file, whole or not at all. Errors: kUnavailable (the disk).
  Status write_vdb(const std::string& path) const;

  struct Impl;
  explicit Volume(std::shared_ptr<const Impl> impl);
  const Impl& impl() const noexcept { return *impl_; }

 private:
  std::shared_ptr<const Impl> impl_;
};

}  // namespace tetstream
