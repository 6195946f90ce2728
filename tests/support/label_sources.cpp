#include "tests/support/label_sources.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "core/labels/lattice_faces.h"

namespace tet::test {
namespace {

std::uint64_t mixed(std::uint64_t bits) {
  bits ^= bits >> 30;
  bits *= 0xbf58476d1ce4e5b9;
  bits ^= bits >> 27;
  bits *= 0x94d049bb133111eb;
  return bits ^ bits >> 31;
}

std::uint64_t hash_of(std::uint32_t seed, LatticeCoord at, int more) {
  std::uint64_t hash = mixed(seed + 0x9e3779b97f4a7c15);
  for (const std::int64_t v :
       {std::int64_t{at.x}, std::int64_t{at.y}, std::int64_t{at.z}, std::int64_t{more}}) {
    hash = mixed(hash ^ static_cast<std::uint64_t>(v) * 0x9e3779b97f4a7c15);
  }
  return hash;
}

/// In [0, 1).
float unit(std::uint64_t hash) { return static_cast<float>(hash >> 40) / (1 << 24); }

LatticeCoord in_lattice(NodeKind kind, BrickCoord brick, int x, int y, int z) {
  const auto at = [&](std::int32_t b, int i) { return 2 * (8 * b + i) + kind; };
  return {at(brick.x, x), at(brick.y, y), at(brick.z, z)};
}

class FunctionSampler final : public LabelSampler {
 public:
  explicit FunctionSampler(const LabelFunctions& functions) : functions_(functions) {}

  std::optional<Label> one_label(BrickCoord) override { return std::nullopt; }

  void sample_labels(BrickCoord brick, LabelSamples& samples) override {
    for (const NodeKind kind : {kCorner, kCentre}) {
      for (int x = -2; x <= 9; ++x) {
        for (int y = -2; y <= 9; ++y) {
          for (int z = -2; z <= 9; ++z) {
            samples.label[kind][static_cast<std::size_t>(halo_index(x, y, z))] =
                functions_.label(in_lattice(kind, brick, x, y, z));
          }
        }
      }
    }
  }

  void sample_fractions(BrickCoord brick,
                        const EdgeSets& changes,
                        LabelSamples& samples) override {
    for (int family = 0; family < kEdgeFamilies; ++family) {
      const auto f = static_cast<std::size_t>(family);
      for_each_bit(changes[f], [&](int low) {
        const int x = (low >> 8) - 2, y = (low >> 4 & 15) - 2, z = (low & 15) - 2;
        samples.fraction[f][static_cast<std::size_t>(low)] = functions_.fraction(
            in_lattice(family_kind(family), brick, x, y, z), family_direction(family));
      });
    }
  }

  void sample_triples(BrickCoord brick,
                      std::span<const TripleFace> faces,
                      const LabelSamples&,
                      std::span<FacePoint> points) override {
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const FaceFamily& family = kFaceFamily[faces[i].family];
      const int x = (faces[i].low >> 8) - 2, y = (faces[i].low >> 4 & 15) - 2,
                z = (faces[i].low & 15) - 2;
      const LatticeCoord low = in_lattice(family.kind[0], brick, x, y, z);
      points[i] = functions_.triple({low, low + family.step[1], low + family.step[2]});
    }
  }

 private:
  const LabelFunctions& functions_;
};

/// Differences of indicators, from that of the first label.
class FunctionProbe final : public InterfaceProbe {
 public:
  explicit FunctionProbe(const LabelFunctions& functions) : functions_(functions) {}

  bool choose(std::span<const Label> labels, const WorldPoint&) override {
    labels_.assign(labels.begin(), labels.end());
    return true;
  }
  void at(const WorldPoint& p, std::span<ValueSlope> out) override {
    const ValueSlope first = functions_.indicator(labels_[0], p);
    for (std::size_t i = 0; i < out.size(); ++i) {
      const auto& [value, slope] = functions_.indicator(labels_[i + 1], p);
      out[i] = {first.value - value,
                {first.slope.x - slope.x, first.slope.y - slope.y, first.slope.z - slope.z}};
    }
  }

