#include "core/vdb/openvdb/sign_distances.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include <openvdb/tools/SignedFloodFill.h>

#include "core/base/parallel.h"
#include "core/base/tet_geometry.h"
#include "core/base/union_find.h"
#include "core/surface/outer_surface.h"

namespace tet {
namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;
using IndexLeaf = openvdb::Int32Tree::LeafNodeType;

constexpr std::uint32_t kLeafVoxels = Leaf::SIZE;
constexpr std::uint16_t kInactive = 0xFFFF;

/// Nearer to the surface a voxel's neighbours tell nothing of its sign: their own distances may
/// be to what they see of it, from which the voxel's is no farther than one voxel more.
constexpr float kTooNear = 0.15F;

/// No value of an inside voxel is nearer to zero: one that lies on a face within the solid is
/// inside, too.
constexpr float kLeastDepth = 1e-5F;  // voxels

/// Steps to the next voxel along x, y and z, in a leaf.
constexpr std::array<std::uint32_t, 3> kStep{64, 8, 1};

std::uint32_t along(std::uint32_t voxel, std::size_t axis) { return voxel / kStep[axis] % 8; }

bool linked(float d, float e) noexcept { return std::min(d, e) > kTooNear && d + e > 1; }

WorldPoint point_of(const openvdb::Coord& c) {
  return {static_cast<double>(c.x()), static_cast<double>(c.y()), static_cast<double>(c.z())};
}

/// The groups of linked voxels in one leaf.
struct LeafGroups {
  std::array<std::uint16_t, kLeafVoxels> group_of;
  std::vector<std::uint16_t> farthest;  ///< by group: the voxel farthest from the surface
};

void flood(const Leaf& leaf, std::uint32_t seed, LeafGroups& groups) {
  const float* const distance = leaf.buffer().data();
  const auto group = static_cast<std::uint16_t>(groups.farthest.size());
  std::uint32_t farthest = seed;
  std::array<std::uint16_t, kLeafVoxels> waiting;
  std::size_t count = 0;
  const auto take = [&](std::uint32_t voxel) {
    groups.group_of[voxel] = group;
    waiting[count++] = static_cast<std::uint16_t>(voxel);
    if (distance[voxel] > distance[farthest]) farthest = voxel;
  };
  take(seed);
  while (count > 0) {
    const std::uint32_t voxel = waiting[--count];
    const auto visit = [&](std::uint32_t next) {
      if (leaf.isValueOn(next) && groups.group_of[next] == kInactive &&
          linked(distance[voxel], distance[next])) {
        take(next);
      }
    };
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (along(voxel, axis) > 0) visit(voxel - kStep[axis]);
      if (along(voxel, axis) < 7) visit(voxel + kStep[axis]);
    }
  }
  groups.farthest.push_back(static_cast<std::uint16_t>(farthest));
}

LeafGroups find_groups(const Leaf& leaf) {
  LeafGroups groups;
  groups.group_of.fill(kInactive);
  for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel) {
    const std::uint32_t at = voxel.pos();
    if (groups.group_of[at] == kInactive) flood(leaf, at, groups);
  }
  return groups;
}

