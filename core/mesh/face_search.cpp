#include "core/mesh/face_search.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <span>
#include <utility>

#include "core/base/loop_in_order.h"
#include "core/base/mix_bits.h"
#include "core/base/parallel.h"
#include "core/mesh/tets_per_range.h"

namespace tet {
namespace {

constexpr std::size_t kVerticesPerRange = 65536;

/// A face whose vertices all have something that does not cancel around them.
struct Candidate {
  std::uint64_t low = 0, middle = 0, high = 0;  ///< vertices
  std::uint64_t index = 0;                      ///< see TetFace
};

/// What tets that belong together have in common: a label, or a region.
std::uint32_t group_of(const TetMesh& mesh, std::uint64_t tet) noexcept {
  return mesh.header.labels.empty() ? static_cast<std::uint32_t>(mesh.region(tet))
                                    : mesh.label(tet);
}

/// Faces look otherwise from each group, so that those between two do not cancel.
std::uint64_t salt_of(std::uint32_t group) noexcept {
  return mix_bits(group + std::uint64_t{1});
}

/// Tets that one task looks at for xor_seen_faces. They follow each other in space, mostly, and
/// so do vertices: the more there are, the fewer belong to another task.
constexpr std::uint64_t kTetsPerTask = std::uint64_t{1} << 19;

/// Where the vertices begin that belong to each task, and one more: about where those of its
/// tets begin. Any other choice gives the same sums.
std::vector<std::uint64_t> first_of_tasks(const TetMesh& mesh) {
  const std::uint64_t tasks = (mesh.header.tet_count + kTetsPerTask - 1) / kTetsPerTask;
  std::vector<std::uint64_t> first(tasks + 1);
  for (std::uint64_t task = 1; task < tasks; ++task) {
    auto tet = mesh.tet(task * kTetsPerTask);
    std::ranges::sort(tet);
    first[task] = std::max(first[task - 1], tet[1]);
  }
  first[tasks] = mesh.header.vertex_count;
  return first;
}

/// Calls `add(vertex, hashes)` for the corners of a tet, with the XOR of the hashes of the
/// three faces around each, as the tet sees them.
template <class Add>
void hash_faces(const TetMesh& mesh, std::uint64_t i, const Add& add) {
  const auto tet = mesh.tet(i);
  const std::uint64_t salt = salt_of(group_of(mesh, i));
  std::array<std::uint64_t, 4> corner;
  for (std::size_t k = 0; k < 4; ++k) corner[k] = mix_bits(tet[k]);
  const std::uint64_t sum = corner[0] + corner[1] + corner[2] + corner[3] + salt;
  std::array<std::uint64_t, 4> face;  // opposite each corner; whatever the order of its own
  for (std::size_t k = 0; k < 4; ++k) face[k] = mix_bits(sum - corner[k]);
  const std::uint64_t all = face[0] ^ face[1] ^ face[2] ^ face[3];
  for (std::size_t k = 0; k < 4; ++k) add(tet[k], all ^ face[k]);
}

/// For every vertex, the XOR of the hashes of the faces around it, as each tet sees them: what
/// two tets of one group share cancels. A vertex of the boundary, or between groups, is left
/// with zero by accident only, once in 2^64.
///
/// A task adds to its own vertices, and to those of others in a second column, which all share:
/// in whatever order, the sums are the same.
std::vector<std::uint64_t> xor_seen_faces(const TetMesh& mesh,
                                          const Cancellation& cancellation) {
  const std::vector<std::uint64_t> first = first_of_tasks(mesh);
  const std::size_t tasks = first.size() - 1;
  std::vector<std::uint64_t> seen(mesh.header.vertex_count);
  std::vector<std::uint64_t> shared(tasks > 1 ? seen.size() : 0);
  for_each_index(tasks, [&](std::size_t task) {
    const std::uint64_t begin = first[task], count = first[task + 1] - begin;
    const std::uint64_t end = std::min(mesh.header.tet_count, (task + 1) * kTetsPerTask);
    for (std::uint64_t i = task * kTetsPerTask; i < end; ++i) {
      if (i % kTetsPerRange == 0 && cancellation.requested()) return;
      hash_faces(mesh, i, [&](std::uint64_t vertex, std::uint64_t hashes) {
        if (vertex - begin < count) {
          seen[vertex] ^= hashes;
        } else {
          std::atomic_ref(shared[vertex]).fetch_xor(hashes, std::memory_order_relaxed);
        }
      });
    }
  });
  for_each_index(
      shared.size(), [&](std::size_t i) { seen[i] ^= shared[i]; }, kVerticesPerRange);
  return seen;
}

/// Calls `take(candidate)` for those of a tet.
template <class Take>
void for_candidates(const TetMesh& mesh,
                    std::span<const std::uint64_t> seen,
                    std::uint64_t i,
                    const Take& take) {
  const auto tet = mesh.tet(i);
  std::array<bool, 4> open;
  for (std::size_t k = 0; k < 4; ++k) open[k] = seen[tet[k]] != 0;
  const auto count = std::count(open.begin(), open.end(), true);
  if (count < 3) return;
  for (std::size_t k = 0; k < 4; ++k) {
    if (count == 3 && open[k]) continue;
    const auto [low, middle, high] = sort_face(face_of(tet, k)).vertices;
    take(Candidate{low, middle, high, 4 * i + k});
  }
}

/// Does so for the tets of a range.
template <class Take>
void for_candidates_of_range(const TetMesh& mesh,
                             std::span<const std::uint64_t> seen,
                             std::size_t range,
                             const Take& take) {
  const std::uint64_t begin = range * std::uint64_t{kTetsPerRange};
  const std::uint64_t end = std::min(mesh.header.tet_count, begin + kTetsPerRange);
  for (std::uint64_t i = begin; i < end; ++i) for_candidates(mesh, seen, i, take);
}

std::size_t ranges_of(const TetMesh& mesh) noexcept {
  return (mesh.header.tet_count + kTetsPerRange - 1) / kTetsPerRange;
}

/// Where the candidates of each range of tets begin, and one more.
std::vector<std::uint64_t> count_candidates(const TetMesh& mesh,
                                            std::span<const std::uint64_t> seen,
                                            const Cancellation& cancellation) {
  std::vector<std::uint64_t> count(ranges_of(mesh));
  for_each_index(count.size(), [&](std::size_t range) {
    if (cancellation.requested()) return;
    std::uint64_t found = 0;
    for_candidates_of_range(mesh, seen, range, [&](const Candidate&) { ++found; });
    count[range] = found;
  });
  return offsets_from_counts(count.size(), [&](std::size_t i) { return count[i]; });
}

/// In the order of their indices.
std::vector<Candidate> list_candidates(const TetMesh& mesh,
                                       std::span<const std::uint64_t> seen,
                                       std::span<const std::uint64_t> first,
                                       const Cancellation& cancellation) {
  std::vector<Candidate> all(first.back());
  for_each_index(first.size() - 1, [&](std::size_t range) {
    if (cancellation.requested()) return;
    std::uint64_t at = first[range];
    for_candidates_of_range(mesh, seen, range, [&](const Candidate& one) { all[at++] = one; });
  });
  return all;
}

/// The candidates of each lowest vertex, by their places among all: a counting sort.
struct ByLowest {
  std::vector<std::uint64_t> first;  ///< of each vertex, and one more
  std::vector<std::uint64_t> place;

