#include "core/stuffing/surface_sheet.h"

#include <bit>
#include <cstddef>

namespace tet {
namespace {

constexpr int kMin = -1, kMax = 8;
constexpr HaloSet kBox = halo_cube(kMin, kMax);

using NodeSets = std::array<HaloSet, kNodeKinds>;

/// The nodes of one kind with the same x: 12 rows of 16 bits, y from -2 on. The box has none
/// beyond.
struct Plane {
  std::array<std::uint64_t, 3> word{};

  bool operator==(const Plane&) const = default;
};

Plane plane_of(const HaloSet& set, int x) noexcept {
  const auto first = static_cast<std::size_t>(4 * (x + 2));
  return {
      {set.word[first], set.word[first + 1], set.word[first + 2]}
  };
}

/// The next plane's nodes on short edges from these: each centre from the four corners around
/// it.
Plane centres_beside(const Plane& corners) noexcept {
  std::array<std::uint64_t, 4> rows{};
  for (std::size_t i = 0; i < 3; ++i) rows[i] = corners.word[i] | corners.word[i] >> 1;
  Plane out;
  for (std::size_t i = 0; i < 3; ++i) out.word[i] = rows[i] | rows[i] >> 16 | rows[i + 1] << 48;
  return out;
}

Plane corners_beside(const Plane& centres) noexcept {
  std::array<std::uint64_t, 4> rows{};
  for (std::size_t i = 0; i < 3; ++i) rows[i + 1] = centres.word[i] | centres.word[i] << 1;
  Plane out;
  for (std::size_t i = 0; i < 3; ++i)
    out.word[i] = rows[i + 1] | rows[i + 1] << 16 | rows[i] >> 48;
  return out;
}

/// A plane's own nodes on long edges from these.
Plane beside_in_plane(const Plane& nodes) noexcept {
  const auto& [a, b, c] = nodes.word;
  return {
      {a << 1 | a >> 1 | a << 16 | a >> 16 | b << 48,
       b << 1 | b >> 1 | b << 16 | b >> 16 | a >> 48 | c << 48,
       c << 1 | c >> 1 | c << 16 | c >> 16 | b >> 48}
  };
}

/// Planes of the box in the order of x: corners, then centres half a spacing further.
constexpr std::size_t kPlanes = 2 * (kMax - kMin + 1);
using Planes = std::array<Plane, kPlanes>;

Planes planes_of(const NodeSets& nodes) noexcept {
  Planes planes;
  for (std::size_t i = 0; i < kPlanes; ++i) {
    planes[i] = plane_of(nodes[i % 2], kMin + static_cast<int>(i / 2));
  }
  return planes;
}

/// Fills a set of nodes from its first one. No edge between two of the set's zeros is followed.
class Flood {
 public:
  Flood(const Planes& nodes, const Planes& zero) : nodes_(nodes), zero_(zero) {}

  bool reaches_all() noexcept {
    if (!seed()) return true;
    for (bool grown = true; grown;) {
      grown = false;
      for (std::size_t i = 0; i < kPlanes; ++i) grown |= flow(i, i - 1, i - 2);
      if (reached_ == nodes_) return true;
      for (std::size_t i = kPlanes; i-- > 0;) grown |= flow(i, i + 1, i + 2);
      if (reached_ == nodes_) return true;
    }
    return false;
  }

 private:
  bool seed() noexcept {
    for (std::size_t i = 0; i < kPlanes; ++i) {
      for (std::size_t w = 0; w < 3; ++w) {
        const std::uint64_t word = nodes_[i].word[w];
        if (word == 0) continue;
        reached_[i].word[w] = word & (~word + 1);
        nonzero_[i].word[w] = reached_[i].word[w] & ~zero_[i].word[w];
        return true;
      }
    }
    return false;
  }

  /// To a plane from itself and the two beside it: long edges, and the short ones between
  /// kinds. Planes beyond the box have no nodes.
  bool flow(std::size_t to, std::size_t next, std::size_t over_next) noexcept {
    const auto from = [&](const Planes& planes) {
      Plane found = beside_in_plane(planes[to]);
      if (next < kPlanes) add(found, beside(planes[next], next));
      if (over_next < kPlanes) add(found, planes[over_next]);
      return found;
    };
    const Plane from_all = from(reached_), from_nonzero = from(nonzero_);
    std::uint64_t more = 0;
    for (std::size_t w = 0; w < 3; ++w) {
      const std::uint64_t zero = zero_[to].word[w];
      const std::uint64_t found = (from_all.word[w] & ~zero) | (from_nonzero.word[w] & zero);
      const std::uint64_t grown = found & nodes_[to].word[w] & ~reached_[to].word[w];
      reached_[to].word[w] |= grown;
      nonzero_[to].word[w] |= grown & ~zero;
      more |= grown;
    }
    return more != 0;
  }

