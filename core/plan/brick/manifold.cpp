#include "core/plan/brick/manifold.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>

#include "core/base/brick_index.h"
#include "core/base/parallel.h"
#include "core/plan/brick/survey.h"
#include "core/stuffing/topology/surface_topology.h"

namespace tet {
namespace {

constexpr std::size_t kRestoredPerRange = 8;

/// A brick's nodes after the warp, as far as it is decided.
struct NodeStates {
  NodeMasks plus, zero;
  NodeMasks inside;  ///< by their own samples
  NodeMasks restored;
};

NodeMasks own_part(const std::array<HaloSet, kNodeKinds>& nodes) noexcept {
  return {brick_part(nodes[kCorner]), brick_part(nodes[kCentre])};
}

bool any(const NodeMasks& nodes) noexcept {
  return nodes[kCorner].any() || nodes[kCentre].any();
}

class Restoration {
 public:
  Restoration(const PhiField& field,
              const std::vector<BrickCoord>& bricks,
              const StuffingRules& rules,
              const Cancellation& cancellation)
      : bricks_(bricks), cancellation_(cancellation), index_(bricks), states_(bricks.size()) {
    for_each_range(bricks.size(), kRestoredPerRange, [&](std::size_t begin, std::size_t end) {
      PhiSampler sampler(field);
      sampler.stop_when(cancellation);
      const auto workspace = std::make_unique_for_overwrite<StuffingWorkspace>();
      for (std::size_t i = begin; i < end && !cancellation.requested(); ++i) {
        if (!stuff_brick(sampler, bricks[i], rules, nullptr, *workspace)) continue;
        const StuffedLattice& lattice = workspace->lattice;
        states_[i] =
            std::make_unique<NodeStates>(NodeStates{own_part(lattice.warped.plus),
                                                    own_part(lattice.warped.zero),
                                                    own_part(lattice.cuts.signs.inside),
                                                    {}});
      }
    });
  }

  /// Restores until nothing is left to restore.
  void run() {
    std::vector<std::uint32_t> active;
    for (std::uint32_t i = 0; i < states_.size(); ++i) {
      if (states_[i] != nullptr) active.push_back(i);
    }
    while (!active.empty() && !cancellation_.requested()) active = run_round(active);
  }

  std::shared_ptr<const RestoredNodes> take() const {
    std::vector<BrickCoord> bricks;
    std::vector<NodeMasks> nodes;
    for (std::size_t i = 0; i < states_.size(); ++i) {
      if (states_[i] == nullptr || !any(states_[i]->restored)) continue;
      bricks.push_back(bricks_[i]);
      nodes.push_back(states_[i]->restored);
    }
    if (bricks.empty()) return nullptr;
    return std::make_shared<const RestoredNodes>(std::move(bricks), std::move(nodes));
  }

 private:
  /// All bricks look before any changes. Returns those that have to look again.
  std::vector<std::uint32_t> run_round(const std::vector<std::uint32_t>& active) {
    std::vector<NodeMasks> bad(active.size());
    for_each_index(
        active.size(),
        [&](std::size_t i) {
          if (!cancellation_.requested()) bad[i] = bad_nodes(active[i]);
        },
        kRestoredPerRange);
    std::vector<bool> again(states_.size());
    for (std::size_t i = 0; i < active.size(); ++i) {
      if (!any(bad[i])) continue;
      restore(*states_[active[i]], bad[i]);
      for_each_neighbour(bricks_[active[i]],
                         [&](std::uint32_t at, int, int, int) { again[at] = true; });
    }
    std::vector<std::uint32_t> next;
    for (std::uint32_t i = 0; i < again.size(); ++i) {
      if (again[i]) next.push_back(i);
    }
    return next;
  }

  NodeMasks bad_nodes(std::uint32_t brick) const noexcept {
    std::array<HaloSet, kNodeKinds> plus, zero;
    for_each_neighbour(bricks_[brick], [&](std::uint32_t at, int x, int y, int z) {
      for (const NodeKind kind : {kCorner, kCentre}) {
        add_brick(plus[kind], states_[at]->plus[kind], x, y, z);
        add_brick(zero[kind], states_[at]->zero[kind], x, y, z);
      }
    });
    return non_manifold_nodes(plus, zero);
  }

  static void restore(NodeStates& state, const NodeMasks& bad) noexcept {
    for (const NodeKind kind : {kCorner, kCentre}) {
      state.zero[kind] &= ~bad[kind];
      state.plus[kind] |= bad[kind] & state.inside[kind];
      state.restored[kind] |= bad[kind];
    }
  }

  /// Visits those that the surface is near to, the brick itself among them.
  template <class Visit>
  void for_each_neighbour(BrickCoord b, const Visit& visit) const {
    for (int x = -1; x <= 1; ++x) {
      for (int y = -1; y <= 1; ++y) {
        for (int z = -1; z <= 1; ++z) {
          const std::uint32_t at = index_.find({b.x + x, b.y + y, b.z + z});
          if (at != kNoBrick && states_[at] != nullptr) visit(at, x, y, z);
        }
      }
    }
  }

  const std::vector<BrickCoord>& bricks_;
  const Cancellation& cancellation_;
  BrickIndex index_;
  /// Null where the surface is not near: where the lattice is finer than the voxels, as most
  /// candidates are, all of their states would be hundreds of megabytes to clear.
  std::vector<std::unique_ptr<NodeStates>> states_;
};

}  // namespace

absl::StatusOr<std::shared_ptr<const RestoredNodes>> find_nodes_to_restore(
    const PhiField& field,
    const std::vector<BrickCoord>& candidates,
    const StuffingRules& rules,
    const Cancellation& cancellation) {
  Restoration restoration(field, candidates, rules, cancellation);
  restoration.run();
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  return restoration.take();
}

}  // namespace tet
