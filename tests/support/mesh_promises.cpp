#include "tests/support/mesh_promises.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include <absl/strings/match.h>
#include <absl/strings/str_format.h>

#include "core/grid/volume_reader.h"
#include "core/mesh/boundary.h"
#include "core/mesh/conformity.h"
#include "core/mesh/quality.h"
#include "core/pipeline/mesher.h"
#include "tests/support/lattice_signs.h"
#include "tests/support/random_fields.h"

namespace tet::test {
namespace {

struct AngleBounds {
  double min_deg, max_deg;
};

AngleBounds angle_bounds(Preset preset) {
  return preset == Preset::kMinAngle ? AngleBounds{11.8, 161.2} : AngleBounds{11.3, 154.9};
}

/// A field, its mesh, and what the checks want to know of both.
struct Meshed {
  const FieldCase& given;
  const RandomField& field;
  const LatticeSigns& signs;
  MeshResult result;
  std::vector<Triangle> boundary;

  const TetMesh& mesh() const noexcept { return result.mesh; }
  bool uniform() const noexcept { return result.mesh.header.levels == 0; }
};

std::string check_angles(const Meshed& meshed) {
  const auto [min, max] = angle_bounds(meshed.given.preset);
  const QualityStats measured = measure_quality(meshed.mesh());
  const QualityStats& reported = meshed.result.quality;
  if (measured.min_dihedral_deg < min || measured.max_dihedral_deg > max) {
    return absl::StrFormat("dihedral angles of %.4f to %.4f degrees", measured.min_dihedral_deg,
                           measured.max_dihedral_deg);
  }
  if (std::abs(measured.min_dihedral_deg - reported.min_dihedral_deg) > 0.01 ||
      std::abs(measured.max_dihedral_deg - reported.max_dihedral_deg) > 0.01) {
    return absl::StrFormat("angles of %.4f to %.4f degrees are reported as %.4f to %.4f",
                           measured.min_dihedral_deg, measured.max_dihedral_deg,
                           reported.min_dihedral_deg, reported.max_dihedral_deg);
  }
  return "";
}

/// Where on the lattice a vertex lies: at a node (both ends are it), or on an edge.
struct LatticePlace {
  LatticeCoord low, high;
  bool on_lattice = false;

