#include "tests/support/graded_promises.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/graded/graded_warp.h"
#include "core/mesh/boundary.h"
#include "core/mesh/quality.h"
#include "core/plan/make/mesher.h"
#include "core/scene/scene_evaluator.h"
#include "core/volume/volume_reader.h"
#include "tests/support/conformity.h"
#include "tests/support/cut_faces.h"
#include "tests/support/random_fields.h"
#include "tests/support/random_sizing.h"
#include "tests/support/scenes.h"

namespace tet::test {
namespace {

/// What is meshed.
struct Input {
  Shape shape;
  MeshRequest request;
  double surface_phi = 0;  ///< how far from zero phi may be on the boundary; 0: anything
};

/// A random scene reaches no further than this.
constexpr double kSceneReach = 4;

Sizing graded_sizing(std::uint32_t seed, const WorldBox& box, double spacing) {
  std::mt19937 random(~seed);
  Sizing sizing = random_sizing(seed, box, spacing);
  sizing.coarsest = spacing * std::exp2(random() % 5);
  sizing.grade_surface = true;
  if (random() % 3 == 0)
    sizing.chord_error = spacing * std::exp2(-static_cast<double>(random() % 5));
  if (random() % 3 == 0) sizing.leaves_across = static_cast<int>(1 + random() % 4);
  return sizing;
}

/// A box that cuts through what fills `around`, in one case of three; of these every other one
/// has finest leaves at its surface.
void add_box(std::uint32_t seed, const WorldBox& around, MeshRequest& request) {
  if (seed % 3 != 1) return;
  std::mt19937 random(seed);
  const auto between = [&](double from, double to) {
    return from + (to - from) * static_cast<double>(random()) / 4294967295.0;
  };
  const auto span = [&](double min, double max) {
    const double middle = (min + max) / 2;
    return std::pair(between(min, middle), between(middle, max));
  };
  const auto [x0, x1] = span(around.min.x, around.max.x);
  const auto [y0, y1] = span(around.min.y, around.max.y);
  const auto [z0, z1] = span(around.min.z, around.max.z);
  request.box = WorldBox{{x0, y0, z0}, {x1, y1, z1}};
  if (seed % 2 == 0) return;
  request.sizing.grade_surface = false;
  request.sizing.chord_error.reset();
  request.sizing.leaves_across = 0;
}

Input field_input(const GradedCase& given) {
  const RandomField field = random_field(given.family, given.seed, given.edge);
  const double edge = given.edge, spacing = given.seed % 4 == 3 ? 0.8 : 1;
  Input input{std::make_shared<const Volume>(field.volume), {}, field.max_surface_phi};
  input.request.spacing = spacing;
  const WorldBox around{{-edge / 2, -edge / 2, -edge / 2}, {edge / 2, edge / 2, edge / 2}};
  input.request.sizing = graded_sizing(given.seed, around, spacing);
  add_box(given.seed, around, input.request);
  return input;
}

absl::StatusOr<Input> scene_input(const GradedCase& given) {
  absl::StatusOr<Scene> scene = make_scene(random_scene(given.seed));
  if (!scene.ok()) return scene.status();
  const double spacing = kSceneReach / given.edge, half = kSceneReach / 2;
  Input input{std::make_shared<const Scene>(*std::move(scene)), {}, 1e-4 * spacing};
  input.request.spacing = spacing;
  const WorldBox around{{-half, -half, -half}, {half, half, half}};
  input.request.sizing = graded_sizing(given.seed, around, spacing);
  add_box(given.seed, around, input.request);
  return input;
}

/// phi at a point of the world, in voxels of 1 or of a scene.
class WorldPhi {
 public:
  explicit WorldPhi(const Shape& shape) {
    if (const Scene* scene = scene_of(shape)) {
      scene_ = std::make_unique<SceneEvaluator>(*scene);
    } else {
      reader_ = std::make_unique<VolumeReader>(*volume_of(shape));
    }
  }
  double operator()(const WorldPoint& p) {
    return scene_ ? scene_->at(p) : reader_->trilinear({p.x, p.y, p.z});
  }