/// The leaves of a band, and the groups of linked voxels in all of it.
class BandGroups {
 public:
  explicit BandGroups(openvdb::FloatTree& tree) {
    leaves_.reserve(tree.leafCount());
    tree.getNodes(leaves_);
    std::unordered_map<const Leaf*, std::uint32_t> number;
    for (std::size_t i = 0; i < leaves_.size(); ++i) {
      number.emplace(leaves_[i], static_cast<std::uint32_t>(i));
    }
    groups_.resize(leaves_.size());
    next_.resize(leaves_.size());
    for_each_index(leaves_.size(), [&](std::size_t i) {
      groups_[i] = find_groups(*leaves_[i]);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        openvdb::Coord beside = leaves_[i]->origin();
        beside[axis] += 8;
        const Leaf* const leaf = tree.probeConstLeaf(beside);
        next_[i][axis] = leaf == nullptr ? kNone : number.at(leaf);
      }
    });
    first_ = offsets_from_counts(leaves_.size(),
                                 [&](std::size_t i) { return groups_[i].farthest.size(); });
    join_across_leaves();
  }

  const std::vector<Leaf*>& leaves() const { return leaves_; }
  std::size_t size() const { return first_.back(); }
  /// The number of the first group that hangs together with a voxel's.
  std::size_t root_of(std::size_t leaf, std::uint32_t voxel) const {
    return root_[first_[leaf] + groups_[leaf].group_of[voxel]];
  }
  const std::vector<std::size_t>& roots() const { return root_; }

  /// Calls `visit(leaf, voxel, other leaf, other voxel, axis)` for each two active neighbours.
  template <class Visit>
  void for_each_pair(std::size_t leaf, const Visit& visit) const {
    for (auto at = leaves_[leaf]->cbeginValueOn(); at; ++at) {
      const std::uint32_t voxel = at.pos();
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const bool within = along(voxel, axis) < 7;
        const std::uint32_t to = within ? static_cast<std::uint32_t>(leaf) : next_[leaf][axis];
        const std::uint32_t next = within ? voxel + kStep[axis] : voxel - 7 * kStep[axis];
        if (to == kNone || !leaves_[to]->isValueOn(next)) continue;
        visit(leaf, voxel, to, next, axis);
      }
    }
  }

  /// The voxel of each root's groups that is farthest from the surface; no voxel elsewhere.
  std::vector<std::optional<openvdb::Coord>> farthest_voxels() const {
    std::vector<std::optional<openvdb::Coord>> voxel(size());
    std::vector<float> distance(size(), -1);
    for (std::size_t i = 0; i < leaves_.size(); ++i) {
      for (std::size_t g = 0; g < groups_[i].farthest.size(); ++g) {
        const std::uint32_t at = groups_[i].farthest[g];
        const std::size_t root = root_[first_[i] + g];
        const float d = leaves_[i]->buffer().data()[at];
        if (d <= distance[root]) continue;
        distance[root] = d;
        voxel[root] = leaves_[i]->offsetToGlobalCoord(at);
      }
    }
    return voxel;
  }

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  void join_across_leaves() {
    UnionFind joined(size());
    for (std::size_t i = 0; i < leaves_.size(); ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (next_[i][axis] != kNone) join(i, next_[i][axis], axis, joined);
      }
    }
    root_.resize(size());
    for (std::size_t i = 0; i < root_.size(); ++i) root_[i] = joined.find(i);
  }

  void join(std::size_t low, std::size_t high, std::size_t axis, UnionFind& joined) const {
    const float* const d = leaves_[low]->buffer().data();
    const float* const e = leaves_[high]->buffer().data();
    const std::uint32_t u = kStep[(axis + 1) % 3], v = kStep[(axis + 2) % 3];
    for (std::uint32_t i = 0; i < 64; ++i) {
      const std::uint32_t to = i / 8 * u + i % 8 * v, from = to + 7 * kStep[axis];
      const std::uint16_t g = groups_[low].group_of[from], h = groups_[high].group_of[to];
      if (g == kInactive || h == kInactive || !linked(d[from], e[to])) continue;
      joined.unite(first_[low] + g, first_[high] + h);
    }
  }

  std::vector<Leaf*> leaves_;
  std::vector<LeafGroups> groups_;                  // by leaf
  std::vector<std::array<std::uint32_t, 3>> next_;  // by leaf: those beside it, upwards
  std::vector<std::uint64_t> first_;                // by leaf: the number of its first group
  std::vector<std::size_t> root_;                   // by group
};

/// Winding numbers of all groups, by root.
std::vector<double> wind_groups(const BandGroups& groups, const WindingTree& tree) {
  const auto voxel = groups.farthest_voxels();
  std::vector<double> winding(groups.size());
  for_each_index(
      winding.size(),
      [&](std::size_t i) {
        if (voxel[i]) winding[i] = tree.at(point_of(*voxel[i]));
      },
      16);
  return winding;
}

/// Finds sheets between neighbours of one side.
class SheetFinder {
 public:
  SheetFinder(const TriangleSurface& surface,
              const openvdb::Int32Grid& nearest,
              const BandGroups& groups,
              const WindingTree& tree,
              const std::vector<double>& winding)
      : surface_(surface), groups_(groups), tree_(tree), winding_(winding) {
    for (const Leaf* const leaf : groups.leaves()) {
      nearest_.push_back(nearest.tree().probeConstLeaf(leaf->origin()));
    }
  }

  HiddenSheets find() const {
    std::vector<HiddenSheets> found(groups_.leaves().size());
    for_each_index(found.size(), [&](std::size_t i) {
      groups_.for_each_pair(
          i, [&](std::size_t leaf, std::uint32_t voxel, std::size_t other, std::uint32_t next,
                 std::size_t axis) { look(leaf, voxel, other, next, axis, found[i]); });
    });
    HiddenSheets all;
    for (const HiddenSheets& one : found) {
      all.walls += one.walls;
      all.gaps += one.gaps;
      all.thinnest = std::min(all.thinnest, one.thinnest);
    }
    return all;
  }

 private:
  /// A voxel's nearest triangle, as a plane.
  struct Plane {
    Vector normal;        ///< of length one
    double distance = 0;  ///< from the voxel, along the normal
  };

  std::optional<Plane> plane_at(std::size_t leaf, std::uint32_t voxel) const {
    if (nearest_[leaf] == nullptr) return std::nullopt;
    const std::int32_t id = nearest_[leaf]->getValue(voxel);
    if (id < 0 || static_cast<std::size_t>(id) >= surface_.triangles.size()) {
      return std::nullopt;
    }
    const auto& t = surface_.triangles[static_cast<std::size_t>(id)];
    const WorldPoint& corner = surface_.vertices[t[0]];
    Vector n = cross(from_to(corner, surface_.vertices[t[1]]),
                     from_to(corner, surface_.vertices[t[2]]));
    const double length = std::sqrt(dot(n, n));
    if (!(length > 0)) return std::nullopt;
    n = {n.x / length, n.y / length, n.z / length};
    const WorldPoint at = point_of(groups_.leaves()[leaf]->offsetToGlobalCoord(voxel));
    return Plane{n, dot(n, from_to(at, corner))};
  }

