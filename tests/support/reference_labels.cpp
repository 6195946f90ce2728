#include "tests/support/reference_labels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "tests/support/reference_lattice.h"

namespace tet::test {
namespace {

/// One tet of the mesh: its label, and its corners.
struct Piece {
  Label label;
  std::array<std::vector<LatticeCoord>, 4> corner;
};

class ReferenceMesh : private ReferenceLattice {
 public:
  ReferenceMesh(const LabelFunctions& functions,
                const BrickBox& domain,
                const std::vector<Label>& left_out)
      : ReferenceLattice(functions), left_out_(left_out), counts_(left_out.size()) {
    low_ = {16 * domain.min.x, 16 * domain.min.y, 16 * domain.min.z};
    high_ = {16 * (domain.max.x + 1), 16 * (domain.max.y + 1), 16 * (domain.max.z + 1)};
  }

  std::vector<LabelReference> make() {
    for (int x = low_.x + 1; x < high_.x; x += 2) {
      for (int y = low_.y + 1; y < high_.y; y += 2) {
        for (int z = low_.z + 1; z < high_.z; z += 2) add_cell({x, y, z});
      }
    }
    for (const auto& [key, meshes] : used_) {
      for (std::size_t m = 0; m < counts_.size(); ++m) counts_[m].vertices += meshes >> m & 1;
    }
    return std::move(counts_);
  }

 private:
  void add_cell(Node centre) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto at = [&](int along, int u, int v) {
        std::array<int, 3> c{centre.x, centre.y, centre.z};
        c[static_cast<std::size_t>(axis)] += along;
        c[static_cast<std::size_t>((axis + 1) % 3)] += u;
        c[static_cast<std::size_t>((axis + 2) % 3)] += v;
        return Node{c[0], c[1], c[2]};
      };
      const std::array<std::array<int, 2>, 4> around{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
      const auto corner = [&](std::size_t turn, int along) {
        const auto [u, v] = around[turn & 3];
        return at(along, u, v);
      };
      const Node other = at(2, 0, 0);
      if (within(other)) {
        for (std::size_t turn = 0; turn < 4; ++turn) {
          add_lattice_tet({centre, other, corner(turn, 1), corner(turn + 1, 1)});
        }
      }
      for (const int side : {-1, 1}) {
        if (within(at(2 * side, 0, 0))) continue;
        add_half_pyramids(centre,
                          {corner(0, side), corner(1, side), corner(2, side), corner(3, side)});
      }
    }
  }

  bool within(Node n) const {
    return n.x > low_.x && n.x < high_.x && n.y > low_.y && n.y < high_.y && n.z > low_.z &&
           n.z < high_.z;
  }

  void add_half_pyramids(Node centre, std::array<Node, 4> corner) {
    const Label l = label(centre);
    for (const Node& n : corner) {
      if (label(n) != l) return;
    }
    if (l == kJoker) return;
    // Either diagonal gives the same volume, vertices and number.
    emit({l, {Key{centre}, {corner[0]}, {corner[1]}, {corner[2]}}});
    emit({l, {Key{centre}, {corner[0]}, {corner[2]}, {corner[3]}}});
  }

  /// Notes tets of a label, and their corners, in every mesh that has it.
  void add(Label label, std::uint64_t tets, double volume, const std::vector<Key>& corners) {
    unsigned meshes = 0;
    for (std::size_t m = 0; m < counts_.size(); ++m) {
      if (label == left_out_[m]) continue;
      meshes |= 1U << m;
      counts_[m].tets += tets;
      counts_[m].tets_of[label] += tets;
      counts_[m].volume += volume;
      for (const Key& key : corners) {
        if (key.size() == 1 && !moved(key[0])) counts_[m].staying[key[0]] = label;
      }
    }
    if (meshes == 0) return;
    for (const Key& key : corners) used_[key] |= meshes;
  }

  void emit(const Piece& piece) {
    std::array<Place, 4> places;
    for (std::size_t i = 0; i < 4; ++i) places[i] = place(piece.corner[i]);
    add(piece.label, 1, std::abs(six_volumes(places)) / 6,
        {piece.corner.begin(), piece.corner.end()});
  }

  void emit_all(const std::vector<Piece>& pieces) {
    for (const Piece& piece : pieces) emit(piece);
  }

  void add_lattice_tet(std::array<Node, 4> node) {
    std::ranges::sort(node);
    std::set<Label> labels;
    std::vector<Node> jokers;
    for (const Node& n : node) {
      if (moved(n)) {
        jokers.push_back(n);
      } else {
        labels.insert(original(n));
      }
    }
    const Piece whole{0, {Key{node[0]}, {node[1]}, {node[2]}, {node[3]}}};
    if (labels.empty()) {
      emit({elected_of(node), whole.corner});
    } else if (labels.size() == 1) {
      emit({*labels.begin(), whole.corner});
    } else if (!jokers.empty()) {
      cone_from_joker(node, jokers[0]);
    } else if (labels.size() == 2) {
      two_labels(node);
    } else {
      many_labels(node);
    }
  }

