#include "tests/certificate/sliding_cases.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>

namespace tet::certificate {
namespace {

constexpr std::size_t kEdges = kTetEdge.size();

Place scaled(LatticeCoord at) { return {kUnit * at.x, kUnit * at.y, kUnit * at.z}; }

Place quarter_sum(const std::vector<Place>& places) {
  Place sum{};
  for (const Place& at : places) {
    for (std::size_t axis = 0; axis < 3; ++axis) sum[axis] += at[axis];
  }
  for (int& coordinate : sum) coordinate /= 4;
  return sum;
}

NodeSign opposite(NodeSign sign) { return static_cast<NodeSign>(2 - static_cast<int>(sign)); }

/// Returns the tet as the outside sees it.
SlidingTet flipped(SlidingTet tet) {
  for (NodeSign& sign : tet.sign) sign = opposite(sign);
  return tet;
}

std::size_t number_of(const SlidingTet& tet) {
  return stencil_number(tet.sign[0], tet.sign[1], tet.sign[2], tet.sign[3]);
}

std::vector<std::size_t> nodes_of(const SlidingTet& tet, NodeSign sign) {
  std::vector<std::size_t> nodes;
  for (std::size_t i = 0; i < 4; ++i) {
    if (tet.sign[i] == sign) nodes.push_back(i);
  }
  return nodes;
}

std::string name_of(const SlidingTet& tet) {
  return std::string(nodes_of(tet, NodeSign::kPlus).size(), '+') +
         std::string(nodes_of(tet, NodeSign::kZero).size(), '0') +
         std::string(nodes_of(tet, NodeSign::kMinus).size(), '-');
}

/// What is compared to divide the faces of a tet: lengths of the columns on two edges.
struct Comparison {
  std::size_t longer = 0, shorter = 0;  // edges, by kTetEdge
};

/// What is known of the columns of a tet when it is divided in some way.
///
/// A column is measured from the `+` node of the inside. The outside's, which are measured from
/// the other end, are the longer the shorter those are.
class ColumnOrders {
 public:
  void add(Comparison compared) { above_[compared.longer][compared.shorter] = true; }

  /// What follows from what was added, too.
  std::vector<Comparison> all() const {
    auto above = above_;
    for (std::size_t k = 0; k < kEdges; ++k) {
      for (std::size_t i = 0; i < kEdges; ++i) {
        for (std::size_t j = 0; j < kEdges; ++j) {
          above[i][j] = above[i][j] || (above[i][k] && above[k][j]);
        }
      }
    }
    std::vector<Comparison> orders;
    for (std::size_t i = 0; i < kEdges; ++i) {
      for (std::size_t j = 0; j < kEdges; ++j) {
        if (i != j && above[i][j]) orders.push_back({i, j});
      }
    }
    return orders;
  }

 private:
  std::array<std::array<bool, kEdges>, kEdges> above_{};
};

/// Makes problems of tets of one region's stencils.
class ProblemBuilder {
 public:
  ProblemBuilder(const SlidingTet& inside, std::string name) : inside_(inside) {
    problem_.name = std::move(name);
  }

  Tet tet_of(const std::array<StencilVertex, 4>& vertices) {
    Tet out;
    for (std::size_t i = 0; i < 4; ++i) out[i] = corner_of(vertices[i]);
    if (inside_.negative) std::swap(out[2], out[3]);
    return out;
  }

  /// The problem, with the orders of its columns. A column that no corner stands on limits the
  /// range of the other one.
  Problem with_orders(const ColumnOrders& orders) {
    for (const auto& [longer, shorter] : orders.all()) {
      const auto i = parameter_[cut_on_edge(longer)], j = parameter_[cut_on_edge(shorter)];
      if (i && j) {
        problem_.orders.push_back({*i, *j});
      } else if (i) {
        double& low = problem_.slide[*i].range.low;
        low = std::max(low, cut_slide(shorter).range.low - kTieSlack);
      } else if (j) {
        double& high = problem_.slide[*j].range.high;
        high = std::min(high, cut_slide(longer).range.high + kTieSlack);
      }
    }
    return problem_;
  }

  Problem problem_;

 private:
  Corner corner_of(StencilVertex vertex) {
    if (vertex == kQuadCentre) return middle_of_cuts();
    if (vertex < 4 && inside_.sign[vertex] != NodeSign::kZero) {
      return {scaled(inside_.node[vertex]), {}};
    }
    auto& parameter = parameter_[vertex];
    if (!parameter) {
      parameter = static_cast<std::uint8_t>(problem_.parameter_count++);
      problem_.slide[*parameter] =
          vertex < 4 ? warp_slide(vertex) : cut_slide(static_cast<std::size_t>(vertex - 4));
    }
    const Slide& slide = problem_.slide[*parameter];
    Corner corner{slide.base, {}};
    corner.along[*parameter] = slide.along;
    return corner;
  }

