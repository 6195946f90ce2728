#include "tests/support/mesh_promises.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/mesh/boundary.h"
#include "core/mesh/quality.h"
#include "core/plan/make/mesher.h"
#include "core/volume/volume_reader.h"
#include "tests/support/conformity.h"
#include "tests/support/lattice_place.h"
#include "tests/support/lattice_signs.h"
#include "tests/support/random_fields.h"
#include "tests/support/random_sizing.h"

namespace tet::test {
namespace {

/// One seed in three asks for a manifold, and one in eight for better angles.
bool is_manifold(const FieldCase& given) { return given.seed % 3 == 2; }
bool is_improved(const FieldCase& given) { return given.seed % 8 == 4; }

/// Two seeds in three ask for sizes, in the graded mesh.
bool is_sized(const FieldCase& given) { return given.seed % 3 != 2; }

/// What the lattice says of the place where a vertex lies.
enum VertexPlace : std::uint8_t {
  kInsideNode = 1,
  kOutsideNode = 2,
  kSurface = 4,     ///< a zero node, or the surface crosses an edge there
  kOffLattice = 8,  ///< on no lattice edge
};

/// A field, its mesh, and what the checks want to know of both.
struct Meshed {
  const FieldCase& given;
  const RandomField& field;
  const LatticeSigns& signs;
  MeshResult result;
  QualityStats measured;
  std::vector<std::uint8_t> place;  ///< of each vertex: VertexPlace
  std::vector<bool> is_vertex;      ///< uniform meshes: which lattice nodes are
  std::vector<Triangle> boundary;   ///< of the inside; where both sides meet

