#include "core/labels/field_labels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "core/base/brick_box.h"
#include "core/field/scene_samples.h"
#include "core/labels/field_probe.h"
#include "core/labels/lattice_faces.h"
#include "core/scene/scene_evaluator.h"
#include "core/stuffing/scene_zeros.h"
#include "core/stuffing/zero_bracket.h"
#include "core/volume/volume_reader.h"

namespace tet {
namespace {

constexpr int kFirstSampled = -2, kEndSampled = 10;  // labels are wanted at nodes between them
constexpr std::uint16_t kNobody = 0xffff;

/// Scenes are looked at in cubes of so many bricks along each axis before brick by brick.
constexpr std::int32_t kBlock = 8;

struct PhiRange {
  double low = 0, high = 0;
};

/// What may be of phi in a cube of bricks and their halo; of a scene.
PhiRange range_in(SceneEvaluator& evaluator,
                  double spacing,
                  const BrickCoord& first,
                  double bricks) noexcept {
  const double half = spacing * (4 * bricks + 2);
  const auto middle = [&](std::int32_t at) { return spacing * (8.0 * at + 4 * bricks); };
  const WorldPoint centre{middle(first.x), middle(first.y), middle(first.z)};
  evaluator.focus(centre, half);
  scene::Points points;
  points.x[0] = centre.x;
  points.y[0] = centre.y;
  points.z[0] = centre.z;
  const auto& [low, high] = evaluator.bounds(points, 1, half);
  return {low.at[0], high.at[0]};
}

/// What may be of phi in a brick and its halo; of a volume, by its bricks' ranges.
PhiRange range_in(VolumeReader& reader, const PhiField& field, const BrickCoord& brick) {
  constexpr double kMostBricks = 512;  // of what is told at small cost
  const auto voxel_brick = [&](std::int32_t at, double node) {
    return static_cast<std::int32_t>(
        std::floor(field.spacing_voxels * (8.0 * at + node) / kBrickEdge));
  };
  // One voxel more on either side, for what lies between voxels.
  const double beyond = 1 / field.spacing_voxels;
  const double low = kFirstSampled - beyond, high = kEndSampled + beyond;
  const BrickBox box{
      {voxel_brick(brick.x, low), voxel_brick(brick.y, low), voxel_brick(brick.z, low)},
      {voxel_brick(brick.x, high), voxel_brick(brick.y, high), voxel_brick(brick.z, high)}};
  constexpr double kAny = std::numeric_limits<double>::infinity();
  if (bricks_in(box) > kMostBricks) return {-kAny, kAny};
  PhiRange range{kAny, -kAny};
  for_each_brick(box, [&](const BrickCoord& at) {
    const ValueRange values = reader.brick(at).range;
    const auto a = static_cast<double>(field.phi(values.min)),
               b = static_cast<double>(field.phi(values.max));
    range.low = std::min({range.low, a, b});
    range.high = std::max({range.high, a, b});
  });
  return range;
}

/// One solid as it is sampled.
struct Solid {
  explicit Solid(const PhiField& field) : sampler(field) {
    if (field.scene == nullptr) reader.emplace(*field.volume);
  }

  PhiSampler sampler;
  std::optional<VolumeReader> reader;  // of a volume
};

BrickCoord block_of(const BrickCoord& brick) noexcept {
  const auto down = [](std::int32_t at) { return at & ~(kBlock - 1); };
  return {down(brick.x), down(brick.y), down(brick.z)};
}

}  // namespace

/// What one task needs; kept from task to task, as evaluators of a scene are not made quickly.
struct FieldLabels::Scratch {
  std::vector<std::unique_ptr<Solid>> solid;  // by the numbers of fields; null: not met yet
  bool entered = false;
  BrickCoord block;
  std::vector<std::uint16_t> in_block;                 // fields that may be inside in the block
  std::vector<std::uint16_t> near;                     // fields that may be inside in the brick
  std::vector<std::unique_ptr<BrickSamples>> samples;  // of those
  std::array<std::array<std::uint16_t, kHaloNodes>, kNodeKinds> winner;  // place in `near`
};

namespace {

class FieldSampler final : public LabelSampler {
 public:
  FieldSampler(const std::vector<LabelledField>& fields,
               Label background,
               Overlap overlap,
               ScratchPool<FieldLabels::Scratch>& pool)
      : fields_(fields), background_(background), overlap_(overlap), turn_(pool) {
    scratch().solid.resize(fields.size());
    static const Cancellation never;
    FieldSampler::stop_when(never);  // in place of whoever used the scratch before
    const double spacing = fields.empty() ? 0 : fields.front().field.spacing_voxels;
    constexpr double kTouching = 1e-6;
    touching_ = overlap == Overlap::kFirst ? static_cast<float>(kTouching * spacing) : 0;
  }