  Corner middle_of_cuts() {
    std::vector<Corner> cuts;
    for (std::size_t e = 0; e < kEdges; ++e) {
      if (is_cut(e)) cuts.push_back(corner_of(cut_on_edge(e)));
    }
    std::vector<Place> bases;
    bases.reserve(cuts.size());
    for (const Corner& cut : cuts) bases.push_back(cut.base);
    Corner middle{quarter_sum(bases), {}};
    for (std::size_t k = 0; k < kParameters; ++k) {
      std::vector<Place> alongs;
      alongs.reserve(cuts.size());
      for (const Corner& cut : cuts) alongs.push_back(cut.along[k]);
      middle.along[k] = quarter_sum(alongs);
    }
    return middle;
  }

  bool is_cut(std::size_t edge) const {
    const auto [i, j] = kTetEdge[edge];
    return inside_.sign[i] != NodeSign::kZero && inside_.sign[j] == opposite(inside_.sign[i]);
  }

  /// A cut point by the length of the column from its `+` node, alpha from both ends; at
  /// restored nodes this is float's 1 - alpha, which is rounded.
  Slide cut_slide(std::size_t edge) const {
    auto [plus, minus] = kTetEdge[edge];
    if (inside_.sign[plus] != NodeSign::kPlus) std::swap(plus, minus);
    return {
        scaled(inside_.node[plus]),
        scaled(inside_.node[minus] - inside_.node[plus]),
        {inside_.alpha[plus][minus] - kTieSlack, 1 - inside_.alpha[minus][plus] + kTieSlack}};
  }

  /// A `0` node: moved along one of its edges by less than alpha; by nothing, if it was zero.
  Slide warp_slide(std::size_t node) const {
    return {scaled(inside_.node[node]), scaled(inside_.way[node]), {0, inside_.reach[node]}};
  }

  const SlidingTet& inside_;
  std::array<std::optional<std::uint8_t>, kStencilVertices> parameter_;
};

bool on_surface_quad(const std::array<StencilVertex, 4>& tet) {
  return std::count_if(tet.begin(), tet.end(), [](StencilVertex v) { return v >= 4; }) == 3;
}

using StencilTets = std::span<const std::array<StencilVertex, 4>>;

StencilTets stencil_of(const SlidingTet& region, std::size_t choice) {
  const Stencil& stencil = kStencils[number_of(region)][choice];
  return StencilTets(stencil.tet).first(stencil.tet_count);
}

StencilTets fan_of(const SlidingTet& region, std::size_t choice) {
  const Fan& fan = kFans[number_of(region)][choice];
  return StencilTets(fan.tet).first(fan.tet_count);
}

/// All the ways in which one lattice tet may be divided, by the rules of core/stuffing/cut_tet.
class Cases {
 public:
  Cases(const SlidingTet& inside, bool both_sides, ColumnRule columns)
      : inside_(inside),
        outside_(flipped(inside)),
        both_sides_(both_sides),
        columns_(columns) {}

  std::vector<Problem> make() {
    if (nodes_of(inside_, NodeSign::kPlus).size() == 2 &&
        nodes_of(inside_, NodeSign::kMinus).size() == 2) {
      add_quad();
      return problems_;
    }
    add_region(inside_);
    if (both_sides_) add_region(outside_);
    if (both_sides_ && name_of(inside_) == "0000") {
      ProblemBuilder builder(inside_, "0000");
      builder.problem_.tets.push_back(builder.tet_of({0, 1, 2, 3}));
      problems_.push_back(builder.problem_);
    }
    return problems_;
  }

 private:
  /// Whether node j's column to `end` is taken for the longer one, rather than node i's; as
  /// `region` measures it.
  Comparison compared(const SlidingTet& region,
                      std::size_t i,
                      std::size_t j,
                      std::size_t end,
                      bool second) const {
    Comparison out{edge_between(second ? j : i, end), edge_between(second ? i : j, end)};
    const bool turned = (&region == &outside_) != (columns_ == ColumnRule::kShorter);
    if (turned) std::swap(out.longer, out.shorter);
    return out;
  }

  void add_tets(const SlidingTet& region, StencilTets tets, const ColumnOrders& orders) {
    for (const auto& vertices : tets) {
      ProblemBuilder builder(inside_, name_of(region));
      builder.problem_.tets.push_back(builder.tet_of(vertices));
      problems_.push_back(builder.with_orders(orders));
    }
  }

  /// Everything but `++--`: columns alone decide.
  void add_region(const SlidingTet& region) {
    const auto plus = nodes_of(region, NodeSign::kPlus);
    const auto minus = nodes_of(region, NodeSign::kMinus);
    if (plus.size() < 2 || minus.empty()) return add_tets(region, stencil_of(region, 0), {});
    for (const bool first : {false, true}) {
      ColumnOrders orders;
      orders.add(compared(region, plus[0], plus[1], minus[0], first));
      if (plus.size() == 2) {  // ++0-
        add_tets(region, stencil_of(region, first ? 1 : 0), orders);
        continue;
      }
      for (const bool second : {false, true}) {  // +++-
        for (const bool third : {false, true}) {
          if (first == third && second != first) continue;  // lengths are never cyclic
          ColumnOrders all = orders;
          all.add(compared(region, plus[0], plus[2], minus[0], second));
          all.add(compared(region, plus[1], plus[2], minus[0], third));
          const std::size_t choice = (first ? 1 : 0) | (second ? 2 : 0) | (third ? 4 : 0);
          add_tets(region, stencil_of(region, choice), all);
        }
      }
    }
  }

