#include "core/graded/surface_edges.h"

#include <algorithm>
#include <array>

#include "core/base/parallel.h"
#include "core/graded/field_points.h"
#include "core/lattice/bcc.h"
#include "core/stuffing/zero_brackets.h"

namespace tet {
namespace {

constexpr std::size_t kTetsPerSearch = 16384;

/// Both ends of an edge as one number, which sorts by the lower node first.
using EdgeKey = std::uint64_t;
constexpr EdgeKey key_of(NodeId a, NodeId b) noexcept {
  return EdgeKey{std::min(a, b)} << 32 | std::max(a, b);
}

void sort_unique_keys(std::vector<EdgeKey>& keys) {
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
}

void add_crossed(const BackgroundMesh& mesh, std::size_t tet, std::vector<EdgeKey>& keys) {
  for (const auto& [i, j] : kTetEdge) {
    const NodeId a = mesh.tets[4 * tet + i], b = mesh.tets[4 * tet + j];
    const float phi_a = mesh.phi[a], phi_b = mesh.phi[b];
    if ((phi_a < 0 && phi_b > 0) || (phi_a > 0 && phi_b < 0)) keys.push_back(key_of(a, b));
  }
}

/// Every crossed edge once, sorted. An edge has several tets, most of them in one range.
std::vector<EdgeKey> crossed_edges(const BackgroundMesh& mesh,
                                   const Cancellation& cancellation) {
  const std::size_t tets = mesh.tet_count();
  std::vector<std::vector<EdgeKey>> ranges((tets + kTetsPerSearch - 1) / kTetsPerSearch);
  for_each_index(ranges.size(), [&](std::size_t r) {
    const std::size_t end = std::min(tets, (r + 1) * kTetsPerSearch);
    for (std::size_t i = r * kTetsPerSearch; i < end && !cancellation.requested(); ++i) {
      add_crossed(mesh, i, ranges[r]);
    }
    sort_unique_keys(ranges[r]);
  });
  std::vector<EdgeKey> keys;
  for (const auto& range : ranges) keys.insert(keys.end(), range.begin(), range.end());
  sort_unique_keys(keys);
  return keys;
}

/// Edges that are worked on at once: where each starts, and how far it leads.
class EdgeBatch {
 public:
  EdgeBatch(const BackgroundMesh& mesh, const SurfaceEdges& edges)
      : mesh_(mesh), edges_(edges) {}

  /// Takes an edge of this lower node.
  void add(NodeId low, std::uint32_t edge) noexcept {
    const NodeId high = edges_.high[edge];
    const LatticeCoord at = mesh_.node[low];
    start_[count_] = at;
    along_[count_] = mesh_.node[high] - at;
    bounds_.add(at);
    bounds_.add(mesh_.node[high]);
    low_phi_[count_] = mesh_.phi[low];
    high_phi_[count_] = mesh_.phi[high];
    ++count_;
  }
  bool full() const noexcept { return count_ == FieldPoints::kSize; }

  /// Finds all zeros, writes their fractions, and is empty again.
  void find(LatticeSampler& sampler, float* fraction) noexcept {
    sampler.focus(bounds_);
    brackets_.begin(low_phi_.data(), high_phi_.data(), count_);
    for (int step = 0; step < ZeroBracket::kMaxSteps && brackets_.open() > 0; ++step) {
      for (std::size_t i = 0; i < brackets_.open(); ++i) {
        put(i, brackets_.which()[i], brackets_.next()[i]);
      }
      sampler.sample(points_, brackets_.open(), phi_.data());
      brackets_.narrow(phi_.data(), fraction);
    }
    brackets_.end(fraction);
    count_ = 0;
    bounds_ = {};
  }

 private:
  void put(std::size_t place, std::size_t edge, double t) noexcept {
    points_.x[place] = 0.5 * (start_[edge].x + t * along_[edge].x);
    points_.y[place] = 0.5 * (start_[edge].y + t * along_[edge].y);
    points_.z[place] = 0.5 * (start_[edge].z + t * along_[edge].z);
  }

  const BackgroundMesh& mesh_;
  const SurfaceEdges& edges_;
  std::size_t count_ = 0;
  NodeBounds bounds_;
  std::array<LatticeCoord, FieldPoints::kSize> start_, along_;
  std::array<float, FieldPoints::kSize> low_phi_, high_phi_;
  static_assert(FieldPoints::kSize <= ZeroBrackets::kCapacity);
  ZeroBrackets brackets_;
  FieldPoints points_;
  std::array<double, FieldPoints::kSize> phi_;
};

}  // namespace

std::uint32_t SurfaceEdges::find(NodeId low, NodeId high_node) const noexcept {
  const auto begin = high.begin() + first[low], end = high.begin() + first[low + 1];
  const auto found = std::lower_bound(begin, end, high_node);
  if (found == end || *found != high_node) return kNone;
  return static_cast<std::uint32_t>(found - high.begin());
}

SurfaceEdges find_surface_edges(const BackgroundMesh& mesh, const Cancellation& cancellation) {
  const std::vector<EdgeKey> keys = crossed_edges(mesh, cancellation);
  SurfaceEdges edges;
  edges.first.resize(mesh.node.size() + 1);
  edges.high.reserve(keys.size());
  for (const EdgeKey key : keys) {
    edges.high.push_back(static_cast<NodeId>(key));
    ++edges.first[(key >> 32) + 1];
  }
  for (std::size_t i = 1; i < edges.first.size(); ++i) edges.first[i] += edges.first[i - 1];
  edges.fraction.resize(keys.size());
  return edges;
}

void find_zeros(const BackgroundMesh& mesh,
                const PhiField& field,
                const Cancellation& cancellation,
                SurfaceEdges& edges) {
  constexpr std::size_t kNodesPerSearch = 4096;
  for_each_range(mesh.node.size(), kNodesPerSearch, [&](std::size_t begin, std::size_t end) {
    LatticeSampler sampler(field, cancellation);
    EdgeBatch batch(mesh, edges);
    std::uint32_t written = edges.first[begin];
    const auto find = [&](std::uint32_t next) {
      batch.find(sampler, &edges.fraction[written]);
      written = next;
    };
    for (std::size_t node = begin; node < end && !cancellation.requested(); ++node) {
      for (std::uint32_t e = edges.first[node]; e < edges.first[node + 1]; ++e) {
        batch.add(static_cast<NodeId>(node), e);
        if (batch.full()) find(e + 1);
      }
    }
    if (written < edges.first[end]) find(edges.first[end]);
  });
}

}  // namespace tet
