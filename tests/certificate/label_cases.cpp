#include "tests/certificate/label_cases.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "core/labels/label_tables.h"
#include "tests/certificate/isometries.h"

namespace tet::certificate {
namespace {

Place in_units(LatticeCoord at) { return {kUnit * at.x, kUnit * at.y, kUnit * at.z}; }

/// The mean of corners whose coordinates are multiples of their number.
Corner mean_of(const std::vector<Corner>& corners) {
  Corner mean;
  const int count = static_cast<int>(corners.size());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const Corner& corner : corners) mean.base[axis] += corner.base[axis];
    mean.base[axis] /= count;
    for (std::size_t k = 0; k < kParameters; ++k) {
      for (const Corner& corner : corners) mean.along[k][axis] += corner.along[k][axis];
      mean.along[k][axis] /= count;
    }
  }
  return mean;
}

/// A lattice tet with its labels, and where its nodes lie.
struct LabelledNodes {
  const TetShape& shape;
  std::array<LatticeCoord, 4> node;
  std::array<Label, 4> label;
  int direction;  ///< of the joker
  WarpLimits limits;
  LabelRule rule;

  double alpha(int of_direction) const {
    return static_cast<double>(is_long(of_direction) ? limits.alpha_long : limits.alpha_short);
  }
};

/// Makes a problem of one tet.
class LabelProblem {
 public:
  LabelProblem(const LabelledNodes& nodes, std::string name) : nodes_(nodes) {
    problem_.name = std::move(name);
  }

  void add(const LabelTetCorners& corners) {
    Tet tet;
    for (std::size_t i = 0; i < 4; ++i) tet[i] = corner_of(corners[i]);
    if (nodes_.shape.negative) std::swap(tet[2], tet[3]);
    problem_.tets.push_back(tet);
  }

  /// Says that of two nodes of one label the first has the longer column to `other`, or as long
  /// a one.
  void add_order(std::size_t longer, std::size_t shorter, std::size_t other) {
    if (nodes_.rule == LabelRule::kShorterColumn) std::swap(longer, shorter);
    const auto i = cut_[edge_between(longer, other)], j = cut_[edge_between(shorter, other)];
    // Where one of the columns is no corner's, the order says nothing that its range does not.
    if (i && j) problem_.orders.push_back({*i, *j});
  }

  const Problem& problem() const { return problem_; }

 private:
  Corner corner_of(LabelCorner corner) {
    if (corner < 4) return node(corner);
    if (corner < 10) return cut(static_cast<std::size_t>(corner - 4));
    if (corner == kLabelMiddle) {
      if (nodes_.rule == LabelRule::kMiddleAtANode) return node(0);
      return mean_of({node(0), node(1), node(2), node(3)});
    }
    return triple(static_cast<std::size_t>(corner - 10));
  }

  /// A point of a face whose shares of its nodes are a sixth each at least: from the first node
  /// along the way to the second, and from there towards the third, but no farther.
  Corner anywhere_on(const std::array<std::uint8_t, 3>& nodes) {
    constexpr int kShares = 6;
    const auto at = [&](std::size_t i) { return nodes_.node[nodes[i]]; };
    const Place first = in_units(at(1) - at(0)), second = in_units(at(2) - at(1));
    Corner corner{in_units(at(0)), {}};
    for (std::size_t axis = 0; axis < 3; ++axis) corner.base[axis] += first[axis] / kShares;
    const Range range{1.0 / kShares, 1 - 2.0 / kShares};
    const std::uint8_t longer = add_slide({corner.base, first, range});
    const std::uint8_t shorter = add_slide({corner.base, second, range});
    corner.along[longer] = first;
    corner.along[shorter] = second;
    problem_.orders.push_back({longer, shorter});
    return corner;
  }

  Corner triple(std::size_t opposite_node) {
    const auto [a, b, c] = nodes_of_face(opposite_node);
    if (nodes_.rule == LabelRule::kTripleAtACut) return cut(edge_between(a, b));
    if (nodes_.rule == LabelRule::kTripleAnywhere) {
      if (!triple_[opposite_node]) triple_[opposite_node] = anywhere_on({a, b, c});
      return *triple_[opposite_node];
    }
    return mean_of({cut(edge_between(a, b)), cut(edge_between(b, c)), cut(edge_between(a, c))});
  }

  Corner node(std::size_t i) {
    Corner corner{in_units(nodes_.node[i]), {}};
    if (nodes_.label[i] != kJoker) return corner;
    if (!warp_) {
      warp_ = add_slide({corner.base,
                         in_units(kDirection[static_cast<std::size_t>(nodes_.direction)]),
                         {0, reach()}});
    }
    corner.along[*warp_] = problem_.slide[*warp_].along;
    return corner;
  }

  double reach() const {
    constexpr double kHalf = 0.5;
    return nodes_.rule == LabelRule::kJokersFarther ? kHalf : nodes_.alpha(nodes_.direction);
  }

  /// A cut point by its column, alpha from both ends: that of the node whose label another node
  /// has too, or of the lower one.
  Corner cut(std::size_t edge) {
    auto [low, high] = kTetEdge[edge];
    if (std::ranges::count(nodes_.label, nodes_.label[high]) > 1) std::swap(low, high);
    auto& parameter = cut_[edge];
    if (!parameter) {
      const double alpha = nodes_.rule == LabelRule::kCutsAnywhere
                               ? 0
                               : nodes_.alpha(family_direction(nodes_.shape.edge_family[edge]));
      parameter = add_slide({in_units(nodes_.node[low]),
                             in_units(nodes_.node[high] - nodes_.node[low]),
                             {alpha - kTieSlack, 1 - alpha + kTieSlack}});
    }
    Corner corner{in_units(nodes_.node[low]), {}};
    corner.along[*parameter] = problem_.slide[*parameter].along;
    return corner;
  }