  bool is_node() const noexcept { return low == high; }
};

/// Coordinates doubled.
LatticePlace place_on_lattice(const std::array<double, 3>& p) {
  constexpr double kNear = 1e-3;  // far above rounding, far below what warps and cuts move
  std::array<std::int32_t, 3> low{};
  std::array<double, 3> off{};
  const auto place = [&](const std::array<std::int32_t, 3>& high) {
    return LatticePlace{
        { low[0],  low[1],  low[2]},
        {high[0], high[1], high[2]},
        true
    };
  };
  for (const std::int32_t kind : {kCentre, kCorner}) {
    for (std::size_t i = 0; i < 3; ++i) {
      low[i] = 2 * static_cast<std::int32_t>(std::lround((p[i] - kind) / 2)) + kind;
      off[i] = p[i] - low[i];
    }
    const auto far = [](double t) { return std::abs(t) >= kNear; };
    std::array<std::int32_t, 3> high = low;
    const auto count = std::ranges::count_if(off, far);
    if (count == 0) return place(high);
    if (count > 1) continue;
    const auto along = static_cast<std::size_t>(std::ranges::find_if(off, far) - off.begin());
    high[along] += off[along] < 0 ? -2 : 2;
    return place(high);
  }
  std::array<std::int32_t, 3> high = low;  // low is a corner by now
  for (std::size_t i = 0; i < 3; ++i) high[i] += off[i] < 0 ? -1 : 1;
  const auto length = [](double t) { return std::abs(t); };
  const auto [shortest, longest] = std::ranges::minmax(off, {}, length);
  return length(longest) - length(shortest) < kNear ? place(high) : LatticePlace{};
}

LatticePlace place_of(const Meshed& meshed, std::uint64_t vertex) {
  const WorldPoint p = meshed.mesh().vertex(vertex);
  const double doubled = 2 / meshed.given.spacing;
  return place_on_lattice({p.x * doubled, p.y * doubled, p.z * doubled});
}

/// True where the surface passes: at a zero node, or on an edge that changes sign.
bool on_surface(const LatticeSigns& signs, const LatticePlace& place) {
  if (!place.is_node()) return signs.opposite(place.low, place.high);
  return signs.at(place.low) == 0 || signs.has_opposite_neighbour(place.low);
}

std::string describe(const Meshed& meshed, std::uint64_t vertex, const char* what) {
  const WorldPoint p = meshed.mesh().vertex(vertex);
  return absl::StrFormat("vertex %d at (%.6f, %.6f, %.6f) %s", vertex, p.x, p.y, p.z, what);
}

std::string check_vertices(const Meshed& meshed) {
  const LatticeSigns& signs = meshed.signs;
  std::vector<bool> is_vertex(meshed.uniform() ? signs.node_count() : 0);
  for (std::uint64_t v = 0; v < meshed.mesh().header.vertex_count; ++v) {
    const LatticePlace place = place_of(meshed, v);
    if (!place.on_lattice) return describe(meshed, v, "is on no lattice edge");
    const bool inside = place.is_node() && signs.at(place.low) < 0;
    if (!inside && !on_surface(signs, place)) {
      return describe(meshed, v, "is neither inside nor where the surface passes");
    }
    if (inside && meshed.uniform()) is_vertex[signs.index_of(place.low)] = true;
  }
  for (std::size_t i = 0; i < is_vertex.size(); ++i) {
    const LatticeCoord node = signs.node_of(i);
    if (!is_vertex[i] && signs.deep_inside(node)) {
      return absl::StrFormat("the node (%.1f, %.1f, %.1f) deep inside is no vertex",
                             0.5 * node.x, 0.5 * node.y, 0.5 * node.z);
    }
  }
  return "";
}

std::string check_boundary(const Meshed& meshed) {
  constexpr double kMaxDistance = 0.02;  // voxels
  VolumeReader reader(meshed.field.volume);
  for (const Triangle& triangle : meshed.boundary) {
    for (const std::uint64_t v : triangle) {
      if (!on_surface(meshed.signs, place_of(meshed, v))) {
        return describe(meshed, v, "is on the boundary, where no surface passes");
      }
      if (!meshed.field.smooth) continue;
      const WorldPoint p = meshed.mesh().vertex(v);
      const double phi = reader.trilinear({p.x, p.y, p.z});
      if (std::abs(phi) > kMaxDistance) {
        return describe(meshed, v, absl::StrFormat("is off the surface by %g", phi).c_str());
      }
    }
  }
  return "";
}

std::string check_topology(const Meshed& meshed) {
  if (!meshed.field.topology || meshed.given.spacing > 1) return "";
  const Topology& expected = *meshed.field.topology;
  const BoundaryTopology found =
      measure_topology(meshed.boundary, meshed.mesh().header.vertex_count);
  if (found.components == expected.components &&
      found.euler_characteristic == expected.euler_characteristic &&
      found.non_manifold_edges == 0 && found.non_manifold_vertices == 0) {
    return "";
  }
  return absl::StrFormat(
      "the boundary has %d components and Euler characteristic %d, the field %d and %d; %d "
      "edges and %d vertices are no manifold",
      found.components, found.euler_characteristic, expected.components,
      expected.euler_characteristic, found.non_manifold_edges, found.non_manifold_vertices);
}

std::string check_mesh(const Meshed& meshed) {
  const ConformityReport conformity = check_conformity(meshed.mesh());
  if (!conformity.conforming()) return conformity.describe();
  for (const auto& check : {check_angles, check_vertices, check_boundary, check_topology}) {
    if (std::string violation = check(meshed); !violation.empty()) return violation;
  }
  return "";
}

std::string check_graded_against_uniform(const Meshed& graded, const Meshed& uniform) {
  const double expected = uniform.result.quality.volume;
  if (std::abs(graded.result.quality.volume - expected) > 1e-9 * expected) {
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
    const auto again = mesh_volume(pool, volume, request, limits, Cancellation(), nullptr);
    const bool same =
        again.ok() &&
        std::ranges::equal(again->mesh.tets.bytes(), meshed.mesh().tets.bytes()) &&
        std::ranges::equal(again->mesh.positions.bytes(), meshed.mesh().positions.bytes());
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
  return {
      phi, { low(min.x),  low(min.y),  low(min.z)},
       {high(max.x), high(max.y), high(max.z)}
  };
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
  request.coordinates =
      given.seed % 2 == 0 ? CoordinateType::kFloat32 : CoordinateType::kFloat64;
  Outcome outcome;
  const auto mesh = [&](int levels) {
    request.levels = levels;
    return mesh_volume(pool, volume, request, {}, Cancellation(), nullptr);
  };
  absl::StatusOr<MeshResult> uniform = mesh(0), graded = mesh(kMaxLevels);
  if (!uniform.ok() || !graded.ok()) {
    const bool nothing = absl::IsFailedPrecondition(uniform.status()) &&
                         uniform.status() == graded.status() &&
                         absl::StrContains(uniform.status().message(), "to mesh");
    if (!nothing) {
      outcome.violation =
          absl::StrCat(uniform.status().ToString(), "; graded: ", graded.status().ToString());
    }
    return outcome;
  }
  add(outcome, *uniform);
  add(outcome, *graded);
  pool.run([&] {
    const LatticeSigns signs = signs_around(field, given.spacing);
    const auto with_boundary = [&](MeshResult result) {
      Meshed meshed{given, field, signs, std::move(result), {}};
      meshed.boundary = boundary_triangles(meshed.mesh());
      return meshed;
    };
    const Meshed plain = with_boundary(*std::move(uniform));
    const Meshed coarse = with_boundary(*std::move(graded));
    outcome.violation = check_mesh(plain);
    if (outcome.violation.empty()) outcome.violation = check_mesh(coarse);
    if (outcome.violation.empty()) {
      outcome.violation = check_graded_against_uniform(coarse, plain);
    }
    if (outcome.violation.empty() && given.seed % 4 == 0) {
      outcome.violation = check_bytes(coarse, volume, request);
    }
  });
  return outcome;
}

}  // namespace tet::test
