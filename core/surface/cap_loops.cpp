#include "core/surface/cap_loops.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace tet {
namespace {

using Way = std::pair<std::uint32_t, std::uint32_t>;  // from, to

std::vector<Way> unpaired_ways(std::span<const SurfaceSide> sides) {
  std::vector<Way> ways;
  for_each_edge(sides, [&](std::span<const SurfaceSide> run) {
    std::ptrdiff_t up = 0;
    for (const SurfaceSide& side : run) up += side.upwards ? 1 : -1;
    for (; up > 0; --up) ways.push_back({run[0].low, run[0].high});
    for (; up < 0; ++up) ways.push_back({run[0].high, run[0].low});
  });
  std::sort(ways.begin(), ways.end());
  return ways;
}

/// Walks along ways that are not used yet; whenever it meets its own path, it cuts a loop off.
class LoopWalk {
 public:
  explicit LoopWalk(std::vector<Way> ways) : ways_(std::move(ways)) {
    for (const Way& way : ways_) {
      if (starts_.empty() || starts_.back() != way.first) {
        starts_.push_back(way.first);
        next_.push_back(static_cast<std::size_t>(&way - ways_.data()));
      }
    }
    place_.assign(starts_.size(), kNowhere);
  }

  std::vector<HoleLoop> loops() {
    for (const Way& way : ways_) {
      const std::size_t start = index_of(way.first);
      while (has_way(start)) walk(start);
    }
    return std::move(loops_);
  }

 private:
  static constexpr std::size_t kNowhere = std::numeric_limits<std::size_t>::max();

  std::size_t index_of(std::uint32_t vertex) const {
    return static_cast<std::size_t>(std::lower_bound(starts_.begin(), starts_.end(), vertex) -
                                    starts_.begin());
  }
  bool has_way(std::size_t i) const {
    return next_[i] < ways_.size() && ways_[next_[i]].first == starts_[i];
  }

  void walk(std::size_t start) {
    std::vector<std::size_t> path{start};
    place_[start] = 0;
    while (has_way(path.back())) {
      const std::size_t to = index_of(ways_[next_[path.back()]++].second);
      if (place_[to] == kNowhere) {
        place_[to] = path.size();
        path.push_back(to);
      } else {
        cut_loop(path, place_[to]);
      }
    }
    for (const std::size_t i : path) place_[i] = kNowhere;
  }

  void cut_loop(std::vector<std::size_t>& path, std::size_t from) {
    HoleLoop loop;
    for (std::size_t i = from; i < path.size(); ++i) loop.push_back(starts_[path[i]]);
    for (std::size_t i = from + 1; i < path.size(); ++i) place_[path[i]] = kNowhere;
    path.resize(from + 1);
    loops_.push_back(std::move(loop));
  }

  std::vector<Way> ways_;              // sorted
  std::vector<std::uint32_t> starts_;  // vertices with ways out of them, sorted
  std::vector<std::size_t> next_;      // the first way out of each that is not used
  std::vector<std::size_t> place_;     // where each is on the path
  std::vector<HoleLoop> loops_;
};

WorldPoint middle_of(const HoleLoop& loop, const TriangleSurface& surface) {
  WorldPoint sum;
  for (const std::uint32_t id : loop) {
    const WorldPoint& p = surface.vertices[id];
    sum = {sum.x + p.x, sum.y + p.y, sum.z + p.z};
  }
  const auto count = static_cast<double>(loop.size());
  return {sum.x / count, sum.y / count, sum.z / count};
}

}  // namespace

std::vector<HoleLoop> find_holes(std::span<const SurfaceSide> sides) {
  return LoopWalk(unpaired_ways(sides)).loops();
}

void add_caps(std::span<const HoleLoop> holes, TriangleSurface& surface) {
  for (const HoleLoop& loop : holes) {
    if (loop.size() == 3) {
      surface.triangles.push_back({loop[0], loop[2], loop[1]});
      continue;
    }
    const auto apex = static_cast<std::uint32_t>(surface.vertices.size());
    surface.vertices.push_back(middle_of(loop, surface));
    for (std::size_t i = 0; i < loop.size(); ++i) {
      surface.triangles.push_back({loop[(i + 1) % loop.size()], loop[i], apex});
    }
  }
}

}  // namespace tet