  ~FieldSampler() override {
    // What is known of a block, or of a focus, may be made up.
    if (cancellation_->requested()) scratch() = {};
  }
  FieldSampler(const FieldSampler&) = delete;
  FieldSampler& operator=(const FieldSampler&) = delete;

  void stop_when(const Cancellation& cancellation) override {
    cancellation_ = &cancellation;
    for (const auto& made : scratch().solid) {
      if (made != nullptr) made->sampler.stop_when(cancellation);
    }
  }

  std::optional<Label> one_label(BrickCoord brick) override {
    enter_block(brick);
    std::vector<std::uint16_t>& near = scratch().near;
    near.clear();
    bool all_inside = false;
    for (const std::uint16_t i : scratch().in_block) {
      const PhiRange range = range_of(i, brick);
      if (range.low > touching()) continue;
      near.push_back(i);
      all_inside = range.high < -touching();
      // Those that follow can have nothing of it.
      if (all_inside && overlap_ == Overlap::kFirst) break;
    }
    if (near.empty()) return background_;
    if (near.size() == 1 && all_inside) return fields_[near[0]].label;
    return std::nullopt;
  }

  void sample_labels(BrickCoord brick, LabelSamples& samples) override {
    FieldLabels::Scratch& mine = scratch();
    while (mine.samples.size() < mine.near.size()) {
      mine.samples.push_back(std::make_unique<BrickSamples>());
    }
    for (std::size_t k = 0; k < mine.near.size() && !cancellation_->requested(); ++k) {
      solid(mine.near[k]).sampler.sample(brick, *mine.samples[k]);
    }
    if (cancellation_->requested()) {
      for (auto& labels : samples.label) labels.fill(background_);
      return;
    }
    for (const NodeKind kind : {kCorner, kCentre}) {
      for (int x = kFirstSampled; x < kEndSampled; ++x) {
        for (int y = kFirstSampled; y < kEndSampled; ++y) {
          for (int z = kFirstSampled; z < kEndSampled; ++z) {
            const auto node = static_cast<std::size_t>(halo_index(x, y, z));
            const std::uint16_t winner = winner_at(kind, node);
            mine.winner[kind][node] = winner;
            samples.label[kind][node] =
                winner == kNobody ? background_ : fields_[mine.near[winner]].label;
          }
        }
      }
    }
  }

  void sample_fractions(BrickCoord brick,
                        const EdgeSets& changes,
                        LabelSamples& samples) override {
    for (int family = 0; family < kEdgeFamilies; ++family) {
      const Edges edges(brick, family);
      std::span<float> fraction = samples.fraction[static_cast<std::size_t>(family)];
      if (overlap_ == Overlap::kDeepest) {
        for_each_bit(changes[static_cast<std::size_t>(family)], [&](int low) {
          fraction[static_cast<std::size_t>(low)] = zero_of_difference(edges, low);
        });
      } else {
        find_first_zeros(edges, changes[static_cast<std::size_t>(family)], fraction);
      }
    }
  }

  void sample_triples(BrickCoord,
                      std::span<const TripleFace> faces,
                      const LabelSamples&,
                      std::span<FacePoint> points) override {
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const FaceFamily& family = kFaceFamily[faces[i].family];
      std::array<std::uint16_t, 3> of;
      for (std::size_t n = 0; n < 3; ++n) {
        of[n] = winner(family.kind[n], faces[i].low + family.to_node[n]);
      }
      std::ranges::sort(of);  // the earlier first, and nobody last
      std::array<double, 3> u, v;
      for (std::size_t n = 0; n < 3; ++n) {
        const int node = faces[i].low + family.to_node[n];
        const auto less = [&](std::uint16_t a, std::uint16_t b) {
          return static_cast<double>(difference(a, b, family.kind[n], node));
        };
        // The first of all ends where its own surface is, and so does the second beside it.
        const bool deepest = overlap_ == Overlap::kDeepest;
        u[n] = deepest ? less(of[0], of[1]) : less(of[0], kNobody);
        v[n] = deepest ? less(of[0], of[2]) : less(of[1], kNobody);
      }
      points[i] = common_zero(u, v);
    }
  }

