#include "tests/certificate/stuffing_cases.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>

#include "core/lattice/bcc.h"
#include "core/stuffing/stencil.h"
#include "tests/certificate/isometries.h"

namespace tet::certificate {
namespace {

Place scaled(LatticeCoord at, int scale) { return {scale * at.x, scale * at.y, scale * at.z}; }

/// A lattice tet with its signs, and the direction in which each `0` node moved.
struct SignedTet {
  const TetShape& shape;
  std::array<LatticeCoord, 4> node;
  std::array<NodeSign, 4> sign;
  std::array<int, 4> direction;  // of `0` nodes
  WarpLimits limits;

  std::size_t number() const { return stencil_number(sign[0], sign[1], sign[2], sign[3]); }
  double alpha(bool long_edge) const {
    return static_cast<double>(long_edge ? limits.alpha_long : limits.alpha_short);
  }
};

std::string name_of(const SignedTet& tet) {
  std::string name;
  for (const auto& [sign, letter] : {
           std::pair{ NodeSign::kPlus, '+'},
           { NodeSign::kZero, '0'},
           {NodeSign::kMinus, '-'}
  }) {
    name.append(static_cast<std::size_t>(std::count(tet.sign.begin(), tet.sign.end(), sign)),
                letter);
  }
  return name;
}

/// A cut point by the length of the column from its `+` node, in [alpha, 1 - alpha].
Slide cut_slide(const SignedTet& tet, std::size_t edge) {
  auto [plus, minus] = kTetEdge[edge];
  if (tet.sign[plus] != NodeSign::kPlus) std::swap(plus, minus);
  const double alpha = tet.alpha(is_long(family_direction(tet.shape.edge_family[edge])));
  return {
      scaled(tet.node[plus], kUnit),
      scaled(tet.node[minus] - tet.node[plus], kUnit),
      {alpha, 1 - alpha}
  };
}

/// A `0` node: moved along one of its edges by less than alpha; by nothing, if it was zero.
Slide warp_slide(const SignedTet& tet, std::size_t node) {
  const int direction = tet.direction[node];
  return {
      scaled(tet.node[node], kUnit),
      scaled(kDirection[static_cast<std::size_t>(direction)], kUnit),
      {0, tet.alpha(is_long(direction))}
  };
}

/// Makes problems of a tet's stencils.
class ProblemBuilder {
 public:
  ProblemBuilder(const SignedTet& tet, ColumnRule rule) : tet_(tet), rule_(rule) {
    problem_.name = name_of(tet);
  }

  Tet tet_of(const std::array<StencilVertex, 4>& vertices) {
    Tet out;
    for (std::size_t i = 0; i < 4; ++i) out[i] = corner_of(vertices[i]);
    if (tet_.shape.negative) std::swap(out[2], out[3]);
    return out;
  }

  /// Says that the column from `longer` to `minus` is not the shorter one. A column that no
  /// corner of the tets stands on limits the other one's range.
  void order(std::size_t longer, std::size_t shorter, std::size_t minus) {
    if (rule_ == ColumnRule::kShorter) std::swap(longer, shorter);
    const std::size_t upper = edge_between(longer, minus), lower = edge_between(shorter, minus);
    const auto i = parameter_[4 + upper], j = parameter_[4 + lower];
    if (i && j) {
      problem_.orders.push_back({*i, *j});
    } else if (i) {
      double& low = problem_.slide[*i].range.low;
      low = std::max(low, cut_slide(tet_, lower).range.low - kTieSlack);
    } else if (j) {
      double& high = problem_.slide[*j].range.high;
      high = std::min(high, cut_slide(tet_, upper).range.high + kTieSlack);
    }
  }

  Problem& problem() { return problem_; }

 private:
  Corner corner_of(StencilVertex vertex) {
    if (vertex < 4 && tet_.sign[vertex] != NodeSign::kZero) {
      return {scaled(tet_.node[vertex], kUnit), {}};
    }
    auto& parameter = parameter_[vertex];
    if (!parameter) {
      parameter = static_cast<std::uint8_t>(problem_.parameter_count++);
      problem_.slide[*parameter] = vertex < 4
                                       ? warp_slide(tet_, vertex)
                                       : cut_slide(tet_, static_cast<std::size_t>(vertex - 4));
    }
    const Slide& slide = problem_.slide[*parameter];
    Corner corner{slide.base, {}};
    corner.along[*parameter] = slide.along;
    return corner;
  }