 private:
  const LabelFunctions& functions_;
  std::vector<Label> labels_;
};

LabelFunctions random_labels(std::uint32_t seed, std::size_t labels) {
  return {
      [=](LatticeCoord at) { return static_cast<Label>(hash_of(seed, at, -1) % labels); },
      [=](LatticeCoord low, int direction) { return hostile_fraction(seed, low, direction); },
      [=](const std::array<LatticeCoord, 3>& face) { return hostile_triple(seed, face); }};
}

/// An affine function for each label; the largest wins.
struct Planes {
  std::vector<std::array<double, 4>> plane;

  double at(std::size_t label, LatticeCoord node) const {
    const auto& [a, b, c, d] = plane[label];
    return a * node.x + b * node.y + c * node.z + d;
  }
  Label label(LatticeCoord node) const {
    std::size_t best = 0;
    for (std::size_t i = 1; i < plane.size(); ++i) {
      if (at(i, node) > at(best, node)) best = i;
    }
    return static_cast<Label>(best);
  }
  float fraction(LatticeCoord low, int direction) const {
    const LatticeCoord high = low + kDirection[static_cast<std::size_t>(direction)];
    const Label a = label(low), b = label(high);
    const double here = at(a, low) - at(b, low), there = at(b, high) - at(a, high);
    const double sum = here + there;
    return static_cast<float>(sum > 0 ? std::clamp(here / sum, 0.0, 1.0) : 0.5);
  }
  FacePoint triple(const std::array<LatticeCoord, 3>& face) const {
    std::array<double, 3> u, v;
    for (std::size_t n = 0; n < 3; ++n) {
      u[n] = at(label(face[0]), face[n]) - at(label(face[1]), face[n]);
      v[n] = at(label(face[0]), face[n]) - at(label(face[2]), face[n]);
    }
    return common_zero(u, v);
  }
};

LabelFunctions functions_of(Planes planes) {
  const auto shared = std::make_shared<const Planes>(std::move(planes));
  return {[shared](LatticeCoord at) { return shared->label(at); },
          [shared](LatticeCoord low, int d) { return shared->fraction(low, d); },
          [shared](const std::array<LatticeCoord, 3>& face) { return shared->triple(face); },
          [shared](Label label, const WorldPoint& p) {
            const auto& [a, b, c, d] = shared->plane[label];
            return ValueSlope{2 * (a * p.x + b * p.y + c * p.z) + d, {2 * a, 2 * b, 2 * c}};
          }};
}

/// Voronoi cells: |x - p|^2 is less the larger 2 p.x - |p|^2 is.
LabelFunctions voronoi(std::uint32_t seed, std::size_t labels, const BrickBox& box) {
  Planes planes;
  for (std::size_t i = 0; i < labels; ++i) {
    const auto within = [&](int axis, std::int32_t min, std::int32_t max) {
      return 16.0 * (min + static_cast<double>(unit(
                               hash_of(seed, {static_cast<std::int32_t>(i), axis, 0}, 7))) *
                               (max - min + 1));
    };
    const double x = within(0, box.min.x, box.max.x), y = within(1, box.min.y, box.max.y),
                 z = within(2, box.min.z, box.max.z);
    planes.plane.push_back({2 * x, 2 * y, 2 * z, -(x * x + y * y + z * z)});
  }
  return functions_of(std::move(planes));
}

/// Four labels that all meet along a line in direction (p, q, r): indicators are the same
/// along it.
LabelFunctions four_along_a_line() {
  Planes planes;
  // Orthogonal to (1, 2, 3): (2, -1, 0) and (3, 6, -5).
  for (const auto& [s, t] : {std::pair{1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}}) {
    planes.plane.push_back({2 * s + 0.45 * t, -s + 0.9 * t, -0.75 * t, 0.0});
  }
  return functions_of(std::move(planes));
}

LabelFunctions with_hostile_fractions(std::uint32_t seed,
                                      std::function<Label(LatticeCoord)> label) {
  return {
      std::move(label),
      [=](LatticeCoord low, int direction) { return hostile_fraction(seed, low, direction); },
      [=](const std::array<LatticeCoord, 3>& face) { return hostile_triple(seed, face); }};
}

}  // namespace

std::unique_ptr<LabelSampler> FunctionLabels::sampler() const {
  return std::make_unique<FunctionSampler>(functions_);
}

std::unique_ptr<InterfaceProbe> FunctionLabels::probe() const {
  if (functions_.indicator == nullptr) return nullptr;
  return std::make_unique<FunctionProbe>(functions_);
}

