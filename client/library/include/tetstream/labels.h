// Segmentations: of each voxel what it is a part of.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "tetstream/export.h"
#include "tetstream/mesh.h"
#include "tetstream/status.h"
#include "tetstream/volume.h"

namespace tetstream {

/// Whole numbers as somebody stores them.
using LabelValues = std::variant<std::span<const std::uint8_t>,
                                 std::span<const std::int8_t>,
                                 std::span<const std::uint16_t>,
                                 std::span<const std::int16_t>,
                                 std::span<const std::uint32_t>,
                                 std::span<const std::int32_t>,
                                 std::span<const std::uint64_t>,
                                 std::span<const std::int64_t>>;

/// Labels that somebody else holds, along three axes.
struct LabelArray {
  /// size[0] * size[1] * size[2] labels; voxel (i, j, k) is at (i * size[1] + j) * size[2] + k,
  /// as in a C array or a numpy array a[x, y, z].
  LabelValues values;
  std::array<std::size_t, 3> size{};
  Point origin{};  ///< the middle of voxel (0, 0, 0)
  /// From a voxel to the next one along each of the array's axes, world units: of any lengths
  /// and at any angles that leave a voxel some volume.
  std::array<Point, 3> steps{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
};

/// How often a segmentation has a label.
struct LabelCount {
  std::int64_t value = 0;
  std::uint64_t voxels = 0;
};

/// A segmentation, or level sets, ready to be meshed any number of times: docs/labels.md.
/// Copies share it; it is never changed, so any thread may use it.
class TETSTREAM_API Labels {
 public:
  /// Copies an array of labels. Errors: kInvalidArgument (no voxels, sizes that do not agree,
  /// a label beyond 63 bits), kFailedPrecondition (steps that leave a voxel no volume, more
  /// than 65,535 labels).
  static Result<Labels> from_voxels(const LabelArray& labels);
  /// Reads an image (docs/images.md), or a grid of whole numbers of a .vdb file. Errors: those
  /// of Volume::from_vdb; kFailedPrecondition (values that are no whole numbers, more than
  /// 65,535 labels).
  static Result<Labels> from_file(const std::string& path, const VdbOptions& options = {});

  /// Makes each of several volumes a label, 1, 2, ... in their order: droplets, or phases of a
  /// fluid. Where several are below their iso values the lowest one's label is taken, of equal
  /// ones the first. Errors: kInvalidArgument (no volumes, more than 64),
  /// kFailedPrecondition (a volume without an inside).
  static Result<Labels> from_level_sets(const std::vector<Volume>& volumes);

  /// By ascending value; 0 voxels of level sets.
  std::vector<LabelCount> counts() const;
  /// Lengths of a voxel's edges along the image's axes, world units; of the first level set.
  std::array<double, 3> voxel_edges() const noexcept;

  /// Writes an image of the NRRD format, whole or not at all: of the box of voxels that there
  /// are, so that a .vdb file's is meshed on another lattice. Errors: kUnavailable,
  /// kResourceExhausted (the disk), kFailedPrecondition (level sets).
  Status write_nrrd(const std::string& path) const;

  struct Impl;
  explicit Labels(std::shared_ptr<const Impl> impl);
  const Impl& impl() const noexcept { return *impl_; }

 private:
  std::shared_ptr<const Impl> impl_;
};

/// Labels from `first` to `last`, both included.
struct LabelRange {
  std::int64_t first = 0, last = 0;
};

/// How interfaces are smoothed: docs/labels.md#indicators.
enum class LabelSmoothing : std::uint8_t {
  kGauss,  ///< by a Gaussian
  kThin,   ///< less, so that sheets one voxel thin stay whole
  kNone,   ///< not at all: every stair is kept
};

/// Leaves of labels from `first` to `last`, by the values that they have when all is merged,
/// have edges of `size` at most; world units.
struct LabelSize {
  LabelRange labels = {};
  double size = 0;
};

/// What is asked of a segmentation, or of solids that are labels.
struct LabelChoice {
  /// The labels that are meshed, by the values that they have when all is merged; empty: all
  /// but the background.
  std::vector<LabelRange> only = {};
  /// Labels that become one, whose value is the first range's first.
  std::vector<std::vector<LabelRange>> merges = {};
  /// What is not chosen becomes this, and what lies beyond the image is it.
  std::int64_t background = 0;
  bool mesh_background = false;  ///< up to the request's box, or beyond the image
  /// What labels are called; values that the image does not have are passed over.
  std::vector<MeshLabel> names = {};
  LabelSmoothing smoothing = LabelSmoothing::kGauss;
  double smooth = 0.7;  ///< the Gaussian's width, voxels; at most 4
  /// How large leaves of some labels may be, none below the spacing; where two hold of a label,
  /// the smaller one. With sizes, `Request::levels` is as many as there can be unless given.
  std::vector<LabelSize> sizes = {};
};

/// Reads what labels are called: a table of ITK-SNAP, 3D Slicer or FreeSurfer, or JSON. Errors:
/// kNotFound (no such file), kInvalidArgument (with the line).
TETSTREAM_API Result<std::vector<MeshLabel>> read_label_names(const std::string& path);

}  // namespace tetstream
