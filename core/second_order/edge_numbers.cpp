#include "core/second_order/edge_numbers.h"

#include <algorithm>
#include <limits>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/base/loop_in_order.h"
#include "core/base/parallel.h"
#include "core/second_order/middle_nodes.h"

namespace tet {
namespace {

constexpr std::size_t kVerticesPerRange = 1024;
constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();

absl::Status too_many(const char* what, std::uint64_t count) {
  return absl::ResourceExhaustedError(
      absl::StrFormat("a mesh of second order takes %d %s and this one has %d: mesh it with a "
                      "larger spacing",
                      kMost, what, count));
}

/// The higher vertices of edges, tet by tet, so that an edge is there once for each of its
/// tets.
struct HigherVertices {
  std::vector<std::uint64_t> first;
  std::vector<std::uint32_t> vertices;

  std::span<std::uint32_t> of(std::uint64_t vertex) noexcept {
    return std::span(vertices).subspan(first[vertex], first[vertex + 1] - first[vertex]);
  }
};

/// Once cancelled it is of no use.
HigherVertices gather(const MeshView& mesh,
                      std::uint64_t vertex_count,
                      const Cancellation& cancellation) {
  std::vector<std::uint32_t> count(vertex_count);
  const auto visit_edges = [&](const auto& visit) {
    for_each_in_order(mesh.tet_count(), cancellation, [&](std::uint64_t i) {
      const auto tet = mesh.tet(i);
      for (const auto& [a, b] : kTetEdges)
        visit(std::min(tet[a], tet[b]), std::max(tet[a], tet[b]));
    });
  };
  visit_edges([&](std::uint64_t low, std::uint64_t) { ++count[low]; });
  HigherVertices found;
  found.first = offsets_from_counts(vertex_count, [&](std::size_t v) { return count[v]; });
  if (cancellation.requested()) return found;  // there may be too little room
  found.vertices.resize(found.first.back());
  std::vector<std::uint64_t> next(found.first.begin(), found.first.end() - 1);
  visit_edges([&](std::uint64_t low, std::uint64_t high) {
    found.vertices[next[low]++] = static_cast<std::uint32_t>(high);
  });
  return found;
}

}  // namespace

std::uint32_t EdgeNumbers::find(std::uint64_t a, std::uint64_t b) const noexcept {
  const auto [low, high] = std::minmax(a, b);
  const auto begin = higher.begin() + static_cast<std::ptrdiff_t>(first[low]);
  const auto end = higher.begin() + static_cast<std::ptrdiff_t>(first[low + 1]);
  return static_cast<std::uint32_t>(std::lower_bound(begin, end, high) - higher.begin());
}

absl::StatusOr<EdgeNumbers> number_edges(const MeshView& mesh,
                                         std::uint64_t vertex_count,
                                         const Cancellation& cancellation) {
  if (vertex_count > kMost) return too_many("vertices", vertex_count);
  HigherVertices found = gather(mesh, vertex_count, cancellation);
  if (auto status = check_cancelled(cancellation); !status.ok()) return status;
  std::vector<std::uint32_t> count(vertex_count);
  for_each_index(
      vertex_count,
      [&](std::size_t v) {
        const std::span<std::uint32_t> all = found.of(v);
        std::ranges::sort(all);
        count[v] =
            static_cast<std::uint32_t>(std::unique(all.begin(), all.end()) - all.begin());
      },
      kVerticesPerRange);
  EdgeNumbers edges;
  edges.first = offsets_from_counts(vertex_count, [&](std::size_t v) { return count[v]; });
  if (edges.first.back() > kMost) return too_many("edges", edges.first.back());
  edges.higher.resize(edges.first.back());
  for_each_index(
      vertex_count,
      [&](std::size_t v) {
        std::copy_n(found.of(v).begin(), count[v],
                    edges.higher.begin() + static_cast<std::ptrdiff_t>(edges.first[v]));
      },
      kVerticesPerRange);
  const std::uint64_t tets = mesh.tet_count();
  edges.of_tets.resize(6 * tets);
  for_each_index(
      tets,
      [&](std::size_t i) {
        const auto tet = mesh.tet(i);
        for (std::size_t e = 0; e < 6; ++e) {
          edges.of_tets[6 * i + e] = edges.find(tet[kTetEdges[e][0]], tet[kTetEdges[e][1]]);
        }
      },
      kVerticesPerRange);
  return edges;
}

}  // namespace tet
