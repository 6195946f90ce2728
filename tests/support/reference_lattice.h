// A lattice of labels after the warp, and how its faces are divided: maps over nodes.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "tests/support/label_sources.h"
#include "tests/support/reference_angles.h"

namespace tet::test {

/// What the rules say of nodes, edges and faces, whatever tet they belong to.
class ReferenceLattice {
 protected:
  using Node = LatticeCoord;
  /// A vertex: a node, the nodes of an edge, of a face, or of a tet.
  using Key = std::vector<Node>;
  using Place = ReferencePlace;

  explicit ReferenceLattice(const LabelFunctions& functions) : functions_(functions) {}

  static constexpr float kLong = 0.2F, kShort = 0.3F;

  static bool is_long_edge(Node a, Node b) { return ((a.x ^ b.x) & 1) == 0; }
  static float alpha(Node a, Node b) { return is_long_edge(a, b) ? kLong : kShort; }

  Label original(Node n) const { return functions_.label(n); }

  /// From the lower node.
  float fraction(Node a, Node b) const {
    const Node low = std::min(a, b), step = std::max(a, b) - low;
    const auto direction = std::ranges::find(kDirection, step) - kDirection.begin();
    return functions_.fraction(low, static_cast<int>(direction));
  }

  /// Seen from a node, in [0, 1]; and whether the cut point violates it.
  std::pair<float, bool> seen(Node from, Node to) const {
    const float t = fraction(from, to), rest = 1 - t;
    const bool is_low = from < to;
    const float share = is_low ? t : rest;
    const bool nearer = is_low ? t < rest : !(t < rest);
    return {share, nearer && share < alpha(from, to)};
  }

  /// The neighbour along whose edge a node moves.
  std::optional<Node> moved(Node n) {
    const auto known = moved_.find(n);
    if (known != moved_.end()) return known->second;
    std::map<Label, bool> violated;
    std::optional<Node> nearest;
    float least = 0;
    for (const Node& step : kDirection) {
      const Node to = n + step;
      if (original(to) == original(n)) continue;
      const auto [share, violates] = seen(n, to);
      violated[original(to)] |= violates;
      const float length =
          share * (is_long_edge(n, to) ? 1.0F : static_cast<float>(std::numbers::sqrt3 / 2));
      if (violates && (!nearest || length < least)) {
        nearest = to;
        least = length;
      }
    }
    for (const auto& [label, any] : violated) {
      if (!any) nearest.reset();
    }
    return moved_[n] = nearest;
  }

  Label label(Node n) { return moved(n) ? kJoker : original(n); }

  Place on_edge(Node a, Node b, double t) const {
    const Node low = std::min(a, b), high = std::max(a, b);
    return {0.5 * (low.x + t * (high.x - low.x)), 0.5 * (low.y + t * (high.y - low.y)),
            0.5 * (low.z + t * (high.z - low.z))};
  }

  Place place(const Key& key) {
    if (key.size() == 1) {
      const Node n = key[0];
      if (const auto to = moved(n)) {
        return on_edge(n, *to, static_cast<double>(fraction(n, *to)));
      }
      return {0.5 * n.x, 0.5 * n.y, 0.5 * n.z};
    }
    if (key.size() == 2) {
      const float a = alpha(key[0], key[1]);
      return on_edge(key[0], key[1],
                     static_cast<double>(std::clamp(fraction(key[0], key[1]), a, 1 - a)));
    }
    if (key.size() == 3) {
      const auto known = triple_.find(key);
      return known != triple_.end() ? known->second : triple_[key] = triple(key);
    }
    return middle_.at(key);
  }

  static Place towards(const Place& from, const Place& to, double part) {
    return {from[0] + part * (to[0] - from[0]), from[1] + part * (to[1] - from[1]),
            from[2] + part * (to[2] - from[2])};
  }

  /// Where three labels meet on a face: near what is wished, where all tets at it are good.
  Place triple(const Key& key) {
    const std::array<Place, 3> node{place({key[0]}), place({key[1]}), place({key[2]})};
    const std::array<Place, 3> cut{place(edge(key[0], key[1])), place(edge(key[1], key[2])),
                                   place(edge(key[0], key[2]))};
    const Place amid = mean({cut[0], cut[1], cut[2]});
    const FacePoint wished = functions_.triple({key[0], key[1], key[2]});
    if (!std::isfinite(wished.second + wished.third)) return amid;
    double b = static_cast<double>(wished.second), c = static_cast<double>(wished.third);
    if (const double far = std::max(std::abs(b - 1.0 / 3), std::abs(c - 1.0 / 3)); far > 4) {
      b = 1.0 / 3 + (b - 1.0 / 3) * 4 / far;
      c = 1.0 / 3 + (c - 1.0 / 3) * 4 / far;
    }
    Place goal;
    for (std::size_t i = 0; i < 3; ++i) {
      goal[i] = (1 - b - c) * node[0][i] + b * node[1][i] + c * node[2][i];
    }
    constexpr double kLeastShare = 0.125;
    if (std::min({b, c, 1 - b - c}) < kLeastShare) {
      // Where all shares are large enough is a smaller triangle with the same middle.
      const Place centre = mean({node[0], node[1], node[2]});
      std::array<Place, 3> tip;
      for (std::size_t i = 0; i < 3; ++i)
        tip[i] = towards(centre, node[i], 1 - 3 * kLeastShare);
      std::optional<Place> nearest;
      for (std::size_t i = 0; i < 3; ++i) {
        const Place side = minus(tip[(i + 1) % 3], tip[i]);
        const double part = dot_of(minus(goal, tip[i]), side) / dot_of(side, side);
        const Place at = towards(tip[i], tip[(i + 1) % 3], std::clamp(part, 0.0, 1.0));
        const auto far = [&](const Place& p) { return dot_of(minus(p, goal), minus(p, goal)); };
        if (!nearest || far(at) < far(*nearest)) nearest = at;
      }
      goal = *nearest;
    }
    for (const double part : {1.0, 0.75, 0.5, 0.25}) {
      const Place at = towards(amid, goal, part);
      if (is_good_triple(key, cut, at)) return at;
    }
    return amid;
  }