  /// What a region's columns say of `++--`: the two low bits of its choice.
  struct Prism {
    bool first, second;

    std::size_t choice() const { return (first ? 1 : 0) | (second ? 2 : 0); }
    bool forces() const { return first != second; }
    bool forced_diagonal() const { return second; }
  };

  void add_orders(const SlidingTet& region, const Prism& prism, ColumnOrders& orders) const {
    const auto plus = nodes_of(region, NodeSign::kPlus);
    const auto minus = nodes_of(region, NodeSign::kMinus);
    orders.add(compared(region, plus[0], plus[1], minus[0], prism.first));
    orders.add(compared(region, plus[0], plus[1], minus[1], prism.second));
  }

  void add_quad() {
    for (std::size_t answers = 0; answers < (both_sides_ ? 16U : 4U); ++answers) {
      const Prism inside{(answers & 1) != 0, (answers & 2) != 0};
      const Prism outside{(answers & 4) != 0, (answers & 8) != 0};
      ColumnOrders orders;
      add_orders(inside_, inside, orders);
      if (both_sides_) add_orders(outside_, outside, orders);
      add_divided_quad(inside, outside, orders);
    }
  }

  void add_divided_quad(const Prism& inside, const Prism& outside, const ColumnOrders& orders) {
    const bool outside_forces = both_sides_ && outside.forces();
    if (inside.forces() && outside_forces &&
        inside.forced_diagonal() != outside.forced_diagonal()) {
      add_tets(inside_, fan_of(inside_, inside.choice()), orders);
      add_tets(outside_, fan_of(outside_, outside.choice()), orders);
    } else if (inside.forces()) {
      add_with_diagonal(inside, outside, inside.forced_diagonal(), orders);
    } else if (outside_forces) {
      add_with_diagonal(inside, outside, outside.forced_diagonal(), orders);
    } else {
      for (const bool diagonal : {false, true}) {
        add_better_diagonal(inside, outside, diagonal, orders);
      }
    }
  }

  void add_with_diagonal(const Prism& inside,
                         const Prism& outside,
                         bool diagonal,
                         const ColumnOrders& orders) {
    const std::size_t bit = diagonal ? 4 : 0;
    add_tets(inside_, stencil_of(inside_, inside.choice() | bit), orders);
    if (!both_sides_) return;
    add_tets(outside_, stencil_of(outside_, outside.choice() | bit), orders);
  }

  /// Adds the tets at the surface quad with the better diagonal; the other tets do not depend
  /// on it.
  void add_better_diagonal(const Prism& inside,
                           const Prism& outside,
                           bool diagonal,
                           const ColumnOrders& orders) {
    ProblemBuilder builder(inside_, name_of(inside_) + " by angle");
    Problem& problem = builder.problem_;
    const auto sort_tets = [&](const SlidingTet& region, const Prism& prism) {
      const std::size_t bit = diagonal ? 4 : 0;
      for (const auto& vertices : stencil_of(region, prism.choice() | bit)) {
        if (on_surface_quad(vertices)) {
          problem.tets.push_back(builder.tet_of(vertices));
        } else {
          add_tets(region, StencilTets(&vertices, 1), orders);
        }
      }
      for (const auto& vertices : stencil_of(region, prism.choice() | (bit ^ 4))) {
        if (on_surface_quad(vertices)) problem.rival.push_back(builder.tet_of(vertices));
      }
    };
    sort_tets(inside_, inside);
    if (both_sides_) sort_tets(outside_, outside);
    problem.contender = problem.tets;
    problems_.push_back(builder.with_orders(orders));
  }

  const SlidingTet& inside_;
  SlidingTet outside_;
  bool both_sides_;
  ColumnRule columns_;
  std::vector<Problem> problems_;
};

}  // namespace

std::vector<Problem> problems_of(const SlidingTet& tet, bool both_sides, ColumnRule columns) {
  return Cases(tet, both_sides, columns).make();
}

bool share_a_cut_point(const SlidingTet& tet) {
  for (const auto& [i, j] : kTetEdge) {
    if (tet.sign[i] != NodeSign::kZero || tet.sign[j] != NodeSign::kZero) continue;
    const LatticeCoord along = tet.node[j] - tet.node[i];
    if (tet.way[i] == along && tet.way[j] == LatticeCoord{} - along) return true;
  }
  return false;
}

}  // namespace tet::certificate
