#include "tests/support/reference_stuffing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "core/volume/volume_reader.h"

namespace tet::test {
namespace {

using Node = std::array<int, 3>;  // doubled coordinates: corners even, centres odd
using Edge = std::pair<Node, Node>;

bool is_centre(const Node& n) { return (n[0] & 1) != 0; }

Node moved(const Node& n, const Node& by) { return {n[0] + by[0], n[1] + by[1], n[2] + by[2]}; }

std::vector<Node> all_directions() {
  std::vector<Node> directions;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int step : {-2, 2}) {
      Node d{0, 0, 0};
      d[static_cast<std::size_t>(axis)] = step;
      directions.push_back(d);
    }
  }
  for (const int x : {-1, 1}) {
    for (const int y : {-1, 1}) {
      for (const int z : {-1, 1}) directions.push_back({x, y, z});
    }
  }
  return directions;
}

class Reference {
 public:
  Reference(const Volume& volume, double alpha_long, double alpha_short)
      : reader_(volume), alpha_long_(alpha_long), alpha_short_(alpha_short) {}

  ReferenceCounts count(const VoxelBox& box) {
    ReferenceCounts counts;
    for (int x = box.min.x - 2; x <= box.max.x + 1; ++x) {
      for (int y = box.min.y - 2; y <= box.max.y + 1; ++y) {
        for (int z = box.min.z - 2; z <= box.max.z + 1; ++z) {
          counts.tets += count_cell({2 * x + 1, 2 * y + 1, 2 * z + 1});
        }
      }
    }
    counts.vertices = nodes_used_.size() + cuts_used_.size();
    return counts;
  }

 private:
  /// Trilinear phi at a point in voxels.
  double field(double x, double y, double z) { return reader_.trilinear({x, y, z}); }

  double sample(const Node& n) {
    const auto known = samples_.find(n);
    if (known != samples_.end()) return known->second;
    const double phi = static_cast<float>(field(0.5 * n[0], 0.5 * n[1], 0.5 * n[2]));
    return samples_[n] = phi;
  }

  /// Fraction of the cut point from a, by the documented steps: linear, then two bracketed
  /// ones.
  double cut_fraction(const Node& a, const Node& b) {
    double low = 0, high = 1, phi_low = sample(a), phi_high = sample(b);
    double t = phi_low / (phi_low - phi_high);
    if (is_centre(a) == is_centre(b)) return fraction_on_long_edge(a, b, phi_low, phi_high);
    for (int step = 0; step < 2; ++step) {
      const double phi =
          field(0.5 * (a[0] + t * (b[0] - a[0])), 0.5 * (a[1] + t * (b[1] - a[1])),
                0.5 * (a[2] + t * (b[2] - a[2])));
      if (phi != 0 && (phi < 0) == (phi_low < 0)) {
        low = t;
        phi_low = phi;
      } else {
        high = t;
        phi_high = phi;
      }
      t = low + (high - low) * phi_low / (phi_low - phi_high);
    }
    return t;
  }

  /// Along an axis the trilinear field is piecewise linear, with one kink between two centres.
  double fraction_on_long_edge(const Node& a, const Node& b, double phi_a, double phi_b) {
    if (!is_centre(a)) return phi_a / (phi_a - phi_b);
    const double middle =
        field(0.25 * (a[0] + b[0]), 0.25 * (a[1] + b[1]), 0.25 * (a[2] + b[2]));
    if (middle == 0) return 0.5;
    if ((middle < 0) == (phi_a < 0)) return 0.5 + 0.5 * middle / (middle - phi_b);
    return 0.5 * phi_a / (phi_a - middle);
  }

  /// -1 inside, 1 outside, 0 on the surface: after the warp.
  int sign(const Node& n) {
    const auto known = signs_.find(n);
    if (known != signs_.end()) return known->second;
    const double phi = sample(n);
    int result = phi < 0 ? -1 : phi > 0 ? 1 : 0;
    for (const Node& d : directions_) {
      const Node other = moved(n, d);
      if (phi * sample(other) >= 0) continue;
      const bool lower = n < other;
      const double t = lower ? cut_fraction(n, other) : 1 - cut_fraction(other, n);
      const bool is_long = is_centre(n) == is_centre(other);
      if (t < (is_long ? alpha_long_ : alpha_short_)) result = 0;
    }
    return signs_[n] = result;
  }

  /// The 12 tets between this cell's centre and its upper neighbours'.
  std::uint64_t count_cell(const Node& centre) {
    std::uint64_t tets = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Node beyond = centre;
      beyond[axis] += 2;
      for (int turn = 0; turn < 4; ++turn) {
        tets += count_tet({centre, beyond, face_corner(centre, axis, turn),
                           face_corner(centre, axis, turn + 1)});
      }
    }
    return tets;
  }

  static Node face_corner(Node centre, std::size_t axis, int turn) {
    constexpr std::array<std::array<int, 2>, 4> kTurn{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
    const auto& uv = kTurn[static_cast<std::size_t>(turn % 4)];
    centre[axis] += 1;
    centre[(axis + 1) % 3] += uv[0];
    centre[(axis + 2) % 3] += uv[1];
    return centre;
  }

  std::uint64_t count_tet(const std::array<Node, 4>& tet) {
    std::vector<Node> plus, minus;
    std::size_t zeros = 0;
    for (const Node& n : tet) {
      if (sign(n) < 0) plus.push_back(n);
      if (sign(n) > 0) minus.push_back(n);
      if (sign(n) == 0) ++zeros;
    }
    if (plus.empty()) return 0;
    for (const Node& n : tet) {
      if (sign(n) <= 0) nodes_used_.insert(n);
    }
    for (const Node& p : plus) {
      for (const Node& m : minus) cuts_used_.insert(std::minmax(p, m));
    }
    if (minus.empty() || plus.size() == 1) return 1;
    return plus.size() == 2 && zeros == 1 ? 2 : 3;
  }

  VolumeReader reader_;
  double alpha_long_, alpha_short_;
  std::vector<Node> directions_ = all_directions();
  std::map<Node, double> samples_;
  std::map<Node, int> signs_;
  std::set<Node> nodes_used_;
  std::set<Edge> cuts_used_;
};

}  // namespace

ReferenceCounts reference_counts(const Volume& volume,
                                 const VoxelBox& box,
                                 double alpha_long,
                                 double alpha_short) {
  return Reference(volume, alpha_long, alpha_short).count(box);
}

}  // namespace tet::test