  bool is_good_triple(const Key& key, const std::array<Place, 3>& cut, const Place& at) {
    // A node, and which of the cut points.
    constexpr std::array<std::array<std::size_t, 2>, 6> kTriangles{
        {{0, 0}, {1, 0}, {1, 1}, {2, 1}, {2, 2}, {0, 2}}};
    ReferenceAngles angles;
    for (const Node& step : kDirection) {
      const Node beyond = key[0] + step;
      const auto is_next_to = [&](Node n) {
        return std::ranges::find(kDirection, beyond - n) != kDirection.end();
      };
      if (!is_next_to(key[1]) || !is_next_to(key[2])) continue;
      const Place apex =
          moved(beyond)
              ? place({beyond})
              : mean({place({key[0]}), place({key[1]}), place({key[2]}), place({beyond})});
      for (const auto& [n, c] : kTriangles) {
        angles.add({place({key[n]}), cut[c], at, apex});
      }
    }
    return angles.good();
  }

  static Key edge(Node a, Node b) { return {std::min(a, b), std::max(a, b)}; }
  static Key face(Node a, Node b, Node c) {
    Key key{a, b, c};
    std::ranges::sort(key);
    return key;
  }

  Label elected_of(const std::array<Node, 4>& node) {
    std::map<Label, int> votes;
    for (const Node& n : node) {
      ++votes[original(n)];
      ++votes[original(*moved(n))];
    }
    Label best = 0;
    int most = 0;
    for (const auto& [l, count] : votes) {
      if (count < most) continue;
      best = l;
      most = count;
    }
    return best;
  }

  /// A face's triangles, each with the label of its part.
  std::vector<std::pair<Label, std::array<Key, 3>>> divided_face(const std::array<Node, 3>& n) {
    std::vector<std::pair<Label, std::array<Key, 3>>> triangles;
    const std::array<Label, 3> l{label(n[0]), label(n[1]), label(n[2])};
    std::set<Label> labels;
    for (const Label of : l) {
      if (of != kJoker) labels.insert(of);
    }
    if (labels.size() == 3) {
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
          if (i != j)
            triangles.push_back({l[i], {Key{n[i]}, edge(n[i], n[j]), face(n[0], n[1], n[2])}});
        }
      }
      return triangles;
    }
    if (labels.size() == 1) {
      triangles.push_back({*labels.begin(), {Key{n[0]}, {n[1]}, {n[2]}}});
      return triangles;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t a = (i + 1) % 3, b = (i + 2) % 3;
      if (l[i] == kJoker) {  // a joker, A, B
        triangles.push_back({l[a], {Key{n[i]}, {n[a]}, edge(n[a], n[b])}});
        triangles.push_back({l[b], {Key{n[i]}, {n[b]}, edge(n[a], n[b])}});
      } else if (l[a] == l[b] && l[a] != kJoker) {  // A A B
        triangles.push_back({l[i], {Key{n[i]}, edge(n[i], n[a]), edge(n[i], n[b])}});
        const Node longer = starts(n[a], n[b], n[i]);
        const Node shorter = longer == n[a] ? n[b] : n[a];
        triangles.push_back({l[a], {Key{longer}, {shorter}, edge(shorter, n[i])}});
        triangles.push_back({l[a], {Key{longer}, edge(shorter, n[i]), edge(longer, n[i])}});
      }
    }
    return triangles;
  }

  float column(Node from, Node to) const {
    const float a = alpha(from, to), t = std::clamp(fraction(from, to), a, 1 - a);
    return from < to ? t : 1 - t;
  }
  /// Returns, of two nodes of one label, that with the longer column, or else the lower.
  Node starts(Node a, Node b, Node other) const {
    const Node low = std::min(a, b), high = std::max(a, b);
    return column(high, other) > column(low, other) ? high : low;
  }

  std::map<Key, Place> middle_;

 private:
  const LabelFunctions& functions_;
  std::map<Node, std::optional<Node>> moved_;
  std::map<Key, Place> triple_;
};

}  // namespace tet::test
