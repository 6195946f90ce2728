#include "core/plan/brick/unchanged_bricks.h"

#include <cstdint>
#include <utility>

#include "core/base/brick_index.h"
#include "core/plan/brick/counted_mesh.h"

namespace tet {
namespace {

bool same_masks(const MaskColumn& a, std::size_t at_a, const MaskColumn& b, std::size_t at_b) {
  return a.empty() == b.empty() && (a.empty() || a[at_a] == b[at_b]);
}

/// Tells which bricks of one level are as they were.
class LevelChanges {
 public:
  LevelChanges(const CountedMesh& earlier, const CountedMesh& now, std::size_t level)
      : earlier_(earlier),
        now_(now),
        finest_(level == 0),
        before_(level < earlier.tree().levels.size() ? &earlier.tree().levels[level] : nullptr),
        level_(now.tree().levels[level]),
        places_(level_.bricks.size(), kNewBrick) {}

  void find() {
    std::size_t at = 0;
    const std::size_t count_before = before_ == nullptr ? 0 : before_->bricks.size();
    const auto vanish = [&] {
      gone_.push_back(before_->bricks[at]);
      if (before_->leaf[at].any()) other_leaves_.push_back(before_->bricks[at]);
      ++at;
    };
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const BrickCoord brick = level_.bricks[i];
      while (at < count_before && before_->bricks[at] < brick) vanish();
      if (at == count_before || before_->bricks[at] != brick) {
        if (level_.leaf[i].any()) other_leaves_.push_back(brick);
        continue;
      }
      if (before_->leaf[at] != level_.leaf[i]) {
        other_leaves_.push_back(brick);
      } else if (same_cells(*before_, at, level_, i) && same_surface(at, i)) {
        places_[i] = static_cast<std::uint32_t>(at);
      }
      ++at;
    }
    while (at < count_before) vanish();
  }

  /// A brick owns corners of the leaves before it along each axis, but for those that the level
  /// below has, where `other_below` are the bricks that may own others than they did.
  void leave_out_readers(const std::vector<BrickCoord>& other_below) {
    for (const BrickCoord b : other_leaves_) {
      for (std::int32_t o = 1; o < 8; ++o) {
        leave_out({b.x + (o >> 2), b.y + (o >> 1 & 1), b.z + (o & 1)});
      }
    }
    for (const BrickCoord b : other_below) leave_out({b.x >> 1, b.y >> 1, b.z >> 1});
  }

  /// Bricks that may own others than they did, and those that are gone; in no order.
  std::vector<BrickCoord> others() const {
    std::vector<BrickCoord> others = gone_;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (places_[i] == kNewBrick) others.push_back(level_.bricks[i]);
    }
    return others;
  }

  BrickPlaces take() { return std::move(places_); }

 private:
  bool same_surface(std::size_t before, std::size_t brick) const {
    if (!finest_) return true;
    const std::uint32_t a = earlier_.stuffed(before), b = now_.stuffed(brick);
    if (a >= kAllInside || b >= kAllInside) return a == b;
    const auto& known = now_.survey().known;
    return !known.empty() && known[b] == a;
  }

  void leave_out(BrickCoord brick) {
    const std::uint32_t at = level_.index.find(brick);
    if (at != kNoBrick) places_[at] = kNewBrick;
  }

  const CountedMesh& earlier_;
  const CountedMesh& now_;
  bool finest_;
  const OctreeLevel* before_;
  const OctreeLevel& level_;
  BrickPlaces places_;
  std::vector<BrickCoord> gone_, other_leaves_;
};

}  // namespace

bool same_cells(const OctreeLevel& earlier,
                std::size_t before,
                const OctreeLevel& now,
                std::size_t brick) noexcept {
  return same_masks(earlier.leaf, before, now.leaf, brick) &&
         same_masks(earlier.inside, before, now.inside, brick) &&
         same_masks(earlier.refined, before, now.refined, brick);
}

std::vector<BrickPlaces> find_unchanged_bricks(const CountedMesh& earlier,
                                               const CountedMesh& now) {
  std::vector<BrickPlaces> unchanged;
  std::vector<BrickCoord> other_below;
  for (std::size_t level = 0; level < now.tree().levels.size(); ++level) {
    LevelChanges changes(earlier, now, level);
    changes.find();
    changes.leave_out_readers(other_below);
    other_below = changes.others();
    unchanged.push_back(changes.take());
  }
  return unchanged;
}

}  // namespace tet
