// Where three labels meet on the faces of the lattice: as near to where they are equal as the
// angles of all tets at the face allow.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/labels/face_point.h"
#include "core/labels/label_samples.h"
#include "core/labels/lattice_faces.h"
#include "core/labels/warp_labels.h"
#include "core/lattice/bcc.h"
#include "core/stuffing/local_vertices.h"

namespace tet {

/// A triple point's shares of its face's nodes are no less, unless it is the mean of the cut
/// points.
inline constexpr double kLeastShare = 0.125;

/// What decides where a face's triple point lies.
struct FaceAround {
  std::array<LatticeCoord, 3> node;  ///< ascending
  std::array<float, 3> fraction;     ///< of the cut points on edges 01, 12 and 02
  /// What the face's six triangles may be joined to, on either side of it: a joker, or the mean
  /// of the nodes of the tet there.
  std::array<WorldPoint, 2> apex;
};

/// The triple point that is nearest to `wished`, of four on the way there from the mean of the
/// cut points, with which all tets that join the face to an `apex` are good; else that mean.
FacePoint put_triple_point(const FaceAround& face, const FacePoint& wished) noexcept;

/// Triple points of a brick's own faces, and of those of its own tets.
class TriplePoints {
 public:
  /// Asks the sampler, which sampled the brick last, for what is wished.
  void find(LabelSampler& sampler,
            BrickCoord brick,
            const LabelSamples& samples,
            const WarpedLabels& warped);

  /// Lowest nodes of the faces that have one.
  const HaloSet& of_family(std::size_t family) const noexcept { return faces_[family]; }
  /// The triple point of a face that has one.
  FacePoint at(std::size_t family, int low) const noexcept {
    return point_[family][slot_of(low)];
  }

 private:
  static std::size_t slot_of(int low) noexcept {
    return static_cast<std::size_t>(
        node_slot((low >> 8) - 2, (low >> 4 & 15) - 2, (low & 15) - 2));
  }

  std::array<HaloSet, kFaceFamilies> faces_;
  std::array<std::array<FacePoint, kSlotsOfKind>, kFaceFamilies> point_;
  std::vector<TripleFace> list_;
  std::vector<FacePoint> wished_;
};

}  // namespace tet