  std::vector<Piece> cone(const std::array<Node, 3>& over, const Key& apex) {
    std::vector<Piece> pieces;
    for (const auto& [l, triangle] : divided_face(over)) {
      pieces.push_back({l, {triangle[0], triangle[1], triangle[2], apex}});
    }
    return pieces;
  }

  void cone_from_joker(const std::array<Node, 4>& node, Node joker) {
    std::array<Node, 3> others;
    std::ranges::copy_if(node, others.begin(), [&](Node n) { return n != joker; });
    emit_all(cone(others, {joker}));
  }

  std::vector<Piece> fan(const std::array<Node, 4>& node) {
    std::vector<Piece> pieces;
    const Key apex(node.begin(), node.end());
    for (std::size_t skip = 0; skip < 4; ++skip) {
      std::array<Node, 3> others;
      std::size_t next = 0;
      for (std::size_t i = 0; i < 4; ++i) {
        if (i != skip) others[next++] = node[i];
      }
      const auto more = cone(others, apex);
      pieces.insert(pieces.end(), more.begin(), more.end());
    }
    return pieces;
  }

  ReferenceAngles angles_of(const std::vector<Piece>& pieces) {
    ReferenceAngles angles;
    for (const Piece& piece : pieces) {
      angles.add({place(piece.corner[0]), place(piece.corner[1]), place(piece.corner[2]),
                  place(piece.corner[3])});
    }
    return angles;
  }

  /// AAAB and AABB: each label's part is a tet, or a prism of three tets (of six around the
  /// middle of the quad, where both labels force their own diagonal on it).
  void two_labels(const std::array<Node, 4>& node) {
    std::map<Label, std::vector<Node>> of;
    for (const Node& n : node) of[original(n)].push_back(n);
    const auto& [a, first] = *of.begin();
    const auto& [b, second] = *of.rbegin();
    if (first.size() != 2) {
      const bool single_first = first.size() == 1;
      const Node single = single_first ? first[0] : second[0];
      const std::vector<Node>& three = single_first ? second : first;
      emit({single_first ? a : b,
            {Key{single}, edge(single, three[0]), edge(single, three[1]),
             edge(single, three[2])}});
      add_prism_by_volume(
          single_first ? b : a, {Key{three[0]}, {three[1]}, {three[2]}},
          {edge(three[0], single), edge(three[1], single), edge(three[2], single)}, 3);
      return;
    }
    const auto forced = [&](const std::vector<Node>& plus, const std::vector<Node>& minus) {
      const bool at_first = starts(plus[0], plus[1], minus[0]) == plus[1];
      const bool at_second = starts(plus[0], plus[1], minus[1]) == plus[1];
      return at_first == at_second ? 0 : at_second ? 2 : 1;
    };
    const int one = forced(first, second), other = forced(second, first);
    const bool is_fan = one != 0 && other != 0 && one != other;
    for (const auto& [l, plus] : of) {
      const std::vector<Node>& minus = l == a ? second : first;
      add_prism_by_volume(l, {Key{plus[0]}, edge(plus[0], minus[0]), edge(plus[0], minus[1])},
                          {Key{plus[1]}, edge(plus[1], minus[0]), edge(plus[1], minus[1])},
                          is_fan ? 6 : 3);
    }
    if (!is_fan) return;
    used_[Key(node.begin(), node.end())] = ~0U;  // both labels meet there
  }

  /// How a prism is divided is not told here, only how often. All its quads but that between
  /// two and two labels are flat; there both parts are measured with the same diagonal, so that
  /// the sum of their volumes is right.
  void add_prism_by_volume(Label l,
                           const std::array<Key, 3>& bottom,
                           const std::array<Key, 3>& top,
                           std::uint64_t tets) {
    std::array<Place, 3> low, high;
    for (std::size_t i = 0; i < 3; ++i) {
      low[i] = place(bottom[i]);
      high[i] = place(top[i]);
    }
    double volume = std::abs(six_volumes({low[0], low[1], low[2], high[2]}));
    volume += std::abs(six_volumes({low[0], low[1], high[1], high[2]}));
    volume += std::abs(six_volumes({low[0], high[0], high[1], high[2]}));
    std::vector<Key> corners(bottom.begin(), bottom.end());
    corners.insert(corners.end(), top.begin(), top.end());
    add(l, tets, volume / 6, corners);
  }