  std::uint8_t add_slide(const Slide& slide) {
    problem_.slide[problem_.parameter_count] = slide;
    return static_cast<std::uint8_t>(problem_.parameter_count++);
  }

  const LabelledNodes& nodes_;
  Problem problem_;
  std::array<std::optional<std::uint8_t>, kTetEdge.size()> cut_;
  std::optional<std::uint8_t> warp_;
  std::array<std::optional<Corner>, kTetFaces> triple_;
};

/// The nodes of a tet of three labels by role, as core/labels has them.
std::array<std::uint8_t, 4> roles_of(const std::array<Label, 4>& label) {
  std::array<std::uint8_t, 4> roles{};
  for (std::uint8_t i = 0; i < 4; ++i) {
    for (std::uint8_t j = static_cast<std::uint8_t>(i + 1); j < 4; ++j) {
      if (label[i] == label[j]) roles = {i, j, 0, 0};
    }
  }
  std::size_t next = 2;
  for (std::uint8_t i = 0; i < 4; ++i) {
    if (i != roles[0] && i != roles[1]) roles[next++] = i;
  }
  return roles;
}

LabelCorner by_role(LabelCorner corner, const std::array<std::uint8_t, 4>& roles) {
  if (corner < 4) return roles[corner];
  if (corner == kLabelMiddle) return corner;
  if (corner >= 10) return label_triple(roles[static_cast<std::size_t>(corner - 10)]);
  const auto [a, b] = kTetEdge[static_cast<std::size_t>(corner - 4)];
  return label_cut(roles[a], roles[b]);
}

bool is_odd(const std::array<std::uint8_t, 4>& roles) {
  int inversions = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = i + 1; j < 4; ++j) inversions += roles[i] > roles[j] ? 1 : 0;
  }
  return inversions % 2 != 0;
}

/// A problem of one tet that is told in roles.
LabelProblem problem_in_roles(const LabelledNodes& nodes,
                              const LabelTetCorners& in_roles,
                              const std::array<std::uint8_t, 4>& roles) {
  LabelTetCorners corners;
  for (std::size_t i = 0; i < 4; ++i) corners[i] = by_role(in_roles[i], roles);
  if (is_odd(roles)) std::swap(corners[2], corners[3]);
  LabelProblem problem(nodes, "AABC");
  problem.add(corners);
  return problem;
}

void add_three_labels(const LabelledNodes& nodes, std::vector<Problem>& problems) {
  const std::array<std::uint8_t, 4> roles = roles_of(nodes.label);
  for (std::size_t starts = 0; starts < 4; ++starts) {
    const bool second_at_b = (starts & 2) != 0, second_at_c = (starts & 1) != 0;
    const auto& fan = kLabelFans[second_at_b ? 1 : 0][second_at_c ? 1 : 0];
    for (std::size_t t = 0; t < fan.count; ++t) {
      LabelProblem problem = problem_in_roles(nodes, fan.tet[t], roles);
      const auto order = [&](bool second, std::size_t other) {
        problem.add_order(roles[second ? 1 : 0], roles[second ? 0 : 1], roles[other]);
      };
      order(second_at_b, 2);
      order(second_at_c, 3);
      problems.push_back(problem.problem());
    }
  }
}

template <class Tets>
void add_tets(const LabelledNodes& nodes,
              const Tets& tets,
              const std::string& name,
              std::vector<Problem>& problems) {
  for (std::size_t t = 0; t < tets.count; ++t) {
    LabelProblem problem(nodes, name);
    problem.add(tets.tet[t]);
    problems.push_back(problem.problem());
  }
}

}  // namespace

std::vector<Problem> label_problems_of(const TetShape& shape,
                                       const std::array<std::uint16_t, 4>& label,
                                       int direction,
                                       const WarpLimits& limits,
                                       LabelRule rule) {
  LabelledNodes nodes{shape, {}, label, direction, limits, rule};
  for (std::size_t i = 0; i < 4; ++i) {
    nodes.node[i] = node_coord(shape.kind[i], halo_index(0, 0, 0) + shape.offset[i]);
  }
  std::vector<Problem> problems;
  const auto joker = std::ranges::find(label, kJoker);
  auto sorted = label;
  std::ranges::sort(sorted);
  if (joker != label.end()) {
    add_tets(nodes, kJokerCones[static_cast<std::size_t>(joker - label.begin())], "ABC0",
             problems);
  } else if (std::ranges::adjacent_find(sorted) != sorted.end()) {
    add_three_labels(nodes, problems);
  } else {
    add_tets(nodes, kFourLabels, "ABCD", problems);
  }
  return problems;
}

std::vector<Problem> label_cases(const WarpLimits& limits, LabelRule rule) {
  std::vector<Problem> problems;
  const auto add = [&](const TetShape& shape, const std::array<Label, 4>& label,
                       int direction) {
    const auto more = label_problems_of(shape, label, direction, limits, rule);
    problems.insert(problems.end(), more.begin(), more.end());
  };
  for (const TetShape& shape : kTetShape) {
    add(shape, {1, 2, 3, 4}, 0);
    for (std::size_t i = 0; i < 4; ++i) {
      std::array<Label, 4> label{1, 2, 3, 4};
      label[i] = kJoker;
      for (int direction = 0; direction < kDirections; ++direction) {
        add(shape, label, direction);
      }
      for (std::size_t j = i + 1; j < 4; ++j) {
        label = {1, 2, 3, 4};
        label[j] = label[i];
        add(shape, label, 0);
      }
    }
  }
  return without_copies(problems);
}

}  // namespace tet::certificate