  ByLowest(std::span<const Candidate> candidates,
           std::uint64_t vertices,
           const Cancellation& cancellation)
      : first(vertices + 1), place(candidates.size()) {
    for_each_in_order(candidates.size(), cancellation,
                      [&](std::uint64_t i) { ++first[candidates[i].low + 1]; });
    for_each_in_order(vertices, cancellation,
                      [&](std::uint64_t i) { first[i + 1] += first[i]; });
    if (cancellation.requested()) return;  // places may be wrong
    std::vector<std::uint64_t> next(first.begin(), first.end() - 1);
    for_each_in_order(candidates.size(), cancellation,
                      [&](std::uint64_t i) { place[next[candidates[i].low]++] = i; });
  }
};

enum class FaceSide : std::uint8_t { kNone, kOuter, kInterface };

/// What became of each candidate.
struct Verdicts {
  std::vector<FaceSide> side;
  std::vector<LabelNumber> behind;
};

/// Sorts some candidates with one lowest vertex, and says which of them are faces.
void match(const TetMesh& mesh,
           std::span<const Candidate> candidates,
           std::span<std::uint64_t> places,
           Verdicts& verdicts) {
  const auto vertices = [&](std::uint64_t place) {
    return std::pair(candidates[place].middle, candidates[place].high);
  };
  std::ranges::sort(places, [&](std::uint64_t a, std::uint64_t b) {
    return std::pair(vertices(a), a) < std::pair(vertices(b), b);
  });
  for (std::size_t begin = 0, end = 0; begin < places.size(); begin = end) {
    while (end < places.size() && vertices(places[end]) == vertices(places[begin])) ++end;
    if (end - begin == 1) verdicts.side[places[begin]] = FaceSide::kOuter;
    if (end - begin != 2) continue;
    const auto group = [&](std::size_t i) {
      return group_of(mesh, candidates[places[i]].index / 4);
    };
    if (group(begin) == group(begin + 1)) continue;
    const bool second = group(begin + 1) < group(begin);
    const std::uint64_t place = places[second ? begin + 1 : begin];
    verdicts.side[place] = FaceSide::kInterface;
    verdicts.behind[place] = static_cast<LabelNumber>(group(second ? begin : begin + 1));
  }
}

std::vector<TetFace> faces_of(std::span<const Candidate> candidates,
                              const Verdicts& verdicts,
                              const Cancellation& cancellation) {
  std::vector<TetFace> faces;
  faces.reserve(candidates.size() -
                static_cast<std::size_t>(std::ranges::count(verdicts.side, FaceSide::kNone)));
  for_each_in_order(candidates.size(), cancellation, [&](std::uint64_t i) {
    const FaceSide side = verdicts.side[i];
    if (side == FaceSide::kNone) return;
    faces.push_back({candidates[i].index, side == FaceSide::kInterface, verdicts.behind[i]});
  });
  return faces;
}

}  // namespace

FaceSearch::FaceSearch(const TetMesh& mesh, const Cancellation& cancellation)
    : mesh_(mesh),
      cancellation_(cancellation),
      seen_(xor_seen_faces(mesh, cancellation)),
      first_(count_candidates(mesh, seen_, cancellation)) {}

std::uint64_t FaceSearch::bytes_of(std::uint64_t vertices, std::uint64_t candidates) noexcept {
  // Two numbers of a vertex, whether they are what is seen around it or sort the candidates.
  constexpr std::uint64_t kPerVertex = 2 * sizeof(std::uint64_t);
  // A candidate with its place among those of a vertex, and the face that it may be. The
  // columns of faces, 34 bytes each at most, are made when candidates are gone.
  constexpr std::uint64_t kPerCandidate = sizeof(Candidate) + sizeof(std::uint64_t) +
                                          sizeof(FaceSide) + sizeof(LabelNumber) +
                                          sizeof(TetFace);
  return kPerVertex * vertices + kPerCandidate * candidates;
}

std::vector<TetFace> FaceSearch::find() {
  if (cancellation_.requested()) return {};  // counts are missing
  const std::vector<Candidate> candidates =
      list_candidates(mesh_, seen_, first_, cancellation_);
  seen_ = {};
  if (cancellation_.requested()) return {};
  const std::uint64_t vertices = mesh_.header.vertex_count;
  ByLowest by_lowest(candidates, vertices, cancellation_);
  if (cancellation_.requested()) return {};
  Verdicts verdicts{std::vector<FaceSide>(candidates.size(), FaceSide::kNone),
                    std::vector<LabelNumber>(candidates.size(), kNoLabelBehind)};
  for_each_range(vertices, kVerticesPerRange, [&](std::size_t begin, std::size_t end) {
    if (cancellation_.requested()) return;
    for (std::size_t vertex = begin; vertex < end; ++vertex) {
      const std::uint64_t first = by_lowest.first[vertex];
      match(mesh_, candidates,
            std::span(by_lowest.place).subspan(first, by_lowest.first[vertex + 1] - first),
            verdicts);
    }
  });
  return faces_of(candidates, verdicts, cancellation_);
}

}  // namespace tet