  static double component(const Vector& v, std::size_t axis) {
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
  }

  void look(std::size_t leaf,
            std::uint32_t voxel,
            std::size_t other,
            std::uint32_t next,
            std::size_t axis,
            HiddenSheets& found) const {
    const float d = groups_.leaves()[leaf]->buffer().data()[voxel];
    const float e = groups_.leaves()[other]->buffer().data()[next];
    if (linked(d, e)) return;
    const std::size_t root = groups_.root_of(leaf, voxel), far = groups_.root_of(other, next);
    const bool inside = winding_[root] > kInsideWinding;
    if (inside != (winding_[far] > kInsideWinding)) return;
    const auto a = plane_at(leaf, voxel), b = plane_at(other, next);
    if (!a || !b || dot(a->normal, b->normal) > -kParallel) return;
    // Seen from a gap's or a wall's own sides: the surface faces away from what is inside.
    const double facing = component(a->normal, axis) * (inside ? 1 : -1);
    if (!(facing > 0.5)) return;
    const double begin = a->distance / component(a->normal, axis);
    const double end = 1 + b->distance / component(b->normal, axis);
    if (!(begin >= 0 && end <= 1 && end - begin > kSheetVoxels)) return;
    WorldPoint middle = point_of(groups_.leaves()[leaf]->offsetToGlobalCoord(voxel));
    (axis == 0 ? middle.x : axis == 1 ? middle.y : middle.z) += (begin + end) / 2;
    if ((tree_.at(middle) > kInsideWinding) == inside) return;
    ++(inside ? found.gaps : found.walls);
    found.thinnest = std::min(found.thinnest, (end - begin) * facing);
  }

  /// What is thinner is no wall: two sheets in one place, or that nearly are.
  static constexpr double kSheetVoxels = 1e-3;

  /// Sides of a wall are parallel but for 25 degrees; those of a sharp edge are not.
  static constexpr double kParallel = 0.9;

  const TriangleSurface& surface_;
  const BandGroups& groups_;
  const WindingTree& tree_;
  const std::vector<double>& winding_;
  std::vector<const IndexLeaf*> nearest_;  // by leaf
};

void set_signs(const BandGroups& groups, const std::vector<double>& winding) {
  for_each_index(groups.leaves().size(), [&](std::size_t i) {
    Leaf& leaf = *groups.leaves()[i];
    for (auto value = leaf.beginValueOn(); value; ++value) {
      if (winding[groups.root_of(i, value.pos())] > kInsideWinding) {
        value.setValue(-std::max(*value, kLeastDepth));
      }
    }
  });
}

}  // namespace

SignFindings sign_distances(const TriangleSurface& measured,
                            const WindingTree& tree,
                            const openvdb::Int32Grid& nearest,
                            openvdb::FloatGrid& distances) {
  const BandGroups groups(distances.tree());
  const std::vector<double> winding = wind_groups(groups, tree);
  SignFindings findings;
  findings.hidden = SheetFinder(measured, nearest, groups, tree, winding).find();
  findings.overlaps = std::any_of(winding.begin(), winding.end(),
                                  [](double w) { return w > 1.75 || w < -kInsideWinding; });
  set_signs(groups, winding);
  const float background = distances.background();
  openvdb::tools::signedFloodFillWithValues(distances.tree(), background, -background);
  return findings;
}

std::uint64_t count_lost_bodies(const ClosedSurface& closed,
                                const openvdb::Int32Grid& nearest,
                                const openvdb::FloatGrid& level_set) {
  std::vector<std::uint8_t> inside(closed.bodies), outside(closed.bodies);
  for (auto leaf = level_set.tree().cbeginLeaf(); leaf; ++leaf) {
    const IndexLeaf* const ids = nearest.tree().probeConstLeaf(leaf->origin());
    if (ids == nullptr) continue;
    for (auto value = leaf->cbeginValueOn(); value; ++value) {
      const std::int32_t id = ids->getValue(value.pos());
      if (id < 0 || static_cast<std::size_t>(id) >= closed.body_of.size()) continue;
      const std::uint32_t body = closed.body_of[static_cast<std::size_t>(id)];
      if (body != ClosedSurface::kNoBody) (*value < 0 ? inside : outside)[body] = 1;
    }
  }
  std::uint64_t lost = 0;
  for (std::size_t i = 0; i < inside.size(); ++i) lost += inside[i] + outside[i] < 2 ? 1U : 0U;
  return lost;
}

}  // namespace tet