 private:
  /// Edges of one family, by the halo indices of their lower nodes.
  struct Edges {
    Edges(BrickCoord of, int family)
        : brick(of),
          direction(family_direction(family)),
          kind(family_kind(family)),
          end(end_kind(kind, direction)),
          offset(end_offset(kind, direction)) {}

    BrickCoord brick;
    int direction;
    NodeKind kind, end;
    int offset;
  };

  FieldLabels::Scratch& scratch() noexcept { return *turn_; }
  double touching() const noexcept { return static_cast<double>(touching_); }

  Solid& solid(std::uint16_t i) {
    std::unique_ptr<Solid>& made = scratch().solid[i];
    if (made == nullptr) {
      made = std::make_unique<Solid>(fields_[i].field);
      made->sampler.stop_when(*cancellation_);
    }
    return *made;
  }

  PhiRange range_of(std::uint16_t i, const BrickCoord& brick) {
    const PhiField& field = fields_[i].field;
    if (field.scene == nullptr) return range_in(*solid(i).reader, field, brick);
    return range_in(solid(i).sampler.scene(), field.spacing_voxels, brick, 1);
  }

  /// Finds the fields that may be inside in the brick's block.
  void enter_block(const BrickCoord& brick) {
    FieldLabels::Scratch& mine = scratch();
    const BrickCoord block = block_of(brick);
    if (mine.entered && mine.block == block) return;
    mine.entered = true;
    mine.block = block;
    mine.in_block.clear();
    for (std::size_t n = 0; n < fields_.size(); ++n) {
      const auto i = static_cast<std::uint16_t>(n);
      const PhiField& field = fields_[i].field;
      if (field.scene != nullptr) {
        const PhiRange range =
            range_in(solid(i).sampler.scene(), field.spacing_voxels, block, kBlock);
        if (range.low > touching()) continue;
      }
      mine.in_block.push_back(i);
    }
  }

  /// phi at a node, of the k-th field near the brick.
  float phi(std::size_t k, NodeKind kind, std::size_t node) noexcept {
    const BrickSamples& samples = *scratch().samples[k];
    const float value = kind == kCorner ? samples.corner[node] : samples.centre[node];
    return std::abs(value) <= touching_ ? 0 : value;
  }

  std::uint16_t winner_at(NodeKind kind, std::size_t node) noexcept {
    std::uint16_t winner = kNobody;
    float least = 0;
    for (std::size_t k = 0; k < scratch().near.size(); ++k) {
      const float value = phi(k, kind, node);
      const bool wins = winner == kNobody ? value <= 0 : value < least;
      if (!wins) continue;
      winner = static_cast<std::uint16_t>(k);
      least = value;
      if (overlap_ == Overlap::kFirst) break;
    }
    return winner;
  }

  std::uint16_t winner(NodeKind kind, int node) noexcept {
    return scratch().winner[kind][static_cast<std::size_t>(node)];
  }

  /// phi of one winner less that of the other; the background's is 0.
  float difference(std::uint16_t a, std::uint16_t b, NodeKind kind, int node) noexcept {
    const auto at = static_cast<std::size_t>(node);
    const float of_a = a == kNobody ? 0 : phi(a, kind, at);
    return of_a - (b == kNobody ? 0 : phi(b, kind, at));
  }

  /// That at any point of the lattice.
  double difference_at(std::uint16_t a, std::uint16_t b, const std::array<double, 3>& p) {
    const auto of = [&](std::uint16_t k) {
      if (k == kNobody) return 0.0;
      return static_cast<double>(solid(scratch().near[k]).sampler.at(p[0], p[1], p[2]));
    };
    return of(a) - of(b);
  }