  const TetMesh& mesh() const noexcept { return result.mesh; }
  bool uniform() const noexcept { return result.mesh.header.levels == 0; }
  bool both_sides() const noexcept { return result.mesh.header.has_regions; }
};

std::string check_quality(const Meshed& meshed) {
  const auto [min, max] = angle_bounds(meshed.given.preset, CoordinateType::kFloat64);
  const QualityStats& measured = meshed.measured;
  const QualityStats& reported = meshed.result.quality;
  if (measured.min_dihedral_deg < min || measured.max_dihedral_deg > max) {
    return absl::StrFormat("dihedral angles of %.4f to %.4f degrees", measured.min_dihedral_deg,
                           measured.max_dihedral_deg);
  }
  if (std::abs(measured.min_dihedral_deg - reported.min_dihedral_deg) > 0.01 ||
      std::abs(measured.max_dihedral_deg - reported.max_dihedral_deg) > 0.01 ||
      std::abs(measured.volume - reported.volume) > 1e-5 * measured.volume) {
    return absl::StrFormat(
        "angles of %.4f to %.4f degrees and a volume of %.9g are reported as %.4f to %.4f and "
        "%.9g",
        measured.min_dihedral_deg, measured.max_dihedral_deg, measured.volume,
        reported.min_dihedral_deg, reported.max_dihedral_deg, reported.volume);
  }
  return "";
}

/// Notes where the vertices lie.
void find_places(Meshed& meshed) {
  const LatticeSigns& signs = meshed.signs;
  const double doubled = 2 / meshed.given.spacing;
  if (meshed.uniform()) meshed.is_vertex.resize(signs.node_count());
  for (std::uint64_t v = 0; v < meshed.mesh().header.vertex_count; ++v) {
    const WorldPoint p = meshed.mesh().vertex(v);
    const LatticePlace place = place_on_lattice({p.x * doubled, p.y * doubled, p.z * doubled});
    std::uint8_t flags = place.on_lattice ? 0 : kOffLattice;
    if (place.on_lattice && !place.is_node()) {
      // A zero node that was put back for a manifold is outside, and its edges are cut.
      const bool crossed = signs.opposite(place.low, place.high) ||
                           (is_manifold(meshed.given) && signs.touch(place.low, place.high));
      flags = crossed ? kSurface : 0;
    } else if (place.on_lattice) {
      const int sign = signs.at(place.low);
      if (sign != 0) flags = sign < 0 ? kInsideNode : kOutsideNode;
      if (sign == 0 || signs.has_opposite_neighbour(place.low)) flags |= kSurface;
      if (meshed.uniform() && signs.holds(place.low)) {
        meshed.is_vertex[signs.index_of(place.low)] = true;
      }
    }
    meshed.place.push_back(flags);
  }
}

std::string describe(const Meshed& meshed, std::uint64_t vertex, const char* what) {
  const WorldPoint p = meshed.mesh().vertex(vertex);
  return absl::StrFormat("vertex %d at (%.6f, %.6f, %.6f) %s", vertex, p.x, p.y, p.z, what);
}

std::string check_vertices(const Meshed& meshed) {
  if (meshed.both_sides()) return "";  // vertices may lie on either side; see check_regions
  for (std::uint64_t v = 0; v < meshed.place.size(); ++v) {
    if ((meshed.place[v] & (kInsideNode | kSurface)) == 0) {
      return describe(meshed, v, "is neither an inside node nor where the surface passes");
    }
  }
  return "";
}

/// No tet reaches a node beyond the surface.
std::string check_regions(const Meshed& meshed) {
  for (std::uint64_t t = 0; t < meshed.mesh().header.tet_count; ++t) {
    const bool inside = meshed.mesh().region(t) == MeshRegion::kInside;
    const std::uint8_t beyond = inside ? kOutsideNode : kInsideNode;
    for (const std::uint64_t v : meshed.mesh().tet(t)) {
      if (meshed.place[v] == beyond) {
        return describe(meshed, v,
                        inside ? "is outside, its tet is not" : "is inside, its tet is not");
      }
    }
  }
  return "";
}

/// Every node far from the surface is a vertex of the uniform mesh.
std::string check_nodes(const Meshed& meshed) {
  for (std::size_t i = 0; i < meshed.is_vertex.size(); ++i) {
    if (meshed.is_vertex[i]) continue;
    const LatticeCoord node = meshed.signs.node_of(i);
    // Outside, the mesh ends with the box, a brick before the signs do.
    const bool missing =
        meshed.signs.deep(node, -1) ||
        (meshed.both_sides() && meshed.signs.deep(node, 1) && !meshed.signs.in_margin(node));
    if (missing) {
      return absl::StrFormat("the node (%.1f, %.1f, %.1f) far from the surface is no vertex",
                             0.5 * node.x, 0.5 * node.y, 0.5 * node.z);
    }
  }
  return "";
}

std::string check_boundary(const Meshed& meshed) {
  // Off the voxels the field along an edge is in pieces, and secants take longer.
  const double max_phi = meshed.field.max_surface_phi * (meshed.given.spacing == 1 ? 1 : 5);
  // Nodes that are put back take the surface with them.
  const bool moved = !meshed.result.boundary || meshed.result.boundary->restored_nodes > 0;
  VolumeReader reader(meshed.field.volume);
  for (const Triangle& triangle : meshed.boundary) {
    for (const std::uint64_t v : triangle) {
      const bool fan = meshed.both_sides() && meshed.place[v] == kOffLattice;
      if (!fan && (meshed.place[v] & kSurface) == 0) {
        return describe(meshed, v, "is on the boundary, where no surface passes");
      }
      if (fan || moved || max_phi == 0) continue;
      const WorldPoint p = meshed.mesh().vertex(v);
      const double phi = reader.trilinear({p.x, p.y, p.z});
      if (std::abs(phi) > max_phi) {
        return describe(meshed, v, absl::StrFormat("is off the surface by %g", phi).c_str());
      }
    }
  }
  return "";
}

std::string words(const BoundaryTopology& t) {
  return absl::StrFormat(
      "%d triangles, %d components, Euler characteristic %d, %d edges and %d vertices that are "
      "no manifold",
      t.triangles, t.components, t.euler_characteristic, t.non_manifold_edges,
      t.non_manifold_vertices);
}

std::string check_topology(const Meshed& meshed) {
  const bool known = meshed.field.topology && meshed.given.spacing <= 1;
  if (!known && meshed.given.seed % 3 == 0) return "";  // it takes a third of all the time
  BoundaryTopology found = measure_topology(meshed.boundary, meshed.mesh().header.vertex_count);
  const std::optional<BoundaryTopology>& counted = meshed.result.boundary;
  if (counted) found.restored_nodes = counted->restored_nodes;
  if (counted && *counted != found) {
    return absl::StrCat("the boundary has ", words(found), "; counted were ", words(*counted));
  }
  const bool manifold = found.non_manifold_edges == 0 && found.non_manifold_vertices == 0;
  if (counted && is_manifold(meshed.given) && !manifold) {
    return absl::StrCat("a manifold was asked for: ", words(found));
  }
  if (!known) return "";
  const Topology& expected = *meshed.field.topology;
  if (manifold && found.components == expected.components &&
      found.euler_characteristic == expected.euler_characteristic) {
    return "";
  }
  return absl::StrFormat("the field has %d components and Euler characteristic %d: %s",
                         expected.components, expected.euler_characteristic, words(found));
}

std::string check_mesh(const Meshed& meshed) {
  const ConformityReport conformity = check_conformity(meshed.mesh());
  if (!conformity.conforming()) return conformity.describe();
  if (is_improved(meshed.given)) {  // vertices have left the lattice
    const std::string violation = check_quality(meshed);
    return violation.empty() ? check_topology(meshed) : violation;
  }
  for (const auto& check : {check_quality, check_vertices, check_regions, check_nodes,
                            check_boundary, check_topology}) {
    if (std::string violation = check(meshed); !violation.empty()) return violation;
  }
  return "";
}

std::string check_graded_against_uniform(const Meshed& graded, const Meshed& uniform) {
  const double expected = uniform.result.quality.volume;
  // What was moved to better angles has not the same volume.
  const double tolerance = is_improved(graded.given) ? 0.02 : 1e-9;
  if (std::abs(graded.result.quality.volume - expected) > tolerance * expected) {
    return absl::StrFormat("the graded mesh has a volume of %.12g, the uniform one of %.12g",
                           graded.result.quality.volume, expected);
  }
  if (graded.boundary.size() != uniform.boundary.size()) {
    return absl::StrFormat("the graded mesh has %d boundary triangles, the uniform one %d",
                           graded.boundary.size(), uniform.boundary.size());
  }
  return "";
}

std::string check_bytes(const Meshed& meshed,
                        const std::shared_ptr<const Volume>& volume,
                        const MeshRequest& request) {
  for (const int threads : {1, 3}) {
    TaskPool pool(threads);
    MeshLimits limits;
    limits.chunk_bytes = std::size_t{1} << (threads == 1 ? 30 : 14);
    limits.kept_geometry_bytes = threads == 1 ? 0 : 20000;  // none of it, and some
    const auto again =
        mesh_volume(pool, {.shape = volume, .request = request, .limits = limits});
    const bool same =
        again.ok() &&
        std::ranges::equal(again->mesh.tets.bytes(), meshed.mesh().tets.bytes()) &&
        std::ranges::equal(again->mesh.positions.bytes(), meshed.mesh().positions.bytes()) &&
        std::ranges::equal(again->mesh.regions.bytes(), meshed.mesh().regions.bytes());
    if (!same) {
      return absl::StrFormat("%d threads and chunks of %d bytes make another mesh", threads,
                             limits.chunk_bytes);
    }
  }
  return "";
}

LatticeSigns signs_around(const RandomField& field, double spacing) {
  PhiField phi;
  phi.volume = &field.volume;
  phi.spacing_voxels = spacing;
  BrickCoord min{INT32_MAX, INT32_MAX, INT32_MAX}, max{INT32_MIN, INT32_MIN, INT32_MIN};
  for (const BrickCoord b : field.volume.bricks) {
    min = {std::min(min.x, b.x), std::min(min.y, b.y), std::min(min.z, b.z)};
    max = {std::max(max.x, b.x), std::max(max.y, b.y), std::max(max.z, b.z)};
  }
  // In bricks of the lattice, with one more all around.
  const auto low = [&](std::int32_t b) {
    return static_cast<std::int32_t>(std::floor(b / spacing)) - 1;
  };
  const auto high = [&](std::int32_t b) {
    return static_cast<std::int32_t>(std::ceil((b + 1) / spacing));
  };
  return {phi, {low(min.x), low(min.y), low(min.z)}, {high(max.x), high(max.y), high(max.z)}};
}

/// Where the inside ends: at the outside, not at the box around both.
std::vector<Triangle> surface_of(const TetMesh& mesh) {
  std::vector<Triangle> outer = boundary_triangles(mesh);
  if (!mesh.header.has_regions) return outer;
  std::vector<Triangle> inner = boundary_triangles(mesh, MeshRegion::kInside), surface;
  std::ranges::sort(outer);
  std::ranges::sort(inner);
  std::ranges::set_difference(inner, outer, std::back_inserter(surface));
  return surface;
}

Meshed examine(const FieldCase& given,
               const RandomField& field,
               const LatticeSigns& signs,
               MeshResult result) {
  Meshed meshed{given, field, signs, std::move(result), {}, {}, {}, {}};
  meshed.measured = measure_quality(meshed.mesh());
  meshed.boundary = surface_of(meshed.mesh());
  find_places(meshed);
  return meshed;
}

/// The first promise that one of the two meshes breaks.
std::string check_both(const Meshed& uniform,
                       const Meshed& graded,
                       const std::shared_ptr<const Volume>& volume,
                       const MeshRequest& request) {
  std::string violation = check_mesh(uniform);
  if (!violation.empty()) return absl::StrCat("uniform: ", violation);
  violation = check_mesh(graded);
  if (violation.empty()) violation = check_graded_against_uniform(graded, uniform);
  if (violation.empty() && graded.given.seed % 4 == 0) {
    violation = check_bytes(graded, volume, request);
  }
  return violation.empty() ? violation : absl::StrCat("graded: ", violation);
}

/// A field that leaves nothing to mesh is no violation.
std::string check_refusal(const absl::Status& uniform, const absl::Status& graded) {
  if (absl::IsFailedPrecondition(uniform) && uniform == graded &&
      absl::StrContains(uniform.message(), "to mesh")) {
    return "";
  }
  return absl::StrCat("uniform: ", uniform.ToString(), "; graded: ", graded.ToString());
}

/// Notes a mesh's size and angles.
void add(Outcome& outcome, const MeshResult& result) {
  outcome.tets += result.mesh.header.tet_count;
  outcome.min_dihedral_deg =
      std::min(outcome.min_dihedral_deg, result.quality.min_dihedral_deg);
  outcome.max_dihedral_deg =
      std::max(outcome.max_dihedral_deg, result.quality.max_dihedral_deg);
}

}  // namespace

std::string arguments_of(const FieldCase& c) {
  return absl::StrFormat("--family %s --seed %d --edge %d --preset %s --spacing %.17g",
                         c.family, c.seed, c.edge, preset_name(c.preset), c.spacing);
}

Outcome check_promises(const FieldCase& given, TaskPool& pool) {
  const RandomField field = random_field(given.family, given.seed, given.edge);
  const auto volume = std::make_shared<const Volume>(field.volume);
  MeshRequest request;
  request.spacing = given.spacing;
  request.preset = given.preset;
  request.manifold = is_manifold(given);
  request.improve = is_improved(given);
  request.coordinates =
      given.seed % 2 == 0 ? CoordinateType::kFloat32 : CoordinateType::kFloat64;
  if (is_sized(given)) {
    const double edge = given.edge;
    request.sizing = random_sizing(given.seed, {{0, 0, 0}, {edge, edge, edge}}, given.spacing);
  }
  const auto mesh = [&](int levels) {
    request.levels = levels;
    return mesh_volume(pool, {.shape = volume, .request = request});
  };
  absl::StatusOr<MeshResult> uniform = mesh(0), graded = mesh(kMaxLevels);
  Outcome outcome;
  if (!uniform.ok() || !graded.ok()) {
    outcome.violation = check_refusal(uniform.status(), graded.status());
    return outcome;
  }
  add(outcome, *uniform);
  add(outcome, *graded);
  pool.run([&] {
    const LatticeSigns signs = signs_around(field, given.spacing);
    outcome.violation =
        check_both(examine(given, field, signs, *std::move(uniform)),
                   examine(given, field, signs, *std::move(graded)), volume, request);
  });
  return outcome;
}

}  // namespace tet::test
