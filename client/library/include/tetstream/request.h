// What a caller asks of a mesh.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "tetstream/labels.h"
#include "tetstream/mesh.h"
#include "tetstream/volume.h"

namespace tetstream {

/// Bounds on dihedral angles: docs/bounds.md.
enum class Preset : std::uint8_t {
  kDefault,    ///< 11.3 to 154.7 degrees
  kMinAngle,   ///< the best smallest angle: 11.8 to 161.2 degrees
  kBothSides,  ///< inside and outside in one mesh, up to a box: 9.4 to 157.4 degrees
};

/// The side of the iso value that is inside.
enum class Inside : std::uint8_t { kBelow, kAbove };

enum class Coordinates : std::uint8_t {
  kAutomatic,  ///< float, and double where float would bend the angle bounds
  kFloat32,
  kFloat64,
};

/// A volume that a server stores. It may be kept as text, and used again.
struct StoredVolume {
  std::string name;       ///< `grids/{sha256}`: the same file has the same name everywhere
  std::string grid = {};  ///< within the file; empty takes the only one that can be meshed
  /// Level sets within the file instead, each of which is a label of the mesh: see
  /// Labels::from_level_sets. With `Request::labels`.
  std::vector<std::string> grids = {};
};

/// An array of values that the vertices get, sampled from another volume.
struct Field {
  std::string name;  ///< of the array
  /// A volume of VolumeKind::kValues, or of any other. A server is sent it with every call,
  /// unless `stored` names what it has already.
  std::optional<Volume> values = {};
  std::optional<StoredVolume> stored = {};  ///< of the server that is asked; else not looked at
};

/// Lengths are world units. A default-made request is a good mesh: as fine as the voxels at the
/// surface, coarser inside.
struct Request {
  /// Size of the finest cells; unless given the voxel size.
  std::optional<double> spacing = {};
  /// The surface's value; unless given 0 for level sets and 0.5 for densities.
  std::optional<double> iso = {};
  /// Which side of the iso value is inside; unless given what the volume's kind says. Must be
  /// given where a .vdb file's grid has no class and its values do not tell: docs/inside.md.
  std::optional<Inside> inside = {};
  /// Octree levels above the finest: 0 (uniform) to 24 (as coarse as the inside allows). Unless
  /// given 1, or 24 with a sizing that has `coarsest` or `growth`.
  std::optional<int> levels = {};
  Preset preset = Preset::kDefault;
  /// With kBothSides how far both sides go, else where the inside is cut off with flat faces.
  std::optional<Box> box = {};
  /// How large tets may be, and where: JSON as docs/sizing.md has it, or empty.
  std::string sizing = {};
  bool improve = false;    ///< move vertices to better the worst angles
  bool manifold = false;   ///< the boundary touches itself nowhere, whatever the field
  bool statistics = true;  ///< measure quality and boundary: a little slower
  bool faces = false;      ///< boundary faces beside the tets, with names: docs/faces.md
  /// Pieces of the surface with names of their own: JSON as docs/faces.md has it, or empty.
  /// They ask for faces, too. Which took none is told by Statistics::empty_face_regions; one
  /// with creases has its patches named after it.
  std::string face_regions = {};
  /// Hold the mesh's surface against the zero surface, and measure the shapes of all tets:
  /// Statistics has `fidelity` and `shapes`. Takes about as long as meshing, and asks for
  /// faces, too. Not of labels, in sessions, or for jobs: docs/report.md.
  bool fidelity = false;
  Coordinates coordinates = Coordinates::kAutomatic;
  std::vector<Field> fields = {};  ///< at most 16
  /// Which labels of a segmentation are meshed, and how; all of them unless given. Of what a
  /// server stores it says that it is a segmentation, and must be given. Only with those.
  std::optional<LabelChoice> labels = {};
};

/// How work is watched and stopped, here or on a server.
struct WorkOptions {
  int threads = 0;  ///< in this process; 0 takes every core
  /// Told how much of the mesh is made, 0 to 1, on any thread: from several at once where it is
  /// made here. Must not throw.
  std::function<void(double fraction)> progress = {};
  /// Work ends soon after a stop was requested, with kCancelled.
  std::stop_token stop = {};
  /// Work ends soon after this, with kDeadlineExceeded.
  std::optional<std::chrono::system_clock::time_point> deadline = {};
};

}  // namespace tetstream