  /// Where two solids are equally deep on an edge: not above 0 at its lower node, not below at
  /// the upper one.
  float zero_of_difference(const Edges& edges, int low) {
    const std::uint16_t a = winner(edges.kind, low), b = winner(edges.end, low + edges.offset);
    const float at_low = difference(a, b, edges.kind, low),
                at_high = difference(a, b, edges.end, low + edges.offset);
    if (at_low == 0 || at_high == 0) return at_low == 0 ? 0.0F : 1.0F;
    constexpr int kSteps = 3;
    ZeroBracket bracket;
    bracket.begin(static_cast<double>(at_low), static_cast<double>(at_high));
    const LatticeCoord from = node_coord(edges.kind, low),
                       along = kDirection[static_cast<std::size_t>(edges.direction)];
    const auto at = [&](std::int32_t brick, std::int32_t node, std::int32_t step) {
      return 0.5 * (16.0 * brick + node + bracket.next * step);
    };
    for (int step = 0; step < kSteps && !bracket.done; ++step) {
      bracket.narrow(
          difference_at(a, b,
                        {at(edges.brick.x, from.x, along.x), at(edges.brick.y, from.y, along.y),
                         at(edges.brick.z, from.z, along.z)}));
    }
    return static_cast<float>(bracket.zero());
  }

  /// Zeros of the earlier one of the two solids of each edge; nobody comes after all.
  void find_first_zeros(const Edges& edges, const HaloSet& changes, std::span<float> fraction) {
    for (std::size_t k = 0; k < scratch().near.size(); ++k) {
      low_.clear();
      for_each_bit(changes, [&](int low) {
        const std::uint16_t first =
            std::min(winner(edges.kind, low), winner(edges.end, low + edges.offset));
        if (first != k) return;
        const float at_low = phi(k, edges.kind, static_cast<std::size_t>(low)),
                    at_high = phi(k, edges.end, static_cast<std::size_t>(low + edges.offset));
        if (at_low == 0 || at_high == 0) {
          fraction[static_cast<std::size_t>(low)] = at_low == 0 ? 0.0F : 1.0F;
          return;
        }
        low_.push_back(static_cast<std::uint16_t>(low));
        low_phi_.resize(low_.size());
        high_phi_.resize(low_.size());
        low_phi_.back() = at_low;
        high_phi_.back() = at_high;
      });
      find_zeros_of(k, edges, fraction);
    }
  }

  /// Finds those of the edges that were gathered.
  void find_zeros_of(std::size_t k, const Edges& edges, std::span<float> fraction) {
    std::array<float, kSceneEdges> found;
    for (std::size_t begin = 0; begin < low_.size(); begin += kSceneEdges) {
      const std::size_t count = std::min(kSceneEdges, low_.size() - begin);
      const std::span<const std::uint16_t> low(low_.data() + begin, count);
      find_scene_zeros(
          solid(scratch().near[k]).sampler,
          {edges.brick, edges.kind, edges.direction, low, &low_phi_[begin], &high_phi_[begin]},
          found.data());
      for (std::size_t i = 0; i < count; ++i) fraction[low[i]] = found[i];
    }
  }

  const std::vector<LabelledField>& fields_;
  const Label background_;
  const Overlap overlap_;
  const Cancellation* cancellation_ = nullptr;
  ScratchPool<FieldLabels::Scratch>::Turn turn_;
  float touching_ = 0;              // what is as near to zero is zero
  std::vector<std::uint16_t> low_;  // edges of one solid, and its phi at their ends
  std::vector<float> low_phi_, high_phi_;
};

/// Orders fields so that of equal phi the first wins.
std::vector<LabelledField> in_order(std::vector<LabelledField> fields, Overlap overlap) {
  if (overlap == Overlap::kDeepest) {
    std::ranges::stable_sort(fields, {}, &LabelledField::label);
  }
  return fields;
}

}  // namespace

FieldLabels::FieldLabels(std::vector<LabelledField> fields, Label background, Overlap overlap)
    : fields_(in_order(std::move(fields), overlap)),
      background_(background),
      overlap_(overlap),
      scratch_(std::make_unique<ScratchPool<Scratch>>()) {}

FieldLabels::~FieldLabels() = default;

std::unique_ptr<LabelSampler> FieldLabels::sampler() const {
  return std::make_unique<FieldSampler>(fields_, background_, overlap_, *scratch_);
}

std::unique_ptr<InterfaceProbe> FieldLabels::probe() const {
  return std::make_unique<FieldProbe>(fields_, background_, overlap_);
}

}  // namespace tet