float hostile_fraction(std::uint32_t seed, LatticeCoord low, int direction) {
  const std::uint64_t hash = hash_of(seed, low, direction);
  const bool is_long_edge = is_long(direction);
  const float alpha = is_long_edge ? 0.2F : 0.3F;
  switch (hash % 10) {
    case 0:
      return 0;
    case 1:
      return 1;
    case 2:
      return alpha;
    case 3:
      return 1 - alpha;
    case 4:
      return 0.5F;
    case 5:
      return std::nextafter(alpha, 0.0F);
    default:
      return unit(mixed(hash));
  }
}

FacePoint hostile_triple(std::uint32_t seed, const std::array<LatticeCoord, 3>& face) {
  std::uint64_t hash = hash_of(seed, face[0], 20);
  for (const LatticeCoord& node : {face[1], face[2]}) {
    hash = mixed(hash ^ hash_of(seed, node, 21));
  }
  const float a = unit(mixed(hash ^ 1)), b = unit(mixed(hash ^ 2));
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  switch (hash % 12) {
    case 0:
      return {std::round(a), 0};
    case 1:
      return {a, 1 - a};
    case 2:
      return {std::numeric_limits<float>::quiet_NaN(), b};
    case 3:
      return {a, -kInfinity};
    case 4:
      return {1e30F * (a - 0.5F), -1e30F * b};
    case 5:
      return {8 * a - 4, 8 * b - 4};
    default:  // within the face
      return a + b <= 1 ? FacePoint{a, b} : FacePoint{1 - a, 1 - b};
  }
}

LabelFunctions surrounded(LabelFunctions functions, const BrickBox& box) {
  const auto within = [box](LatticeCoord at) {
    const auto inside = [](std::int32_t v, std::int32_t min, std::int32_t max) {
      return v >= 16 * min + 5 && v <= 16 * (max + 1) - 5;
    };
    return inside(at.x, box.min.x, box.max.x) && inside(at.y, box.min.y, box.max.y) &&
           inside(at.z, box.min.z, box.max.z);
  };
  return {[=, label = functions.label](LatticeCoord at) {
            return within(at) ? label(at) : Label{0};
          },
          functions.fraction, functions.triple};
}

std::vector<LabelCase> label_cases(const BrickBox& box, std::uint32_t seed) {
  std::vector<LabelCase> cases;
  for (const std::size_t labels : {2U, 3U, 4U, 5U, 8U, 30U, 1000U}) {
    const std::string name = std::to_string(labels) + " random labels";
    cases.push_back({name, random_labels(seed, labels), labels});
    cases.push_back(
        {name + ", surrounded", surrounded(random_labels(seed, labels), box), labels});
  }
  cases.push_back({"sheets",
                   with_hostile_fractions(
                       seed,
                       [](LatticeCoord at) {
                         const std::int32_t step = at.x + at.y + at.z;
                         return static_cast<Label>(step % 7 == 0 ? 1 : step % 11 == 0 ? 2 : 0);
                       }),
                   3});
  cases.push_back({"threads",
                   with_hostile_fractions(seed,
                                          [](LatticeCoord at) {
                                            const bool x = (at.y & 7) == 2 && (at.z & 7) == 4;
                                            const bool z = (at.x & 7) == 2 && (at.y & 7) == 4;
                                            return static_cast<Label>(x ? 3 : z ? 1 : 2);
                                          }),
                   4});
  cases.push_back({"checkerboard",
                   with_hostile_fractions(seed,
                                          [](LatticeCoord at) {
                                            return static_cast<Label>(
                                                ((at.x >> 1) + (at.y >> 1) + (at.z >> 1)) & 1);
                                          }),
                   2});
  cases.push_back({"checkerboard of eight",
                   with_hostile_fractions(seed,
                                          [](LatticeCoord at) {
                                            return static_cast<Label>((at.x >> 1 & 1) * 4 +
                                                                      (at.y >> 1 & 1) * 2 +
                                                                      (at.z >> 1 & 1));
                                          }),
                   8});
  cases.push_back({"Voronoi cells", voronoi(seed, 12, box), 12});
  cases.push_back({"Voronoi cells, surrounded", surrounded(voronoi(seed, 12, box), box), 12});
  cases.push_back({"four along a line", four_along_a_line(), 4});
  cases.push_back(
      {"exact ties",
       functions_of(
           {{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {-1, -1, -1, 0}, {1, 1, 0, 0}}}}),
       5});
  return cases;
}

}  // namespace tet::test
