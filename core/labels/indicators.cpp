#include "core/labels/indicators.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "core/base/vector_clones.h"
#include "core/labels/kernel_taps.h"

namespace tet {
namespace {

constexpr int kFirstNode = -2;
constexpr int kRowNodes = TapRow::kNodes;
/// Rows of nodes are padded to whole vectors.
constexpr std::size_t kRowStride = 16;
constexpr std::size_t kFieldSize = std::size_t{kRowNodes} * kRowNodes * kRowStride;

/// With more labels than these around a brick, nodes are looked at one by one.
constexpr std::size_t kFewLabels = 24;

/// The voxels that matter to a brick and its halo.
struct Window {
  VoxelBox box;
  std::array<std::size_t, 3> size{};

  void go_to(const std::array<std::array<TapRow, 3>, kNodeKinds>& taps) noexcept {
    std::array<std::int32_t, 3> low, high;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = INT32_MAX;
      high[axis] = INT32_MIN;
      for (const auto& rows : taps) {
        for (const Taps& node : rows[axis].node) {
          low[axis] = std::min(low[axis], node.first);
          high[axis] =
              std::max(high[axis], node.first + static_cast<std::int32_t>(node.count) - 1);
        }
      }
      size[axis] = static_cast<std::size_t>(high[axis] - low[axis] + 1);
    }
    box = {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
  }
  std::size_t voxels() const noexcept { return size[0] * size[1] * size[2]; }
};

/// Sums rows along z for eight or more nodes at a time: out[z] += weight * in[z].
TET_VECTOR_CLONES
void add_row(float weight, const float* in, std::size_t count, float* out) noexcept {
  for (std::size_t z = 0; z < count; ++z) out[z] += weight * in[z];
}

/// One label's indicator at the nodes of a brick and its halo, by separable sums: along x, then
/// y, then z. The order is that of `at`, so the bits are the same.
class Convolution {
 public:
  void run(const std::vector<Label>& voxel,
           const Window& window,
           const std::array<TapRow, 3>& taps,
           Label label,
           float* out) {
    const auto [nx, ny, nz] = window.size;
    mask_.resize(window.voxels());
    for (std::size_t i = 0; i < mask_.size(); ++i) mask_[i] = voxel[i] == label ? 1.0F : 0.0F;
    const std::size_t slice = ny * nz;
    along_x_.assign(slice, 0);
    along_y_.resize(kRowNodes * nz);
    for (int x = 0; x < kRowNodes; ++x) {
      std::fill(along_x_.begin(), along_x_.end(), 0.0F);
      const auto wx = taps[0].weights_of(x);
      const std::size_t first_x =
          offset_of(taps[0].node[static_cast<std::size_t>(x)].first, window.box.min.x);
      for (std::size_t i = 0; i < wx.size(); ++i) {
        add_row(wx[i], mask_.data() + (first_x + i) * slice, slice, along_x_.data());
      }
      std::fill(along_y_.begin(), along_y_.end(), 0.0F);
      for (int y = 0; y < kRowNodes; ++y) {
        const auto wy = taps[1].weights_of(y);
        const std::size_t first_y =
            offset_of(taps[1].node[static_cast<std::size_t>(y)].first, window.box.min.y);
        float* const row = along_y_.data() + static_cast<std::size_t>(y) * nz;
        for (std::size_t j = 0; j < wy.size(); ++j) {
          add_row(wy[j], along_x_.data() + (first_y + j) * nz, nz, row);
        }
        sum_along_z(row, taps[2], window.box.min.z,
                    out + static_cast<std::size_t>(x * kRowNodes + y) * kRowStride);
      }
    }
    (void)nx;
  }

 private:
  static std::size_t offset_of(std::int32_t voxel, std::int32_t first) noexcept {
    return static_cast<std::size_t>(voxel - first);
  }

  static void sum_along_z(const float* row,
                          const TapRow& taps,
                          std::int32_t first,
                          float* out) noexcept {
    for (int z = 0; z < kRowNodes; ++z) {
      const Taps& node = taps.node[static_cast<std::size_t>(z)];
      const float* const at = row + offset_of(node.first, first);
      const float* const weight = taps.weights.data() + node.begin;
      float sum = 0;
      for (std::size_t k = 0; k < node.count; ++k) sum += weight[k] * at[k];
      out[z] = sum;
    }
  }

  std::vector<float> mask_, along_x_, along_y_;
};

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
      for_each_bit(changes[f], [&](int low) {
        const int high = low + offset;
        const Label a = samples.label[kind][static_cast<std::size_t>(low)];
        const Label b = samples.label[end][static_cast<std::size_t>(high)];
        const float here = indicator(kind, low, a) - indicator(kind, low, b);
        const float there = indicator(end, high, b) - indicator(end, high, a);
        // Neither is negative, and as the lower label wins ties only one may be zero.
        samples.fraction[f][static_cast<std::size_t>(low)] = here / (here + there);
      });
    }
  }

 private:
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
    Label last = kJoker;
    for (const Label label : voxel_) {
      if (label == last) continue;
      last = label;
      const auto at = std::ranges::lower_bound(label_, label);
      if (at == label_.end() || *at != label) label_.insert(at, label);
    }
  }

  float* field(NodeKind kind, std::size_t label) noexcept {
    return field_.data() + (label * kNodeKinds + kind) * kFieldSize;
  }

  void convolve_all() {
    field_.resize(label_.size() * kNodeKinds * kFieldSize);
    for (std::size_t l = 0; l < label_.size(); ++l) {
      for (const NodeKind kind : {kCorner, kCentre}) {
        convolution_.run(voxel_, window_, taps_[kind], label_[l], field(kind, l));
      }
    }
  }

  void pick_labels(NodeKind kind, LabelSamples& samples) {
    std::array<float, kRowNodes> best;
    for (int x = 0; x < kRowNodes; ++x) {
      for (int y = 0; y < kRowNodes; ++y) {
        const std::size_t row = static_cast<std::size_t>(x * kRowNodes + y) * kRowStride;
        Label* const out =
            samples.label[kind].data() + halo_index(x + kFirstNode, y + kFirstNode, kFirstNode);
        std::copy_n(field(kind, 0) + row, kRowNodes, best.begin());
        std::fill_n(out, kRowNodes, label_[0]);
        for (std::size_t l = 1; l < label_.size(); ++l) {
          const float* const value = field(kind, l) + row;
          for (std::size_t z = 0; z < kRowNodes; ++z) {
            out[z] = value[z] > best[z] ? label_[l] : out[z];
            best[z] = std::max(best[z], value[z]);
          }
        }
      }
    }
  }

  /// The indicator of a label at a node, by halo index.
  float indicator(NodeKind kind, int node, Label label) {
    const int x = node >> 8, y = node >> 4 & 15, z = node & 15;
    if (label_.size() > kFewLabels) return at(kind, x, y, z, label);
    const auto l =
        static_cast<std::size_t>(std::ranges::lower_bound(label_, label) - label_.begin());
    return field(kind, l)[static_cast<std::size_t>(x * kRowNodes + y) * kRowStride +
                          static_cast<std::size_t>(z)];
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
  Window window_;
  std::vector<Label> voxel_;
  std::vector<Label> label_;  // around the brick, ascending
  std::vector<Label> near_;   // around a node
  std::vector<float> field_;
  Convolution convolution_;
};

}  // namespace

std::unique_ptr<LabelSampler> IndicatorLabels::sampler() const {
  return std::make_unique<IndicatorSampler>(*voxels_, rules_);
}

}  // namespace tet