  void many_labels(const std::array<Node, 4>& node) {
    const Key middle(node.begin(), node.end());
    std::vector<Place> triples, nodes;
    for (std::size_t skip = 0; skip < 4; ++skip) {
      std::set<Label> labels;
      Key others;
      for (std::size_t i = 0; i < 4; ++i) {
        if (i == skip) continue;
        labels.insert(original(node[i]));
        others.push_back(node[i]);
      }
      if (labels.size() == 3) triples.push_back(place(others));
    }
    for (const Node& n : node) nodes.push_back(place({n}));
    std::vector<Piece> pieces;
    if (triples.size() == 2) pieces = twelve(node);
    const std::vector<Piece> around = fan(node);
    if (pieces.empty() || !angles_of(pieces).good() || !fills(node, pieces)) {
      for (const double part : {1.0, 0.75, 0.5, 0.25, 0.0}) {
        middle_[middle] = towards(mean(nodes), mean(triples), part);
        pieces = around;
        if (angles_of(pieces).good()) break;
      }
    }
    emit_all(pieces);
  }

  /// Whether pieces fill a lattice tet, and none is turned inside out.
  bool fills(const std::array<Node, 4>& node, const std::vector<Piece>& pieces) {
    double volume = 0;
    for (const Piece& piece : pieces) {
      volume += std::abs(six_volumes({place(piece.corner[0]), place(piece.corner[1]),
                                      place(piece.corner[2]), place(piece.corner[3])}));
    }
    const double whole = std::abs(
        six_volumes({place({node[0]}), place({node[1]}), place({node[2]}), place({node[3]})}));
    return volume < whole * (1 + 1e-9);
  }

  /// The good one among all twelves, if there is one; else any.
  std::vector<Piece> twelve(std::array<Node, 4> node) {
    std::size_t p = 0, q = 1;
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = i + 1; j < 4; ++j) {
        if (original(node[i]) == original(node[j])) {
          p = i;
          q = j;
        }
      }
    }
    const Node a1 = node[p], a2 = node[q];
    std::vector<Node> others;
    for (const Node& n : node) {
      if (n != a1 && n != a2) others.push_back(n);
    }
    std::vector<Piece> last;
    for (unsigned bits = 0; bits < 8; ++bits) {
      std::vector<Piece> pieces;
      bool possible = true;
      for (std::size_t side = 0; side < 2; ++side) {
        const Node b = others[side], c = others[1 - side];
        const bool shared = (bits & 1) != 0, own = (bits >> (1 + side) & 1) != 0;
        const Key t1 = face(a1, b, c), t2 = face(a2, b, c);
        possible = possible && prism(original(b), {Key{b}, edge(a1, b), edge(a2, b)},
                                     {edge(b, c), t1, t2}, {true, true, !own}, pieces);
        possible = possible &&
                   prism(original(a1), {Key{a1}, edge(a1, b), t1}, {Key{a2}, edge(a2, b), t2},
                         {starts(a1, a2, b) == a1, !shared, !own}, pieces);
      }
      if (!possible) continue;
      last = pieces;
      if (angles_of(last).good() && fills(node, last)) return last;
    }
    return last;
  }

  /// `first` says of columns 01, 02 and 12 whether the diagonal starts at the first one's
  /// bottom.
  static bool prism(Label l,
                    const std::array<Key, 3>& bottom,
                    const std::array<Key, 3>& top,
                    const std::array<bool, 3>& first,
                    std::vector<Piece>& out) {
    std::array<std::size_t, 3> order{0, 1, 2};
    do {
      const auto before = [&](std::size_t i, std::size_t j) {
        return std::ranges::find(order, i) < std::ranges::find(order, j);
      };
      if (before(0, 1) == first[0] && before(0, 2) == first[1] && before(1, 2) == first[2]) {
        const auto [i, j, k] = order;
        out.push_back({l, {bottom[i], bottom[j], bottom[k], top[k]}});
        out.push_back({l, {bottom[i], bottom[j], top[j], top[k]}});
        out.push_back({l, {bottom[i], top[i], top[j], top[k]}});
        return true;
      }
    } while (std::next_permutation(order.begin(), order.end()));
    return false;
  }

  const std::vector<Label> left_out_;
  Node low_, high_;
  std::map<Key, unsigned> used_;  ///< a bit for each mesh that has the vertex
  std::vector<LabelReference> counts_;
};

}  // namespace

std::vector<LabelReference> reference_labels(const LabelFunctions& functions,
                                             const BrickBox& domain,
                                             const std::vector<Label>& left_out) {
  return ReferenceMesh(functions, domain, left_out).make();
}

}  // namespace tet::test
