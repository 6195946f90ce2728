#include "core/labels/indicators.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <span>
#include <utility>
#include <vector>

#include "core/base/vector_clones.h"
#include "core/labels/convolve.h"
#include "core/labels/indicator_probe.h"
#include "core/labels/kernel_taps.h"
#include "core/labels/lattice_faces.h"

namespace tet {
namespace {

constexpr int kFirstNode = -2;
constexpr int kRowNodes = TapRow::kNodes;
/// A slice of a halo has so many nodes, with what fills its rows up.
constexpr std::size_t kSliceNodes = std::size_t{kRowNodes} * 16;

/// With more labels than these around a brick, nodes are looked at one by one.
constexpr std::size_t kFewLabels = 24;

/// The best of a brick's labels at each node, by halo index.
struct BestLabels {
  HaloField indicator;
  std::array<std::uint16_t, kHaloNodes> place;  ///< among the labels of the brick
};

/// A label that contends for nodes.
struct Contender {
  Label label;
  std::uint16_t place;
  const float* indicator;
};

/// Gives a contender all nodes of a slice where it is better than those before it.
TET_VECTOR_CLONES
void contend(const Contender& with,
             float* __restrict best,
             std::uint16_t* __restrict place,
             Label* __restrict label) noexcept {
  const Contender by = with;
  for (std::size_t i = 0; i < kSliceNodes; ++i) {
    const float before = best[i], now = by.indicator[i];
    const bool wins = now > before;
    place[i] = wins ? by.place : place[i];
    label[i] = wins ? by.label : label[i];
    best[i] = wins ? now : before;
  }
}

/// Voxels that are compared at once.
using VoxelGroup = Label __attribute__((vector_size(64)));
constexpr std::size_t kGroup = sizeof(VoxelGroup) / sizeof(Label);

/// How many whole groups of voxels from the first on have labels of a list alone.
TET_VECTOR_CLONES
std::size_t known_groups(std::span<const Label> voxel, std::span<const Label> known) noexcept {
  for (std::size_t g = 0; g < voxel.size() / kGroup; ++g) {
    VoxelGroup labels, unlike = ~VoxelGroup{};
    std::memcpy(&labels, voxel.data() + g * kGroup, sizeof(labels));
    for (const Label label : known) unlike &= static_cast<VoxelGroup>(labels != label);
    std::array<std::uint64_t, sizeof(VoxelGroup) / 8> words;
    std::memcpy(words.data(), &unlike, sizeof(unlike));
    std::uint64_t any = 0;
    for (const std::uint64_t word : words) any |= word;
    if (any != 0) return g;
  }
  return voxel.size() / kGroup;
}

class IndicatorSampler final : public LabelSampler {
 public:
  IndicatorSampler(const LabelVoxels& voxels, const IndicatorRules& rules)
      : voxels_(voxels), rules_(rules) {}

  std::optional<Label> one_label(BrickCoord brick) override {
    enter(brick);
    if (const auto one = voxels_.one_label(window_.box)) return one;
    voxel_.resize(window_.voxels());
    voxels_.copy(window_.box, voxel_.data());
    find_labels();
    if (label_.size() == 1) return label_[0];
    return std::nullopt;
  }

  void sample_labels(BrickCoord, LabelSamples& samples) override {
    if (label_.size() <= kFewLabels) {
      convolve_all();
      for (const NodeKind kind : {kCorner, kCentre}) pick_labels(kind, samples);
      return;
    }
    for (const NodeKind kind : {kCorner, kCentre}) {
      for_each_node([&](int x, int y, int z) {
        samples.label[kind][static_cast<std::size_t>(halo_index(x, y, z))] =
            largest_at(kind, x, y, z);
      });
    }
  }

  void sample_fractions(BrickCoord, const EdgeSets& changes, LabelSamples& samples) override {
    for (int family = 0; family < kEdgeFamilies; ++family) {
      const auto f = static_cast<std::size_t>(family);
      const NodeKind kind = family_kind(family);
      const NodeKind end = end_kind(kind, family_direction(family));
      const int offset = end_offset(kind, family_direction(family));
      float* const out = samples.fraction[f].data();
      if (label_.size() <= kFewLabels) {
        find_fractions(kind, end, offset, changes[f], out);
        continue;
      }
      for_each_bit(changes[f], [&](int low) {
        const int high = low + offset;
        const Label a = samples.label[kind][static_cast<std::size_t>(low)];
        const Label b = samples.label[end][static_cast<std::size_t>(high)];
        out[low] =
            fraction(at(kind, low, a) - at(kind, low, b), at(end, high, b) - at(end, high, a));
      });
    }
  }

