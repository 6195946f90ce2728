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
#include "core/labels/sparse_sums.h"

namespace tet {
namespace {

constexpr int kFirstNode = -2;
constexpr int kRowNodes = TapRow::kNodes;
constexpr HaloSet kAllNodes = halo_cube(kFirstNode, kFirstNode + kRowNodes - 1);
/// A slice of a halo has so many nodes, with what fills its rows up.
constexpr std::size_t kSliceNodes = std::size_t{kRowNodes} * 16;

/// With more labels than these around a brick each node sums those alone that it sees.
constexpr std::size_t kFewLabels = 24;

/// The edges of one family.
struct EdgeFamily {
  NodeKind kind, end;  ///< of their lower nodes, and of the others
  int offset;          ///< from the lower one's halo index to the other's
};

constexpr auto kEdgeFamily = [] {
  std::array<EdgeFamily, kEdgeFamilies> families{};
  for (int f = 0; f < kEdgeFamilies; ++f) {
    const NodeKind kind = family_kind(f);
    const int direction = family_direction(f);
    families[static_cast<std::size_t>(f)] = {kind, end_kind(kind, direction),
                                             end_offset(kind, direction)};
  }
  return families;
}();

/// The ends of an edge.
enum End : std::uint8_t { kLow, kHigh };

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
      : voxels_(voxels), rules_(rules) {
    static const Cancellation never;
    cancellation_ = &never;
  }

  void stop_when(const Cancellation& cancellation) override { cancellation_ = &cancellation; }

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
    if (has_many_labels()) {
      find_largest(samples);
    } else if (convolve_all()) {
      for (const NodeKind kind : {kCorner, kCentre}) pick_labels(kind, samples);
    }
    if (!cancellation_->requested()) return;
    for (auto& labels : samples.label) labels.fill(label_[0]);
  }

  void sample_fractions(BrickCoord, const EdgeSets& changes, LabelSamples& samples) override {
    if (has_many_labels()) find_others(changes);
    for (std::size_t f = 0; f < kEdgeFamilies; ++f) {
      float* const out = samples.fraction[f].data();
      if (has_many_labels()) {
        find_fractions_of_many(f, changes[f], out);
      } else {
        find_fractions(kEdgeFamily[f], changes[f], out);
      }
    }
  }

  void sample_triples(BrickCoord,
                      std::span<const TripleFace> faces,
                      const LabelSamples&,
                      std::span<FacePoint> points) override {
    for (std::size_t i = 0; i < faces.size(); ++i) {
      std::array<double, 3> u, v;  // by how much the first label wins over the others
      for (std::size_t n = 0; n < 3; ++n) {
        std::array<float, 3> of;
        for (std::size_t l = 0; l < 3; ++l) of[l] = indicator(faces[i], n, l);
        u[n] = double{of[0]} - double{of[1]};
        v[n] = double{of[0]} - double{of[2]};
      }
      points[i] = common_zero(u, v);
    }
  }

 private:
  bool has_many_labels() const noexcept { return label_.size() > kFewLabels; }

  /// At a node of a face, of the label that another one has.
  float indicator(const TripleFace& face, std::size_t node, std::size_t other) const noexcept {
    const FaceFamily& family = kFaceFamily[face.family];
    const NodeKind kind = family.kind[node];
    const auto at = static_cast<std::size_t>(face.low + family.to_node[node]);
    if (node == other) return best_[kind].indicator[at];
    if (!has_many_labels()) {
      const auto there = static_cast<std::size_t>(face.low + family.to_node[other]);
      return field(kind, best_[family.kind[other]].place[there])[at];
    }
    // Edges are those of nodes 0 and 1, 1 and 2, 0 and 2.
    const std::size_t edge = node + other == 3 ? 1 : node + other == 1 ? 0 : 2;
    const auto low = static_cast<std::size_t>(face.low + family.to_node[std::min(node, other)]);
    return other_[family.edge_family[edge]][node < other ? kLow : kHigh][low];
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
    while (!rest.empty() && !has_many_labels()) {
      rest = rest.subspan(known_groups(rest, label_) * kGroup);
      const std::size_t next = std::min(rest.size(), kGroup);
      for (const Label label : rest.first(next)) {
        const auto at = std::ranges::lower_bound(label_, label);
        if (at == label_.end() || *at != label) label_.insert(at, label);
      }
      rest = rest.subspan(next);
    }
    if (!rest.empty()) add_labels(rest);
  }

  /// Takes as long whatever the number of labels, where `find_labels` compares with each.
  void add_labels(std::span<const Label> voxels) {
    is_there_.assign(kJoker, 0);
    for (const Label label : label_) is_there_[label] = 1;
    for (const Label label : voxels) is_there_[label] = 1;
    label_.clear();
    for (std::size_t label = 0; label < is_there_.size(); ++label) {
      if (is_there_[label] != 0) label_.push_back(static_cast<Label>(label));
    }
  }

  const HaloField& field(NodeKind kind, std::size_t label) const noexcept {
    return field_[label * kNodeKinds + kind];
  }

