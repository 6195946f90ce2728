#include "tests/core/graded/background_places.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <random>
#include <set>

#include "core/graded/background_mesh.h"
#include "core/graded/graded_tree.h"
#include "tests/support/scenes.h"

namespace tet::test {
namespace {

constexpr int kLevels = 3, kEdge = 32;  // finest cells that the leaves cover

/// Cells of every level refined at random places; with a box, that has all of them.
GradedTree random_tree(std::mt19937& random, bool in_box) {
  LeafRules rules{.max_levels = kLevels, .layers = kGradedLayers};
  rules.refined.resize(kLevels + 1);
  for (int level = 1; level <= kLevels; ++level) {
    CellSetBuilder cells;
    const auto cell = [&] { return static_cast<std::int32_t>(random() % (kEdge >> level)); };
    for (int k = 0; k < 4; ++k) {
      const std::int32_t x = cell(), y = cell(), z = cell();
      BrickMask mask;
      mask.set(x & 7, y & 7, z & 7);
      cells.add({x >> 3, y >> 3, z >> 3}, mask);
    }
    rules.refined[static_cast<std::size_t>(level)] = cells.take();
  }
  constexpr std::int32_t kLastBrick = kEdge / kBrickEdge - 1;
  FoundBricks found;
  found.inside.push_back({{0, 0, 0}, {kLastBrick, kLastBrick, kLastBrick}});
  std::optional<BrickBox> box;
  if (in_box) box = found.inside.front();
  return grow_graded_tree({found, box}, rules, {});
}

/// All of it inside.
BackgroundMesh background_of(const GradedTree& tree) {
  SceneWriter writer;
  writer.add(scene::Sphere{1000});
  const Scene everything = writer.scene();
  PhiField field;
  field.scene = &everything;
  return make_background(tree, field, {});
}

/// Within the leaves that a mesh can be made of: around it they end.
bool is_covered(LatticeCoord node) {
  const auto [least, most] = std::minmax({node.x, node.y, node.z});
  return least >= 0 && most <= 2 * kEdge;
}

/// Those that a node may move along: out of no face of the box.
std::vector<std::vector<PlacedNode::Edge>> edges_of_nodes(const BackgroundMesh& mesh) {
  std::vector<std::vector<PlacedNode::Edge>> edges(mesh.node.size());
  for (std::size_t i = 0; i < mesh.tets.size(); ++i) {
    const NodeId from = mesh.tets[i];
    for (std::size_t k = i / 4 * 4; k < i / 4 * 4 + 4; ++k) {
      const NodeId to = mesh.tets[k];
      if (k == i || (mesh.faces_at(from) & ~mesh.faces_at(to)) != 0) continue;
      edges[from].push_back({mesh.node[to] - mesh.node[from], mesh.kind[to]});
    }
  }
  for (auto& of_node : edges) {
    std::ranges::sort(of_node);
    of_node.erase(std::unique(of_node.begin(), of_node.end()), of_node.end());
  }
  return edges;
}

/// Turned by one of the 48 isometries, moved so that its first node is at the origin.
class Turn {
 public:
  explicit Turn(int number) : number_(number) {}

  LatticeCoord operator()(LatticeCoord at) const {
    std::array<std::int32_t, 3> c{at.x, at.y, at.z};
    std::rotate(c.begin(), c.begin() + number_ % 3, c.end());
    if (number_ / 3 % 2 != 0) std::swap(c[0], c[1]);
    for (int axis = 0; axis < 3; ++axis) {
      if ((number_ / 6 >> axis & 1) != 0) {
        c[static_cast<std::size_t>(axis)] = -c[static_cast<std::size_t>(axis)];
      }
    }
    return {c[0], c[1], c[2]};
  }
  static constexpr int kCount = 48;

 private:
  int number_;
};

/// Nodes in the order of their places, the first at the origin.
PlacedTet turned(PlacedTet tet, const Turn& turn) {
  for (PlacedNode& node : tet) {
    node.at = turn(node.at);
    for (PlacedNode::Edge& edge : node.edges) edge.along = turn(edge.along);
  }
  std::ranges::sort(tet, {}, &PlacedNode::at);
  const LatticeCoord origin = tet[0].at;
  for (PlacedNode& node : tet) node.at = node.at - origin;
  return tet;
}

/// A tet without its nodes' edges.
using Shape = PlacedTet;

Shape shape_of(const PlacedTet& tet) {
  Shape shape = tet;
  for (PlacedNode& node : shape) node.edges.clear();
  return shape;
}

/// Tets by shape, one of all that are alike up to an isometry, with the edges of all.
class ShapeCollector {
 public:
  void add(const PlacedTet& tet) {
    Shape least = shape_of(turned(tet, Turn(0)));
    for (int i = 1; i < Turn::kCount; ++i) {
      least = std::min(least, shape_of(turned(tet, Turn(i))));
    }
    for (int i = 0; i < Turn::kCount; ++i) {
      const PlacedTet other = turned(tet, Turn(i));
      if (shape_of(other) != least) continue;
      std::array<std::set<PlacedNode::Edge>, 4>& edges = edges_[least];
      for (std::size_t k = 0; k < 4; ++k) {
        edges[k].insert(other[k].edges.begin(), other[k].edges.end());
      }
    }
  }

  std::vector<PlacedTet> tets() const {
    std::vector<PlacedTet> tets;
    for (const auto& [shape, edges] : edges_) {
      PlacedTet tet = shape;
      for (std::size_t k = 0; k < 4; ++k) tet[k].edges.assign(edges[k].begin(), edges[k].end());
      const LatticeCoord a = tet[1].at, b = tet[2].at, c = tet[3].at;
      if (internal::triple_product(a, b, c) < 0) std::swap(tet[2], tet[3]);
      tets.push_back(tet);
    }
    return tets;
  }

 private:
  std::map<Shape, std::array<std::set<PlacedNode::Edge>, 4>> edges_;
};

LatticeCoord divided(LatticeCoord at, int level) {
  return {at.x >> level, at.y >> level, at.z >> level};
}

}  // namespace

std::vector<PlacedTet> placed_tets(int trees, bool cut) {
  std::mt19937 random(1);
  std::set<PlacedTet> seen;
  ShapeCollector collector;
  for (int i = 0; i < trees; ++i) {
    const BackgroundMesh mesh = background_of(random_tree(random, cut && i % 2 == 1));
    const auto edges = edges_of_nodes(mesh);
    for (std::size_t t = 0; t < mesh.tets.size(); t += 4) {
      const NodeId* node = &mesh.tets[t];
      if (!std::all_of(node, node + 4, [&](NodeId n) { return is_covered(mesh.node[n]); })) {
        continue;
      }
      const auto level_of = [&](NodeId n) { return std::int32_t{mesh.level[n]}; };
      const std::int32_t level = std::min(
          {level_of(node[0]), level_of(node[1]), level_of(node[2]), level_of(node[3])});
      PlacedTet tet;
      for (std::size_t k = 0; k < 4; ++k) {
        tet[k] = {divided(mesh.node[node[k]] - mesh.node[node[0]], level),
                  level_of(node[k]) - level, mesh.kind[node[k]], mesh.faces_at(node[k]) != 0,
                  edges[node[k]]};
        for (PlacedNode::Edge& edge : tet[k].edges) edge.along = divided(edge.along, level);
      }
      if (seen.insert(tet).second) collector.add(tet);
    }
  }
  return collector.tets();
}

}  // namespace tet::test
