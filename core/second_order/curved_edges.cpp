#include "core/second_order/curved_edges.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>

#include "core/base/parallel.h"
#include "core/base/tet_geometry.h"
#include "core/fidelity/surface_triangles.h"
#include "core/field/world_phi.h"
#include "core/field/zero_along.h"
#include "core/mesh/tets_per_range.h"
#include "core/second_order/middle_nodes.h"

namespace tet {
namespace {

constexpr std::size_t kEdgesPerRange = 256;
/// How far from the middle of an edge the surface may be, by the edge's length: a circle's arc
/// that is so high above its chord turns by a right angle.
constexpr double kReach = 0.25;
constexpr double kClose = 1e-7;  ///< to the surface, by the edge's length
constexpr double kStep = 1e-4;   ///< that a scene's slope is measured over, in spacings

double norm_of(const Vector& v) noexcept { return std::sqrt(dot(v, v)); }

/// The slope within the faces of a box that a point is to stay in.
Vector within_faces(Vector slope, std::uint32_t faces, const VoxelTransform& lattice) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if ((faces >> (2 * axis) & 3U) == 0) continue;
    const double scale = 1 / lattice.voxel_size;
    const Vector normal{scale * lattice.linear[0][axis], scale * lattice.linear[1][axis],
                        scale * lattice.linear[2][axis]};
    const double out = dot(slope, normal);
    slope = {slope.x - out * normal.x, slope.y - out * normal.y, slope.z - out * normal.z};
  }
  return slope;
}

/// The way from `middle` to the surface; nothing where it is not near.
std::optional<Vector> way_to_surface(WorldPhi& phi,
                                     const WorldPoint& middle,
                                     double length,
                                     std::uint32_t faces,
                                     const VoxelTransform& lattice) noexcept {
  const Vector slope = within_faces(phi.slope_at(middle).gradient, faces, lattice);
  const double steepness = norm_of(slope);
  if (!(steepness > 0)) return std::nullopt;
  const Vector up{slope.x / steepness, slope.y / steepness, slope.z / steepness};
  const auto phi_at = [&](double t) {
    return phi.at({middle.x + t * up.x, middle.y + t * up.y, middle.z + t * up.z});
  };
  const auto t = zero_along(phi_at, steepness, {kReach * length, kClose * length});
  if (!t) return std::nullopt;
  return Vector{*t * up.x, *t * up.y, *t * up.z};
}

}  // namespace

CurvedEdges::CurvedEdges(const TetMesh& mesh,
                         const EdgeNumbers& edges,
                         const std::vector<Triangle>& surface)
    : mesh_(mesh), edges_(edges), slot_(edges.count(), kNone) {
  for (const auto& [a, b, c] : surface) {
    slot_[edges.find(a, b)] = slot_[edges.find(b, c)] = slot_[edges.find(c, a)] = 0;
  }
  for (std::uint64_t vertex = 0; vertex + 1 < edges.first.size(); ++vertex) {
    edges.visit_from(vertex, [&](std::uint64_t edge, std::uint64_t low, std::uint64_t high) {
      if (slot_[edge] == kNone) return;
      slot_[edge] = static_cast<std::uint32_t>(surface_.size());
      surface_.push_back({low, high});
    });
  }
}

void CurvedEdges::bend(const PhiField& field,
                       std::uint64_t first_vertex,
                       std::uint64_t vertex_count,
                       const Cancellation& cancellation) {
  const VoxelTransform lattice = field.lattice_transform();
  const MeshHeader& header = mesh_.header;
  for_each_range(surface_.size(), kEdgesPerRange, [&](std::size_t begin, std::size_t end) {
    if (cancellation.requested()) return;
    WorldPhi phi(field, kStep * header.spacing);
    for (std::size_t i = begin; i < end; ++i) {
      Edge& edge = surface_[i];
      if (edge.low < first_vertex || edge.low - first_vertex >= vertex_count) continue;
      const WorldPoint a = mesh_.vertex(edge.low), b = mesh_.vertex(edge.high);
      const WorldPoint middle{(a.x + b.x) / 2, (a.y + b.y) / 2, (a.z + b.z) / 2};
      const std::uint32_t faces =
          box_faces_at(mesh_, edge.low) & box_faces_at(mesh_, edge.high);
      const auto way = way_to_surface(phi, middle, norm_of(from_to(a, b)), faces, lattice);
      edge.bend = way.value_or(Vector{});
      edge.halvings = way ? 0 : kStraight;
    }
  });
}

Vector CurvedEdges::offset_of(const Edge& edge) const noexcept {
  if (edge.halvings == kStraight) return {};
  const double scale = std::ldexp(1.0, -edge.halvings);
  return {scale * edge.bend.x, scale * edge.bend.y, scale * edge.bend.z};
}

Vector CurvedEdges::offset(std::uint64_t edge) const noexcept {
  return slot_[edge] == kNone ? Vector{} : offset_of(surface_[slot_[edge]]);
}

bool CurvedEdges::is_good(std::uint64_t tet) const noexcept {
  const std::array<WorldPoint, 4> corner = mesh_.view().stored_places(tet);
  TenNodes node;
  std::ranges::copy(corner, node.begin());
  bool is_curved = false;
  for (std::size_t e = 0; e < 6; ++e) {
    const auto& [i, j] = kTetEdges[e];
    const Vector off = offset(edges_.of_tets[6 * tet + e]);
    is_curved = is_curved || dot(off, off) > 0;
    node[4 + e] = stored_middle(mesh_.header, corner[i], corner[j], off);
  }
  if (!is_curved) return true;
  const Vector b = from_to(corner[0], corner[1]), c = from_to(corner[0], corner[2]),
               d = from_to(corner[0], corner[3]);
  return least_jacobian(node) >= kLeastShare * dot(cross(b, c), d);
}

void CurvedEdges::keep_tets_good(const Cancellation& cancellation) {
  const std::uint64_t tets = mesh_.header.tet_count;
  std::vector<std::vector<std::uint64_t>> bad((tets + kTetsPerRange - 1) / kTetsPerRange);
  // A bad tet has an edge that is not straight yet, so this ends.
  while (!cancellation.requested()) {
    for_each_index(bad.size(), [&](std::size_t r) {
      bad[r].clear();
      const std::uint64_t end = std::min(tets, (r + 1) * kTetsPerRange);
      for (std::uint64_t tet = r * kTetsPerRange; tet < end; ++tet) {
        if (!is_good(tet)) bad[r].push_back(tet);
      }
    });
    bool any = false;
    std::vector<bool> halved(surface_.size());
    for (const std::vector<std::uint64_t>& range : bad) {
      for (const std::uint64_t tet : range) {
        any = true;
        for (std::size_t e = 0; e < 6; ++e) {
          const std::uint32_t slot = slot_[edges_.of_tets[6 * tet + e]];
          if (slot != kNone) halved[slot] = true;
        }
      }
    }
    if (!any) return;
    for (std::size_t i = 0; i < halved.size(); ++i) {
      Edge& edge = surface_[i];
      if (halved[i] && edge.halvings < kStraight) ++edge.halvings;
    }
  }
}

std::uint64_t CurvedEdges::curved() const noexcept {
  return static_cast<std::uint64_t>(std::ranges::count_if(surface_, [&](const Edge& edge) {
    const Vector off = offset_of(edge);
    return dot(off, off) > 0;
  }));
}

std::uint64_t CurvedEdges::straightened() const noexcept {
  return static_cast<std::uint64_t>(
      std::ranges::count_if(surface_, [](const Edge& edge) { return edge.halvings > 0; }));
}

}  // namespace tet
