#include "core/stuffing/topology/surface_parts.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/lattice/bcc.h"
#include "core/stuffing/count_tets.h"
#include "core/stuffing/topology/node_regions.h"
#include "core/stuffing/topology/surface_regions.h"
#include "core/stuffing/topology/surface_sheet.h"
#include "tests/core/stuffing/waves.h"
#include "tests/support/sanitized.h"

namespace tet {
namespace {

using test::lattice_of, test::Waves;

/// A vertex of the surface: its slot (see VertexOwner), and its node's halo index.
using Vertex = std::pair<std::size_t, int>;

/// The surface between some nodes, walked tet by tet.
class Surface {
 public:
  Surface(const WarpedLattice& lattice, const NodeSets& within)
      : lattice_(lattice), within_(within) {
    for (std::size_t s = 0; s < kTetShapes; ++s) {
      for_each_bit(halo_cube(-2, 9), [&](int cell) { add_tet(s, cell); });
    }
  }

  bool has(Vertex vertex) const { return parent_.contains(vertex); }
  Vertex root(Vertex vertex) const {
    while (parent_.at(vertex) != vertex) vertex = parent_.at(vertex);
    return vertex;
  }
  std::size_t count_parts() const {
    std::set<Vertex> roots;
    for (const auto& [vertex, parent] : parent_) roots.insert(root(vertex));
    return roots.size();
  }
  /// The vertices of each tet that has one of the brick's own nodes.
  const std::vector<std::vector<Vertex>>& at_own_nodes() const { return at_own_nodes_; }

 private:
  void add_tet(std::size_t number, int cell) {
    const TetShape& shape = kTetShape[number];
    std::vector<std::size_t> plus, minus;
    std::vector<Vertex> vertices;
    bool own = false;
    for (std::size_t i = 0; i < 4; ++i) {
      const int node = cell + shape.offset[i];
      own = own || kOwnNodes.test(node);
      if (!within_[shape.kind[i]].test(node)) continue;
      if (lattice_.zero[shape.kind[i]].test(node)) {
        vertices.emplace_back(shape.kind[i], node);
      } else {
        (lattice_.plus[shape.kind[i]].test(node) ? plus : minus).push_back(i);
      }
    }
    if (plus.size() == 1 && vertices.size() == 3) {
      const int behind = cell + kMirrored[number][plus[0]];
      const NodeKind kind = shape.kind[plus[0]];
      const bool in_halo = behind >= 0 && behind < kHaloNodes;
      if (!in_halo || !within_[kind].test(behind) || lattice_.plus[kind].test(behind)) return;
    } else if (plus.empty() || minus.empty()) {
      return;
    }
    for (std::size_t e = 0; e < kTetEdge.size(); ++e) {
      const auto [low, high] = kTetEdge[e];
      const auto on = [&](std::size_t a, std::size_t b) {
        return std::ranges::count(plus, a) != 0 && std::ranges::count(minus, b) != 0;
      };
      if (!on(low, high) && !on(high, low)) continue;
      vertices.emplace_back(kNodeKinds + shape.edge_family[e], cell + shape.offset[low]);
    }
    for (const Vertex& vertex : vertices) parent_.try_emplace(vertex, vertex);
    for (const Vertex& vertex : vertices) parent_[root(vertex)] = root(vertices[0]);
    if (own) at_own_nodes_.push_back(vertices);
  }