  static Plane beside(const Plane& plane, std::size_t number) noexcept {
    return number % 2 == kCorner ? centres_beside(plane) : corners_beside(plane);
  }
  static void add(Plane& plane, const Plane& more) noexcept {
    for (std::size_t w = 0; w < 3; ++w) plane.word[w] |= more.word[w];
  }

  const Planes& nodes_;
  const Planes& zero_;
  Planes reached_{}, nonzero_{};
};

/// The brick's own nodes and all that share an edge with one.
constexpr NodeSets kAroundOwn = [] {
  NodeSets around{halo_cube(0, 7), halo_cube(0, 7)};
  const NodeSets own = around;
  for (const NodeKind kind : {kCorner, kCentre}) {
    for (int d = 0; d < kDirections; ++d) {
      around[end_kind(kind, d)] |= seen_from(own[kind], -end_offset(kind, d));
    }
  }
  return around;
}();

/// Rows y and bits z of one set of nodes, all x of a range and both kinds together.
using Shadow = Plane;

Shadow shadow_of(const Planes& planes, int min_x, int max_x) noexcept {
  Shadow shadow;
  for (int x = min_x; x <= max_x; ++x) {
    for (const int kind : {kCorner, kCentre}) {
      const Plane& plane = planes[static_cast<std::size_t>(2 * (x - kMin) + kind)];
      for (std::size_t w = 0; w < 3; ++w) shadow.word[w] |= plane.word[w];
    }
  }
  return shadow;
}

/// What of [-1, 8] two bricks have in common that are `step` bricks apart along an axis.
struct Common {
  int min, max;
  constexpr explicit Common(int step)
      : min(step == 0 ? 0 : (step < 0 ? -1 : 7)), max(step == 0 ? 7 : min + 1) {}
};

/// For each place around a brick, the rows and bits that both bricks have.
constexpr std::array<Plane, 9> kCommonRows = [] {
  std::array<Plane, 9> common{};
  for (int o = 0; o < 9; ++o) {
    const Common along_y(o / 3 - 1), along_z(o % 3 - 1);
    for (int y = along_y.min; y <= along_y.max; ++y) {
      for (int z = along_z.min; z <= along_z.max; ++z) {
        const int bit = (y + 2) * 16 + z + 2;
        common[static_cast<std::size_t>(o)].word[static_cast<std::size_t>(bit / 64)] |=
            std::uint64_t{1} << bit % 64;
      }
    }
  }
  return common;
}();

bool meet(const Plane& a, const Plane& b) noexcept {
  return ((a.word[0] & b.word[0]) | (a.word[1] & b.word[1]) | (a.word[2] & b.word[2])) != 0;
}

/// Later bricks with which this one shares both `+` and other nodes: what they share hangs
/// together, so the surface crosses an edge of it.
std::uint16_t later_bricks(const Planes& plus, const Planes& other) noexcept {
  unsigned later = 0;
  for (const int x : {0, 1}) {
    const Common along_x(x);
    const Shadow plus_there = shadow_of(plus, along_x.min, along_x.max);
    const Shadow other_there = shadow_of(other, along_x.min, along_x.max);
    for (unsigned o = x == 0 ? 5 : 0; o < 9; ++o) {
      const bool both = meet(plus_there, kCommonRows[o]) && meet(other_there, kCommonRows[o]);
      later |= static_cast<unsigned>(both) << (static_cast<unsigned>(x) * 9 + o - 5);
    }
  }
  return static_cast<std::uint16_t>(later);
}

bool meet(const NodeSets& a, const NodeSets& b) noexcept {
  return (a[kCorner] & b[kCorner]).any() || (a[kCentre] & b[kCentre]).any();
}

}  // namespace

SurfaceSheet surface_sheet(const NodeSets& plus, const NodeSets& zero) noexcept {
  const NodeSets other{kBox - plus[kCorner], kBox - plus[kCentre]};
  SurfaceSheet sheet;
  sheet.any = meet(plus, kAroundOwn) && meet(other, kAroundOwn);
  if (!sheet.any) return sheet;
  const Planes plus_planes = planes_of(plus), other_planes = planes_of(other);
  const Planes zero_planes = planes_of(zero);
  sheet.one = Flood(plus_planes, zero_planes).reaches_all() &&
              Flood(other_planes, zero_planes).reaches_all();
  if (sheet.one) sheet.later = later_bricks(plus_planes, other_planes);
  return sheet;
}

}  // namespace tet