  const SignedTet& tet_;
  ColumnRule rule_;
  Problem problem_;
  std::array<std::optional<std::uint8_t>, 10> parameter_;  // of each stencil vertex
};

/// What the three bits of a choice say, in the words of core/stuffing/stencil.h.
struct Choice {
  struct Comparison {
    std::size_t longer, shorter, minus;
  };
  std::vector<Comparison> columns;
  bool by_angle = false;  ///< bit 2 was free: the surface diagonal is the better one
};

/// Nothing for a choice that no comparison of lengths makes.
std::optional<Choice> read_choice(const SignedTet& tet, std::size_t choice) {
  std::vector<std::size_t> plus, minus;
  for (std::size_t i = 0; i < 4; ++i) {
    if (tet.sign[i] == NodeSign::kPlus) plus.push_back(i);
    if (tet.sign[i] == NodeSign::kMinus) minus.push_back(i);
  }
  const bool first = (choice & 1) != 0, second = (choice & 2) != 0, third = (choice & 4) != 0;
  const auto compared = [&](bool second_longer, std::size_t i, std::size_t j, std::size_t at) {
    const std::size_t p = plus[i], q = plus[j];
    return second_longer ? Choice::Comparison{q, p, minus[at]}
                         : Choice::Comparison{p, q, minus[at]};
  };
  Choice out;
  if (plus.size() < 2 || minus.empty()) return choice == 0 ? std::optional(out) : std::nullopt;
  out.columns.push_back(compared(first, 0, 1, 0));
  if (plus.size() == 3) {
    if (first == third && second != first) return std::nullopt;  // cyclic
    out.columns.push_back(compared(second, 0, 2, 0));
    out.columns.push_back(compared(third, 1, 2, 0));
  } else if (minus.size() == 2) {
    if (first != second && third != second) return std::nullopt;  // would close a cycle
    out.columns.push_back(compared(second, 0, 1, 1));
    out.by_angle = first == second;
  } else if (second || third) {
    return std::nullopt;
  }
  return out;
}

bool on_surface_quad(const std::array<StencilVertex, 4>& tet) {
  return std::count_if(tet.begin(), tet.end(), [](StencilVertex v) { return v >= 4; }) == 3;
}

void add_stencil(const SignedTet& tet,
                 std::size_t choice,
                 ColumnRule rule,
                 std::vector<Problem>& problems) {
  const std::optional<Choice> read = read_choice(tet, choice);
  if (!read) return;
  const auto& of_signs = kStencils[tet.number()];
  const auto add = [&](ProblemBuilder& builder) {
    for (const auto& [longer, shorter, minus] : read->columns) {
      builder.order(longer, shorter, minus);
    }
    problems.push_back(builder.problem());
  };
  ProblemBuilder pair(tet, rule);
  pair.problem().name += " by angle";
  for (std::size_t t = 0; t < of_signs[choice].tet_count; ++t) {
    const auto& vertices = of_signs[choice].tet[t];
    if (read->by_angle && on_surface_quad(vertices)) {
      pair.problem().tets.push_back(pair.tet_of(vertices));
    } else {
      ProblemBuilder single(tet, rule);
      single.problem().tets.push_back(single.tet_of(vertices));
      add(single);
    }
  }
  if (!read->by_angle) return;
  pair.problem().contender = pair.problem().tets;
  const Stencil& other = of_signs[choice ^ 4];
  for (std::size_t t = 0; t < other.tet_count; ++t) {
    if (on_surface_quad(other.tet[t])) {
      pair.problem().rival.push_back(pair.tet_of(other.tet[t]));
    }
  }
  add(pair);
}

/// Whether two `0` nodes moved towards each other: an edge has one cut point, which violates no
/// more than one of its ends, as both limits are below one half.
bool share_a_cut_point(const SignedTet& tet) {
  for (const auto& [i, j] : kTetEdge) {
    if (tet.sign[i] != NodeSign::kZero || tet.sign[j] != NodeSign::kZero) continue;
    const LatticeCoord along = tet.node[j] - tet.node[i];
    if (kDirection[static_cast<std::size_t>(tet.direction[i])] == along &&
        tet.direction[j] == opposite(tet.direction[i])) {
      return true;
    }
  }
  return false;
}

/// Calls `visit` with every sign and every direction of the `0` nodes.
template <class Visit>
void for_each_signed_tet(const WarpLimits& limits, const Visit& visit) {
  for (const TetShape& shape : kTetShape) {
    SignedTet tet{shape, {}, {}, {}, limits};
    for (std::size_t i = 0; i < 4; ++i) {
      tet.node[i] = node_coord(shape.kind[i], halo_index(0, 0, 0) + shape.offset[i]);
    }
    for (std::size_t number = 0; number < kStencilCases; ++number) {
      std::size_t digits = number, combinations = 1;
      for (NodeSign& sign : tet.sign) {
        sign = static_cast<NodeSign>(digits % 3);
        digits /= 3;
        if (sign == NodeSign::kZero) combinations *= kDirections;
      }
      for (std::size_t combination = 0; combination < combinations; ++combination) {
        std::size_t rest = combination;
        for (std::size_t i = 0; i < 4; ++i) {
          if (tet.sign[i] != NodeSign::kZero) continue;
          tet.direction[i] = static_cast<int>(rest % kDirections);
          rest /= kDirections;
        }
        if (!share_a_cut_point(tet)) visit(tet);
      }
    }
  }
}

}  // namespace

std::vector<Problem> one_sided_cases(const WarpLimits& limits, ColumnRule rule) {
  std::vector<Problem> problems;
  for_each_signed_tet(limits, [&](const SignedTet& tet) {
    for (std::size_t choice = 0; choice < kStencilChoices; ++choice) {
      add_stencil(tet, choice, rule, problems);
    }
  });
  return without_copies(problems);
}

}  // namespace tet::certificate