  const WarpedLattice& lattice_;
  const NodeSets& within_;
  std::map<Vertex, Vertex> parent_;
  std::vector<std::vector<Vertex>> at_own_nodes_;
};

/// All nodes around those that a brick sees: what hangs together here does so in the mesh.
constexpr HaloSet kAround = halo_cube(-2, 9);
const NodeSets kNodesAround{kAround, kAround};

/// The part of each vertex that is listed.
std::map<Vertex, std::uint16_t> part_of_vertices(const SurfaceParts& parts) {
  std::map<std::pair<std::array<std::int8_t, 3>, std::uint16_t>, std::uint16_t> by_element;
  for (const SurfaceLink& link : parts.links) {
    by_element[{link.to_brick, link.element}] = link.part;
  }
  for (const auto& [element, part] : parts.part_of) {
    by_element[{VertexOwner::kHere, element}] = part;
  }
  std::map<Vertex, std::uint16_t> found;
  for (std::size_t slot = 0; slot < kVertexSlots; ++slot) {
    for_each_bit(halo_cube(-1, 8), [&](int index) {
      const VertexOwner owner(index);
      const auto part = by_element.find({owner.brick, owner.element(slot)});
      if (part != by_element.end()) found[{slot, index}] = part->second;
    });
  }
  return found;
}

TEST(SurfaceSheet, IsOneOnlyWhereTheSurfaceHangsTogether) {
  int sheets = 0;
  for (std::uint32_t seed = 0; seed < test::sanitized_or(60U, 200U); ++seed) {
    SCOPED_TRACE(seed);
    const auto lattice = lattice_of(Waves(seed));
    if (!surface_sheet({lattice->plus, lattice->zero}).one) continue;
    ++sheets;
    EXPECT_LE(Surface(*lattice, kBrickStar).count_parts(), 1U);
  }
  EXPECT_GT(sheets, test::sanitized_or(5, 20));
}

TEST(SurfaceRegions, HaveOneSheetOnlyWhereTheSurfaceHangsTogether) {
  int sheets = 0;
  for (std::uint32_t seed = 0; seed < test::sanitized_or(60U, 200U); ++seed) {
    SCOPED_TRACE(seed);
    const Waves waves(seed);
    const auto lattice = lattice_of(waves);
    if (surface_sheet({lattice->plus, lattice->zero}).one) continue;
    if (!SurfaceRegions({lattice->plus, lattice->zero}).have_one_sheet()) continue;
    ++sheets;
    const auto around = lattice_of(waves, kAround);
    const Surface surface(*around, kNodesAround);
    std::set<Vertex> roots;
    for (const auto& vertices : surface.at_own_nodes()) roots.insert(surface.root(vertices[0]));
    EXPECT_LE(roots.size(), 1U);
  }
  EXPECT_GT(sheets, test::sanitized_or(1, 5));
}

TEST(PartsBetweenRegions, AreThoseOfTheSurfaceItself) {
  int told = 0;
  for (std::uint32_t seed = 0; seed < test::sanitized_or(20U, 100U); ++seed) {
    SCOPED_TRACE(seed);
    const Waves waves(seed);
    const auto lattice = lattice_of(waves), around = lattice_of(waves, kAround);
    const auto parts = parts_between_regions(SurfaceRegions({lattice->plus, lattice->zero}));
    if (!parts) continue;
    ++told;
    EXPECT_TRUE(std::ranges::is_sorted(parts->part_of));
    const Surface surface(*around, kNodesAround);
    std::map<Vertex, std::uint16_t> part_of = part_of_vertices(*parts);
    // What is one part hangs together.
    std::set<std::pair<std::uint16_t, Vertex>> pairs;
    std::set<std::uint16_t> with_vertices;
    for (const auto& [vertex, part] : part_of) {
      ASSERT_TRUE(surface.has(vertex));
      pairs.emplace(part, surface.root(vertex));
      with_vertices.insert(part);
    }
    EXPECT_EQ(pairs.size(), with_vertices.size());
    // What hangs together in a tet is one part, and has every vertex of the brick's own.
    for (const auto& vertices : surface.at_own_nodes()) {
      ASSERT_GT(parts->count, 0);
      std::set<std::uint16_t> of_tet;
      for (const Vertex& vertex : vertices) {
        const auto part = part_of.find(vertex);
        if (part != part_of.end()) of_tet.insert(part->second);
        EXPECT_TRUE(part != part_of.end() || parts->count == 1 ||
                    !kOwnNodes.test(vertex.second));
      }
      EXPECT_LE(of_tet.size(), 1U);
    }
  }
  EXPECT_GT(told, test::sanitized_or(10, 80));
}

TEST(SurfaceParts, HasNoPartOfAVertexThatIsNotListed) {
  SurfaceParts parts;
  std::size_t near = 0;
  EXPECT_FALSE(parts.part(7, near).has_value());
  parts.count = 2;
  EXPECT_FALSE(parts.part(7, near).has_value());
  parts.part_of = {{6, 0}, {8, 1}};
  EXPECT_FALSE(parts.part(7, near).has_value());
  EXPECT_FALSE(parts.part(9, near).has_value());
  EXPECT_EQ(parts.part(8, near), 1);
}

TEST(SurfaceParts, FindsAPartWhereverItSearchesFrom) {
  SurfaceParts parts;
  parts.count = 2;
  for (int element = 3; element < 90; element += 1 + element % 5) {
    parts.part_of.push_back(
        {static_cast<std::uint16_t>(element), static_cast<std::uint16_t>(element % 2)});
  }
  for (std::size_t start = 0; start <= parts.part_of.size() + 1; ++start) {
    for (std::uint16_t element = 0; element < 95; ++element) {
      const auto listed =
          std::ranges::find(parts.part_of, element, [](const auto& pair) { return pair[0]; });
      std::size_t near = start;
      const std::optional<std::uint16_t> part = parts.part(element, near);
      ASSERT_EQ(part.has_value(), listed != parts.part_of.end()) << element << " " << start;
      if (part) {
        EXPECT_EQ(*part, (*listed)[1]);
      }
    }
  }
}

TEST(PartsBetweenRegions, HangTogetherAroundABlockOfZeros) {
  // Within the inside it has a boundary, and no `-` beside it: but tets of zeros.
  WarpedLattice lattice{};
  const HaloSet block = halo_cube(3, 4);
  for (const NodeKind kind : {kCorner, kCentre}) {
    lattice.plus[kind] = halo_cube(-1, 8) - block;
    lattice.zero[kind] = block;
  }
  const SurfaceRegions regions({lattice.plus, lattice.zero});
  EXPECT_TRUE(regions.have_one_sheet());
  EXPECT_TRUE(sheet_between(regions).one);
  EXPECT_EQ(parts_between_regions(regions)->count, 1);
}

TEST(PartsBetweenRegions, AreNoneAroundALoneZeroOfTheInside) {
  WarpedLattice lattice{};
  for (const NodeKind kind : {kCorner, kCentre}) lattice.plus[kind] = halo_cube(-1, 8);
  HaloSet zero;
  zero.set(halo_index(4, 4, 4));
  lattice.zero[kCorner] = zero;
  lattice.plus[kCorner] -= zero;
  const auto parts = parts_between_regions(SurfaceRegions({lattice.plus, lattice.zero}));
  ASSERT_TRUE(parts.has_value());
  EXPECT_EQ(parts->count, 0);
}

TEST(PartsBetweenRegions, HangTogetherWhereZerosAreBesideEachOtherAtTheRim) {
  // Tets beyond the star join the two zeros, and no other brick need see that.
  WarpedLattice lattice{};
  for (const NodeKind kind : {kCorner, kCentre}) lattice.plus[kind] = halo_cube(-1, 8);
  HaloSet zeros, minus;
  zeros.set(halo_index(8, 8, 8));
  zeros.set(halo_index(7, 8, 8));
  minus.set(halo_index(7, 8, 8));
  lattice.zero[kCorner] = zeros;
  lattice.plus[kCorner] -= zeros;
  lattice.plus[kCentre] -= minus;
  ASSERT_FALSE(kBrickStar[kCentre].test(halo_index(7, 8, 8)));
  const SurfaceRegions regions({lattice.plus, lattice.zero});
  EXPECT_EQ(regions.others.size(), 1U);
  EXPECT_TRUE(regions.have_one_sheet());
}

TEST(SurfaceRegions, HaveNoSheetWhereAZeroOfAnotherBrickMayBeInner) {
  // What is beyond the lone zero cannot be seen here; a brick that does may have it in a sheet.
  WarpedLattice lattice{};
  HaloSet zero, minus;
  zero.set(halo_index(8, 8, 8));
  minus.set(halo_index(4, 4, 4));
  for (const NodeKind kind : {kCorner, kCentre}) lattice.plus[kind] = halo_cube(-1, 8);
  lattice.zero[kCorner] = zero;
  lattice.plus[kCorner] -= zero;
  lattice.plus[kCentre] -= minus;
  const SurfaceRegions regions({lattice.plus, lattice.zero});
  EXPECT_EQ(regions.others.size(), 1U);
  EXPECT_FALSE(regions.have_one_sheet());
}

}  // namespace
}  // namespace tet