  /// False where it was cancelled.
  bool convolve_all() {
    const std::size_t fields = label_.size() * kNodeKinds;
    if (field_.size() < fields) field_.resize(fields);
    for (std::size_t l = 0; l < label_.size(); ++l) {
      convolution_.choose(voxel_, window_, label_[l]);
      for (const NodeKind kind : {kCorner, kCentre}) {
        // In the largest windows each label takes milliseconds.
        if (cancellation_->requested()) return false;
        convolution_.run(taps_[kind], field_[l * kNodeKinds + kind]);
      }
    }
    return true;
  }

  /// Finds the label of each node where there are many around the brick.
  void find_largest(LabelSamples& samples) {
    sums_.enter(voxel_, window_, label_);
    for (const NodeKind kind : {kCorner, kCentre}) {
      BestLabels& best = best_[kind];
      const auto keep = [&](int node, const LabelSums& sums) {
        const auto n = static_cast<std::size_t>(node);
        const std::uint16_t largest = largest_of(sums);
        best.place[n] = largest;
        best.indicator[n] = sums.of(largest);
        samples.label[kind][n] = label_[largest];
      };
      sums_.for_each_node(taps_[kind], kAllNodes, *cancellation_, keep);
    }
  }

  /// The largest sum's place; of equal ones the first, which is that of the lower label.
  static std::uint16_t largest_of(const LabelSums& sums) noexcept {
    std::uint16_t largest = sums.seen()[0];
    for (const std::uint16_t place : sums.seen()) {
      const float value = sums.of(place), before = sums.of(largest);
      if (value > before || (value == before && place < largest)) largest = place;
    }
    return largest;
  }

  /// Finds at the ends of edges the indicators of the labels at their other ends.
  void find_others(const EdgeSets& changes) {
    other_.resize(kEdgeFamilies);
    for (const NodeKind kind : {kCorner, kCentre}) {
      HaloSet nodes;
      for (std::size_t f = 0; f < kEdgeFamilies; ++f) {
        const EdgeFamily& family = kEdgeFamily[f];
        if (family.kind == kind) nodes |= changes[f];
        if (family.end == kind) nodes |= seen_from(changes[f], -family.offset);
      }
      const auto keep = [&](int node, const LabelSums& sums) {
        for (std::size_t f = 0; f < kEdgeFamilies; ++f) {
          keep_others(f, changes[f], kind, node, sums);
        }
      };
      sums_.for_each_node(taps_[kind], nodes, *cancellation_, keep);
    }
  }

  /// Keeps what a node has of the labels at the other ends of its edges of one family.
  void keep_others(std::size_t f,
                   const HaloSet& edges,
                   NodeKind kind,
                   int node,
                   const LabelSums& sums) noexcept {
    const EdgeFamily& family = kEdgeFamily[f];
    if (family.kind == kind && edges.test(node)) {
      const auto high = static_cast<std::size_t>(node + family.offset);
      other_[f][kLow][static_cast<std::size_t>(node)] = sums.of(best_[family.end].place[high]);
    }
    const int low = node - family.offset;
    if (family.end == kind && low >= 0 && edges.test(low)) {
      const auto at = static_cast<std::size_t>(low);
      other_[f][kHigh][at] = sums.of(best_[family.kind].place[at]);
    }
  }

  /// Where an edge is cut, by how much its ends' labels win there. Neither is negative, and as
  /// the lower label wins ties only one may be zero.
  static float fraction(float here, float there) noexcept { return here / (here + there); }

  void find_fractions(const EdgeFamily& family,
                      const HaloSet& edges,
                      float* out) const noexcept {
    const auto kind = family.kind, end = family.end;
    const auto offset = family.offset;
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

  void find_fractions_of_many(std::size_t f, const HaloSet& edges, float* out) const noexcept {
    const auto [kind, end, offset] = kEdgeFamily[f];
    const float* const indicator = best_[kind].indicator.data();
    const float* const end_indicator = best_[end].indicator.data() + offset;
    for_each_bit(edges, [&](int node) {
      const auto low = static_cast<std::size_t>(node);
      out[node] = fraction(indicator[node] - other_[f][kLow][low],
                           end_indicator[node] - other_[f][kHigh][low]);
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

  const LabelVoxels& voxels_;
  const IndicatorRules rules_;
  const Cancellation* cancellation_;
  bool entered_ = false;
  std::array<std::int32_t, 3> at_{};
  std::array<std::array<TapRow, 3>, kNodeKinds> taps_;
  VoxelWindow window_;
  std::vector<Label> voxel_;
  std::vector<Label> label_;            // around the brick, ascending
  std::vector<std::uint8_t> is_there_;  // by label
  std::array<BestLabels, kNodeKinds> best_;

  // Where there are few labels.
  std::vector<HaloField> field_;  // of each label, corners before centres
  Convolution convolution_;

  // Where there are many: by family, end and lower node what the end has of the other's label.
  std::vector<std::array<HaloField, 2>> other_;
  SparseSums sums_;
};

}  // namespace

std::unique_ptr<LabelSampler> IndicatorLabels::sampler() const {
  return std::make_unique<IndicatorSampler>(*voxels_, rules_);
}

std::unique_ptr<InterfaceProbe> IndicatorLabels::probe() const {
  return std::make_unique<IndicatorProbe>(*voxels_, rules_);
}

}  // namespace tet
