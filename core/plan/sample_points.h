// phi, its slope, and the values of fields at points that lie anywhere.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "core/base/cancel.h"
#include "core/base/types.h"
#include "core/plan/mesh_request.h"
#include "core/plan/prepared_mesh.h"
#include "core/plan/shape.h"

namespace tet {

/// Where samples of some points are written.
struct SampleColumns {
  std::span<double> phi;     ///< one a point, negative inside
  std::span<double> slopes;  ///< three a point: how fast phi grows along x, y and z
  std::span<float> fields;   ///< a row a point, one field after the other

  /// Those of `count` points from `first` on, where a point has `width` values of fields.
  SampleColumns part(std::size_t first, std::size_t count, std::size_t width) const noexcept {
    return {phi.subspan(first, count), slopes.subspan(3 * first, 3 * count),
            fields.subspan(width * first, width * count)};
  }
};

/// What a mesh of a request and a shape is made from, at any points: phi as it is meshed,
/// trilinear between voxels or the scene's, and its slope there; values of fields as vertices
/// get them. What is said of a point depends on the point alone. Immutable: any thread may ask.
class ShapeSampler {
 public:
  /// Errors: those of canonical, kInvalidArgument (several grids, or labels).
  static absl::StatusOr<ShapeSampler> make(Shape shape, MeshRequest request);

  const std::vector<FieldArray>& arrays() const noexcept { return header_.fields; }
  /// Values that a point has of all fields together.
  std::size_t width() const noexcept { return header_.field_values(); }
  /// Says what MeshHeader::inside_guess says of a mesh.
  const std::string& inside_guess() const noexcept { return header_.inside_guess; }

  /// Fills the columns, of as many points; all passed check_points. Parallel; run it on a
  /// TaskPool. If cancelled, the columns are not all filled.
  void sample(std::span<const WorldPoint> points,
              const SampleColumns& columns,
              const Cancellation& cancellation) const;

 private:
  ShapeSampler(Shape shape, MeshRequest request, MeshedField field);
  void sample_range(std::span<const WorldPoint> points, const SampleColumns& columns) const;

  Shape shape_;  ///< the field refers to it
  MeshRequest request_;
  MeshedField field_;
  MeshHeader header_;  ///< of a mesh whose vertices are the points, as far as fields ask of one
};

/// What is farther from the origin is no place: squares of squares of it stay finite.
inline constexpr double kMostOfAPoint = 1e30;

/// OK, or kInvalidArgument, naming the first point that is not finite or too far away by its
/// number, where the first of them has the number `first`.
absl::Status check_points(std::span<const WorldPoint> points, std::uint64_t first = 0);

/// Samples of points, in columns of their own.
struct PointSamples {
  std::vector<FieldArray> arrays;  ///< of the request's fields
  std::size_t width = 0;           ///< values that a point has of them
  std::string inside_guess;        ///< as MeshHeader::inside_guess
  std::vector<double> phi, slopes;
  std::vector<float> fields;

  /// Makes room for as many points.
  void resize(std::size_t points);
  SampleColumns columns() noexcept { return {phi, slopes, fields}; }
};

/// Room for samples of as many points.
PointSamples samples_for(const ShapeSampler& sampler, std::size_t points);

/// Samples all points. Parallel; run it on a TaskPool. Errors: those of ShapeSampler::make and
/// check_points, kCancelled, kDeadlineExceeded.
absl::StatusOr<PointSamples> sample_points(const Shape& shape,
                                           const MeshRequest& request,
                                           std::span<const WorldPoint> points,
                                           const Cancellation& cancellation = {});

}  // namespace tet