 private:
  std::unique_ptr<SceneEvaluator> scene_;
  std::unique_ptr<VolumeReader> reader_;
};

std::string check_angles(const MeshResult& result, bool cut) {
  const double least = cut ? kLeastCutAngleDeg : kLeastGradedAngleDeg;
  const double greatest = cut ? kGreatestCutAngleDeg : kGreatestGradedAngleDeg;
  const QualityStats measured = measure_quality(result.mesh), &reported = result.quality;
  const bool alike = std::abs(measured.min_dihedral_deg - reported.min_dihedral_deg) < 0.01 &&
                     std::abs(measured.max_dihedral_deg - reported.max_dihedral_deg) < 0.01 &&
                     std::abs(measured.volume - reported.volume) < 1e-5 * measured.volume;
  if (alike && measured.min_dihedral_deg >= least && measured.max_dihedral_deg <= greatest) {
    return "";
  }
  return absl::StrFormat("angles of %.4f to %.4f degrees, reported as %.4f to %.4f",
                         measured.min_dihedral_deg, measured.max_dihedral_deg,
                         reported.min_dihedral_deg, reported.max_dihedral_deg);
}

std::string check_surface(const Input& input, const TetMesh& mesh) {
  if (input.surface_phi == 0) return "";
  WorldPhi phi(input.shape);
  const auto describe = [&](std::uint64_t vertex, const char* what) {
    const WorldPoint p = mesh.vertex(vertex);
    return absl::StrFormat("vertex %d at (%.6f, %.6f, %.6f), phi %g, is %s", vertex, p.x, p.y,
                           p.z, phi(p), what);
  };
  // A vertex in the box's faces may be next to the surface: a cut point violates a node along a
  // far edge, of two leaves, from farthest. Where phi is no distance, that says nothing of it.
  const std::vector<CutFaces> faces = cut_faces(mesh);
  const double beside = scene_of(input.shape) != nullptr
                            ? 2 * kGradedLimits.corner_to_far_corner *
                                  std::ldexp(mesh.header.spacing, mesh.header.levels)
                            : std::numeric_limits<double>::infinity();
  const auto most = [&](std::uint64_t v) {
    return input.surface_phi + (!faces.empty() && faces[v] != 0 ? beside : 0);
  };
  for (std::uint64_t v = 0; v < mesh.header.vertex_count; ++v) {
    if (phi(mesh.vertex(v)) > most(v)) return describe(v, "outside");
  }
  for (const Triangle& triangle : boundary_triangles(mesh)) {
    if (faces_of(faces, triangle) != 0) continue;
    for (const std::uint64_t v : triangle) {
      if (std::abs(phi(mesh.vertex(v))) > most(v)) return describe(v, "off the surface");
    }
  }
  return "";
}

/// That the mesh lies in its box, and what is said to lie in a face lies in one plane with all
/// the rest.
std::string check_cut(const Input& input, const TetMesh& mesh) {
  const std::vector<CutFaces> faces = cut_faces(mesh);
  if (faces.empty() != !input.request.box) return "its vertices do not tell their faces";
  const double unit = 8 * mesh.header.spacing, rounding = 1e-5 * unit;
  for (std::size_t axis = 0; axis < 3 && !faces.empty(); ++axis) {
    const double low = unit * std::floor(coordinate(input.request.box->min, axis) / unit);
    const double high = unit * std::ceil(coordinate(input.request.box->max, axis) / unit);
    for (std::uint64_t v = 0; v < faces.size(); ++v) {
      const double at = coordinate(mesh.vertex(v), axis);
      const bool in_low = (faces[v] >> 2 * axis & 1) != 0,
                 in_high = (faces[v] >> 2 * axis & 2) != 0;
      const bool right = in_low    ? std::abs(at - low) < rounding
                         : in_high ? std::abs(at - high) < rounding
                                   : at > low - rounding && at < high + rounding;
      if (!right) return absl::StrFormat("vertex %d, at %.9g, is beside its box", v, at);
    }
  }
  return "";
}

std::string check_bytes(const Input& input, const TetMesh& mesh) {
  for (const int threads : {1, 3}) {
    TaskPool pool(threads);
    MeshLimits limits;
    limits.chunk_bytes = std::size_t{1} << (threads == 1 ? 30 : 14);
    const auto again =
        mesh_volume(pool, {.shape = input.shape, .request = input.request, .limits = limits});
    if (!again.ok() || !std::ranges::equal(again->mesh.tets.bytes(), mesh.tets.bytes()) ||
        !std::ranges::equal(again->mesh.positions.bytes(), mesh.positions.bytes())) {
      return absl::StrFormat("%d threads make another mesh", threads);
    }
  }
  return "";
}

std::string check_all(const GradedCase& given, const Input& input, const MeshResult& result) {
  const ConformityReport conformity = check_conformity(result.mesh);
  if (!conformity.conforming()) return conformity.describe();
  std::string violation = check_angles(result, input.request.box.has_value());
  if (violation.empty()) violation = check_surface(input, result.mesh);
  if (violation.empty()) violation = check_cut(input, result.mesh);
  if (violation.empty() && *result.boundary != measure_boundary(result.mesh)) {
    violation = "the boundary is another than was reported";
  }
  if (violation.empty() && given.seed % 4 == 0) violation = check_bytes(input, result.mesh);
  return violation;
}

}  // namespace

std::string arguments_of(const GradedCase& given) {
  return absl::StrFormat("--family %s --seed %d --edge %d", given.family, given.seed,
                         given.edge);
}

Outcome check_graded_promises(const GradedCase& given, TaskPool& pool) {
  Outcome outcome;
  absl::StatusOr<Input> input =
      given.family == "scene" ? scene_input(given) : field_input(given);
  if (!input.ok()) return outcome;  // a scene without an end
  input->request.improve = given.seed % 8 == 5;
  input->request.coordinates =
      given.seed % 2 == 0 ? CoordinateType::kFloat32 : CoordinateType::kFloat64;
  const auto result = mesh_volume(pool, {.shape = input->shape, .request = input->request});
  if (!result.ok()) {
    const bool nothing = absl::IsFailedPrecondition(result.status());
    outcome.violation = nothing ? "" : result.status().ToString();
    return outcome;
  }
  outcome.tets = result->mesh.header.tet_count;
  outcome.min_dihedral_deg = result->quality.min_dihedral_deg;
  outcome.max_dihedral_deg = result->quality.max_dihedral_deg;
  pool.run([&] { outcome.violation = check_all(given, *input, *result); });
  return outcome;
}

}  // namespace tet::test
