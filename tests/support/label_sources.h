// Labels on the lattice that tests mesh: any function of nodes and edges.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/base/brick_box.h"
#include "core/labels/label_samples.h"
#include "core/lattice/bcc.h"

namespace tet::test {

/// A label for each node, in doubled coordinates, a fraction in [0, 1] for each edge, by its
/// lower node and its direction, and a point of each face, by its nodes in ascending order.
struct LabelFunctions {
  std::function<Label(LatticeCoord)> label;
  std::function<float(LatticeCoord, int)> fraction;
  std::function<FacePoint(const std::array<LatticeCoord, 3>&)> triple = amid_the_nodes;

  static FacePoint amid_the_nodes(const std::array<LatticeCoord, 3>&) {
    return {1.0F / 3, 1.0F / 3};
  }
  /// The value of a label anywhere, in units of the spacing, and its slope; the largest wins.
  /// Null where nothing is known between the nodes.
  std::function<ValueSlope(Label, const WorldPoint&)> indicator = nullptr;
};

/// Samples functions, node by node.
class FunctionLabels final : public LabelSource {
 public:
  explicit FunctionLabels(LabelFunctions functions) : functions_(std::move(functions)) {}

  const LabelFunctions& functions() const noexcept { return functions_; }
  std::unique_ptr<LabelSampler> sampler() const override;
  std::unique_ptr<InterfaceProbe> probe() const override;

 private:
  const LabelFunctions functions_;
};

/// Fractions drawn from a hash of the edge, among them many that are exactly 0, 1, a limit of
/// the warp, a half, or nearly one of these.
float hostile_fraction(std::uint32_t seed, LatticeCoord low, int direction);

/// Points drawn from a hash of the face: anywhere in it, at its nodes and edges, far off, and
/// none.
FacePoint hostile_triple(std::uint32_t seed, const std::array<LatticeCoord, 3>& face);

struct LabelCase {
  std::string name;
  LabelFunctions functions;
  std::size_t labels = 0;  ///< that there are
};

/// - any of 2 .. 1,000 labels at each node, with hostile fractions and points of faces;
/// - the same within a box of bricks, and label 0 around it: nothing meets the domain's faces;
/// - sheets and threads one node thin, and checkerboards;
/// - indicators: affine ones, of which the largest wins, so that three labels meet along lines
///   and four at points; four along whole lines; exact ties.
/// `box` is the domain.
std::vector<LabelCase> label_cases(const BrickBox& box, std::uint32_t seed);

/// Label 0 wherever a node, or a node next to it, is not well within the box.
LabelFunctions surrounded(LabelFunctions functions, const BrickBox& box);

}  // namespace tet::test
