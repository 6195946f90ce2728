// The labels of a brick's nodes and of those around it, and where they change: what a mesh of
// labels is made from.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "core/base/cancel.h"
#include "core/base/types.h"
#include "core/labels/face_point.h"
#include "core/labels/interface_probe.h"
#include "core/labels/label.h"
#include "core/lattice/bcc.h"
#include "core/stuffing/cut_edges.h"

namespace tet {

/// Columns by halo index: labels of corners and centres in [-2, 9]^3, and for each edge with an
/// end in [-1, 8]^3 whose ends differ, where: a fraction from its lower node, in [0, 1]. The
/// rest is unspecified.
struct LabelSamples {
  alignas(64) std::array<std::array<Label, kHaloNodes>, kNodeKinds> label;
  alignas(64) std::array<std::array<float, kHaloNodes>, kEdgeFamilies> fraction;
};

/// Edges whose ends have different labels, among those with an end in [-1, 8]^3.
void find_label_changes(const std::array<std::array<Label, kHaloNodes>, kNodeKinds>& label,
                        EdgeSets& changes) noexcept;

/// Samples labels brick by brick, asked in the order of its functions; not thread-safe: one per
/// task. A node's label, an edge's
/// fraction and a face's point depend on the node, the edge and the face alone, whichever
/// bricks see them.
class LabelSampler {
 public:
  virtual ~LabelSampler() = default;

  /// From now on it looks at `cancellation`, which must outlive it, within bricks that are much
  /// work. Labels are made up once a look found it cancelled.
  virtual void stop_when(const Cancellation& /*cancellation*/) {}

  /// The label of every node in the brick and its halo, where that is told without looking at
  /// them: of most bricks.
  virtual std::optional<Label> one_label(BrickCoord brick) = 0;

  /// Fills in the labels.
  virtual void sample_labels(BrickCoord brick, LabelSamples& samples) = 0;
  /// Fills in the fractions of `changes`, for the brick whose labels were sampled last.
  virtual void sample_fractions(BrickCoord brick,
                                const EdgeSets& changes,
                                LabelSamples& samples) = 0;
  /// Writes where the three labels of each face are equal, as far as the face's nodes tell:
  /// anywhere in the face's plane, or not finite. Faces are of nodes in [-1, 8]^3, and of the
  /// brick whose labels were sampled last: `samples` has them.
  virtual void sample_triples(BrickCoord brick,
                              std::span<const TripleFace> faces,
                              const LabelSamples& samples,
                              std::span<FacePoint> points) = 0;
};

/// What labels are sampled from. Immutable: any thread may ask for a sampler or a probe.
class LabelSource {
 public:
  virtual ~LabelSource() = default;
  virtual std::unique_ptr<LabelSampler> sampler() const = 0;
  /// Tells where labels meet between the nodes; null where that is not known.
  virtual std::unique_ptr<InterfaceProbe> probe() const { return nullptr; }
};

}  // namespace tet