  void sample_triples(BrickCoord,
                      std::span<const TripleFace> faces,
                      const LabelSamples& samples,
                      std::span<FacePoint> points) override {
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const FaceFamily& family = kFaceFamily[faces[i].family];
      std::array<double, 3> u, v;  // by how much the first label wins over the others
      for (std::size_t n = 0; n < 3; ++n) {
        std::array<float, 3> of;
        for (std::size_t l = 0; l < 3; ++l) {
          of[l] = indicator(family.kind[n], faces[i].low + family.to_node[n], family.kind[l],
                            faces[i].low + family.to_node[l], samples);
        }
        u[n] = double{of[0]} - double{of[1]};
        v[n] = double{of[0]} - double{of[2]};
      }
      points[i] = common_zero(u, v);
    }
  }

 private:
  /// At a node, of the label that another one has.
  float indicator(NodeKind kind,
                  int node,
                  NodeKind other_kind,
                  int other,
                  const LabelSamples& samples) const noexcept {
    const auto n = static_cast<std::size_t>(node), o = static_cast<std::size_t>(other);
    if (label_.size() > kFewLabels) return at(kind, node, samples.label[other_kind][o]);
    return field(kind, best_[other_kind].place[o])[n];
  }

  template <class Visit>
  static void for_each_node(const Visit& visit) {
    for (int x = kFirstNode; x < kFirstNode + kRowNodes; ++x) {
      for (int y = kFirstNode; y < kFirstNode + kRowNodes; ++y) {
        for (int z = kFirstNode; z < kFirstNode + kRowNodes; ++z) visit(x, y, z);
      }
    }
  }

  void enter(BrickCoord brick) {
    const std::array<std::int32_t, 3> at{brick.x, brick.y, brick.z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (entered_ && at[axis] == at_[axis]) continue;
      for (const NodeKind kind : {kCorner, kCentre}) {
        find_taps(rules_, rules_.spacing_voxels[axis],
                  8.0 * at[axis] + kFirstNode + (kind == kCentre ? 0.5 : 0.0),
                  taps_[kind][axis]);
      }
    }
    at_ = at;
    entered_ = true;
    window_.go_to(taps_);
  }

  /// The labels around the brick, ascending.
  void find_labels() {
    label_.clear();
    std::span<const Label> rest(voxel_);
    while (!rest.empty()) {
      rest = rest.subspan(known_groups(rest, label_) * kGroup);
      const std::size_t next = std::min(rest.size(), kGroup);
      for (const Label label : rest.first(next)) {
        const auto at = std::ranges::lower_bound(label_, label);
        if (at == label_.end() || *at != label) label_.insert(at, label);
      }
      rest = rest.subspan(next);
    }
  }

  const HaloField& field(NodeKind kind, std::size_t label) const noexcept {
    return field_[label * kNodeKinds + kind];
  }

  void convolve_all() {
    const std::size_t fields = label_.size() * kNodeKinds;
    if (field_.size() < fields) field_.resize(fields);
    for (std::size_t l = 0; l < label_.size(); ++l) {
      convolution_.choose(voxel_, window_, label_[l]);
      for (const NodeKind kind : {kCorner, kCentre}) {
        convolution_.run(taps_[kind], field_[l * kNodeKinds + kind]);
      }
    }
  }

  /// Where an edge is cut, by how much its ends' labels win there. Neither is negative, and as
  /// the lower label wins ties only one may be zero.
  static float fraction(float here, float there) noexcept { return here / (here + there); }

  /// For edges from nodes of one kind, `low`, to those that lie `offset` away.
  void find_fractions(NodeKind kind,
                      NodeKind end,
                      int offset,
                      const HaloSet& edges,
                      float* out) const noexcept {
    const float* const indicator = best_[kind].indicator.data();
    const std::uint16_t* const place = best_[kind].place.data();
    const float* const end_indicator = best_[end].indicator.data() + offset;
    const std::uint16_t* const end_place = best_[end].place.data() + offset;
    const HaloField* const fields = field_.data();
    for_each_bit(edges, [&](int node) {
      const auto low = static_cast<std::size_t>(node),
                 high = static_cast<std::size_t>(node + offset);
      const float other_here = fields[std::size_t{end_place[node]} * kNodeKinds + kind][low],
                  other_there = fields[std::size_t{place[node]} * kNodeKinds + end][high];
      out[node] = fraction(indicator[node] - other_here, end_indicator[node] - other_there);
    });
  }

  void pick_labels(NodeKind kind, LabelSamples& samples) noexcept {
    BestLabels& best = best_[kind];
    for (int x = kFirstNode; x < kFirstNode + kRowNodes; ++x) {
      const auto slice = static_cast<std::size_t>(halo_index(x, kFirstNode, kFirstNode));
      float* const indicator = best.indicator.data() + slice;
      std::uint16_t* const place = best.place.data() + slice;
      Label* const label = samples.label[kind].data() + slice;
      std::copy_n(field(kind, 0).data() + slice, kSliceNodes, indicator);
      std::fill_n(place, kSliceNodes, std::uint16_t{0});
      std::fill_n(label, kSliceNodes, label_[0]);
      for (std::size_t l = 1; l < label_.size(); ++l) {
        contend({label_[l], static_cast<std::uint16_t>(l), field(kind, l).data() + slice},
                indicator, place, label);
      }
    }
  }

  /// The indicator of a label at a node, by halo index.
  float at(NodeKind kind, int node, Label label) const noexcept {
    return at(kind, node >> 8, node >> 4 & 15, node & 15, label);
  }

  /// The voxels of a node, row by row: `visit(x weights' index, ...)` as `at` sums them.
  float at(NodeKind kind, int x, int y, int z, Label label) const noexcept {
    const auto& [tx, ty, tz] = taps_[kind];
    const Taps& ax = tx.node[static_cast<std::size_t>(x)];
    const Taps& ay = ty.node[static_cast<std::size_t>(y)];
    const Taps& az = tz.node[static_cast<std::size_t>(z)];
    float sum_z = 0;
    for (std::size_t k = 0; k < az.count; ++k) {
      float sum_y = 0;
      for (std::size_t j = 0; j < ay.count; ++j) {
        float sum_x = 0;
        for (std::size_t i = 0; i < ax.count; ++i) {
          sum_x +=
              tx.weights[ax.begin + i] *
              (voxel_[index(ax.first, i, ay.first, j, az.first, k)] == label ? 1.0F : 0.0F);
        }
        sum_y += ty.weights[ay.begin + j] * sum_x;
      }
      sum_z += tz.weights[az.begin + k] * sum_y;
    }
    return sum_z;
  }

  std::size_t index(std::int32_t x,
                    std::size_t i,
                    std::int32_t y,
                    std::size_t j,
                    std::int32_t z,
                    std::size_t k) const noexcept {
    const auto from = [](std::int32_t voxel, std::int32_t min) {
      return static_cast<std::size_t>(voxel - min);
    };
    return ((from(x, window_.box.min.x) + i) * window_.size[1] + from(y, window_.box.min.y) +
            j) *
               window_.size[2] +
           from(z, window_.box.min.z) + k;
  }

  Label largest_at(NodeKind kind, int x, int y, int z) {
    x -= kFirstNode;
    y -= kFirstNode;
    z -= kFirstNode;
    const auto& [tx, ty, tz] = taps_[kind];
    const Taps& ax = tx.node[static_cast<std::size_t>(x)];
    const Taps& ay = ty.node[static_cast<std::size_t>(y)];
    const Taps& az = tz.node[static_cast<std::size_t>(z)];
    near_.clear();
    for (std::size_t i = 0; i < ax.count; ++i) {
      for (std::size_t j = 0; j < ay.count; ++j) {
        for (std::size_t k = 0; k < az.count; ++k) {
          near_.push_back(voxel_[index(ax.first, i, ay.first, j, az.first, k)]);
        }
      }
    }
    std::ranges::sort(near_);
    near_.erase(std::unique(near_.begin(), near_.end()), near_.end());
    Label best = near_[0];
    float most = -1;
    for (const Label label : near_) {
      const float value = at(kind, x, y, z, label);
      if (value <= most) continue;
      most = value;
      best = label;
    }
    return best;
  }

  const LabelVoxels& voxels_;
  const IndicatorRules rules_;
  bool entered_ = false;
  std::array<std::int32_t, 3> at_{};
  std::array<std::array<TapRow, 3>, kNodeKinds> taps_;
  VoxelWindow window_;
  std::vector<Label> voxel_;
  std::vector<Label> label_;      // around the brick, ascending
  std::vector<Label> near_;       // around a node
  std::vector<HaloField> field_;  // of each label, corners before centres
  std::array<BestLabels, kNodeKinds> best_;
  Convolution convolution_;
};

}  // namespace

std::unique_ptr<LabelSampler> IndicatorLabels::sampler() const {
  return std::make_unique<IndicatorSampler>(*voxels_, rules_);
}

std::unique_ptr<InterfaceProbe> IndicatorLabels::probe() const {
  return std::make_unique<IndicatorProbe>(*voxels_, rules_);
}

}  // namespace tet
