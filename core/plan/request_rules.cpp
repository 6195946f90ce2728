#include "core/plan/request_rules.h"

#include <algorithm>
#include <utility>

#include <absl/strings/str_format.h>
#include <absl/strings/substitute.h>

namespace tet {
namespace {

using F = Feature;
constexpr Outcome kRefused = Outcome::kRefused, kSentWhole = Outcome::kSentWhole;

// Reasons of several rules: an earlier mesh and a session's last one are compared in one way.
constexpr std::string_view
    kWithoutBricks = "Meshes are compared brick by brick, and this one is made without bricks.",
    kMovesOthers = "A change in one place may move the improved vertices of others.",
    kValuesChange =
        "Values may change at vertices that stay where they are, and nothing compares them.",
    kFacesChange =
        "A tet that stays may get or lose a face on the boundary, and nothing compares them.",
    kNamesChange = "A face that stays may get another name, and nothing compares them.",
    kNoBricksToStuff =
        "The mesh is made as a whole, without bricks that a client could stuff again.";

constexpr std::string_view
    kLabelsHaveNoValues =
        "A label is a name and no number: there is nothing between two of them.",
    kLabelsOnOneLattice =
        "Where labels meet, the rules and their angle bounds are for leaves of one size; "
        "others "
        "are as large as the distance from there lets them be, up to `levels`.";

constexpr RequestRule kRules[] = {
    {F::kStoredGrid, F::kScene, kRefused, "$0 is set beside $1", "mesh one or the other",
     "A scene is meshed instead of a stored grid, and names the grids that it is made of."},
    {F::kGridName, F::kScene, kRefused, "$0 is set, but a scene has no grids",
     "a scene names its grids itself, in its nodes",
     "A scene is no file from which a grid could be chosen."},
    {F::kSeveralGrids, F::kScene, kRefused, "$0 is set, but a scene has no grids",
     "a scene names its grids itself, in its nodes",
     "A scene is one solid and has one mesh; several grids have one mesh each."},
    {F::kIso, F::kScene, kRefused, "$0 is for grids",
     "a scene has its surface at 0, and a node `offset` moves it",
     "The values of a scene are distances, and its grids have an iso value in their nodes."},
    {F::kInside, F::kScene, kRefused, "$0 is for grids",
     "a scene's grids have an `inside` of their own, in their nodes",
     "A scene is inside where its distance is negative."},
    {F::kGridName, F::kSeveralGrids, kRefused, "$0 is set beside $1", "set one of them",
     "Both say which grids of the file are meshed."},
    {F::kIso, F::kLabels, kRefused, "$0 does not go with $1", "leave one of them out",
     kLabelsHaveNoValues},
    {F::kInside, F::kLabels, kRefused, "$0 does not go with $1", "leave one of them out",
     kLabelsHaveNoValues},
    {F::kLabels, F::kBothSides, kRefused, "$0 do not go with $1",
     "have the background of the labels meshed instead",
     "The space around labels is one more of them, the background."},
    {F::kLabels, F::kManifold, kRefused, "$0 do not go with $1", "set one of them",
     "Where three labels meet no surface is a manifold."},
    {F::kLabels, F::kSizingGrid, kRefused, "$0 do not go with $1",
     "leave the sizing out; labels have sizes of their own, and `levels` holds for all",
     kLabelsOnOneLattice},
    {F::kLabels, F::kGradedSurface, kRefused, "$0 do not go with $1",
     "leave the sizing out; labels have sizes of their own, and `levels` holds for all",
     kLabelsOnOneLattice},
    {F::kLabels, F::kSizing, kRefused, "$0 do not go with $1",
     "leave the sizing out; labels have sizes of their own, and `levels` holds for all",
     kLabelsOnOneLattice},
    {F::kFaceRegions, F::kLabels, kRefused, "$0 do not go with $1",
     "leave one of them out; faces are named by the labels on their two sides",
     "Regions are pieces of one surface, and labels have one for each two that meet."},
    {F::kFidelity, F::kLabels, kRefused, "$0 is of one surface, and $1 have many",
     "leave it out; a report tells how much of each label there is",
     "Fidelity is how far a mesh is from where phi is zero, and labels have no phi."},
    {F::kSeveralGrids, F::kBothSides, kRefused,
     "$0 are for the inside alone, as with $1 the outsides of several grids would overlap",
     "mesh one grid, or the inside alone",
     "Each grid is meshed by itself, so the outside of one would fill the inside of the "
     "others."},
    {F::kGradedSurface, F::kBothSides, kRefused,
     "$0 is for the inside alone; $1 meshes both sides", "leave one of them out",
     "The mesher for graded surfaces stuffs one side, and its angle bounds are proven for "
     "that."},
    {F::kGradedSurface, F::kManifold, kRefused, "$0 does not go with $1", "set one of them",
     "Nodes are restored brick by brick, and the mesher for graded surfaces has no bricks."},
    {F::kManifold, F::kCut, kRefused, "$0 does not go with a box that cuts the inside",
     "set one of them",
     "Nodes are restored brick by brick, and a cut is made by the mesher for graded surfaces, "
     "which has no bricks."},
    {F::kCompact, F::kImprove, kRefused, "$0 cannot carry an improved mesh",
     "leave $1 unset, or ask for $2",
     "A compact chunk leaves out what the rules imply, and they do not imply where an improved "
     "vertex lies."},
    {F::kCompact, F::kGradedSurface, kRefused, "$0 cannot carry a mesh with a graded surface",
     "leave $1 unset, or ask for $2", kNoBricksToStuff},
    {F::kCompact, F::kCut, kRefused, "$0 cannot carry a mesh that a box cuts",
     "leave $1 unset, or ask for $2", kNoBricksToStuff},
    {F::kCompact, F::kFields, kRefused, "$0 cannot carry $1, whose grids only the server has",
     "ask for $2",
     "The server would have to make every vertex to know where to sample, and compact chunks "
     "exist to spare it that."},
    {F::kCompact, F::kSeveralGrids, kRefused, "$0 is for one grid",
     "ask for $2, or name one grid",
     "A header has one lattice, and each grid may lie on another."},
    {F::kCompact, F::kLabels, kRefused, "$0 cannot carry $1", "ask for $2",
     "A compact chunk has two sides and no numbers of labels."},
    {F::kEarlierMesh, F::kScene, kRefused, "$0 is for grids",
     "a scene's mesh is sent whole; a session keeps parts of it",
     "An earlier mesh is named by its stored grid, and scenes are not stored."},
    {F::kEarlierMesh, F::kSeveralGrids, kRefused, "$0 is for one grid",
     "the meshes of several are sent whole",
     "Meshes are compared brick by brick, and the bricks of several grids lie on several "
     "lattices."},
    {F::kSeveralGrids, F::kSession, kRefused, "$0 is set, but $1 follows one grid",
     "set grid_name", "The leaves of a frame do not say which grid they are of."},
    {F::kLabels, F::kSession, kRefused, "$0 do not go with $1",
     "stream the mesh of each segmentation",
     "A frame has values of leaves, and a segmentation has none."},
    {F::kSeveralGrids, F::kPoints, kRefused,
     "$0 is set, but several grids have no phi in common", "set grid_name",
     "A sample has one phi, and each grid has its own."},
    {F::kLabels, F::kPoints, kRefused, "$0 have no phi", "sample a grid of distances",
     "phi tells two sides apart, and a segmentation has any number."},
    {F::kEarlierMesh, F::kLabels, kSentWhole, "", "",
     "Labels are not compared with those of an earlier segmentation."},
    {F::kEarlierMesh, F::kCut, kSentWhole, "", "", kWithoutBricks},
    {F::kEarlierMesh, F::kGradedSurface, kSentWhole, "", "", kWithoutBricks},
    {F::kEarlierMesh, F::kImprove, kSentWhole, "", "", kMovesOthers},
    {F::kEarlierMesh, F::kFields, kSentWhole, "", "", kValuesChange},
    {F::kEarlierMesh, F::kFaces, kSentWhole, "", "", kFacesChange},
    {F::kEarlierMesh, F::kFaceRegions, kSentWhole, "", "", kNamesChange},
    {F::kEarlierMesh, F::kFidelity, kSentWhole, "", "", kFacesChange},
    {F::kSession, F::kCut, kSentWhole, "", "", kWithoutBricks},
    {F::kSession, F::kGradedSurface, kSentWhole, "", "", kWithoutBricks},
    {F::kSession, F::kImprove, kSentWhole, "", "", kMovesOthers},
    {F::kSession, F::kFields, kSentWhole, "", "", kValuesChange},
    {F::kSession, F::kFaces, kSentWhole, "", "", kFacesChange},
    {F::kSession, F::kFaceRegions, kSentWhole, "", "", kNamesChange},
    {F::kFidelity, F::kSession, kRefused, "$0 does not go with $1",
     "stream the mesh of the frame that is to be measured",
     "Measuring takes longer than the next frame is away."},
    {F::kFidelity, F::kJob, kRefused, "$0 does not go with $1",
     "stream the mesh, or hold the result against its grid with `--report`",
     "A result is made by many workers, chunk by chunk, and none of them has its surface."},
    {F::kSkipStatistics, F::kJob, Outcome::kIgnored, "", "",
     "A result is stored once for all readers, and some may want its statistics."},
};

bool is_of_a_stream(Feature feature) {
  return feature >= F::kChunkRange && feature <= F::kEarlierMesh;
}

bool is_of_another_call(Feature feature) {
  return feature == F::kSession || feature == F::kJob || feature == F::kPoints;
}

bool are_one_choice(Feature a, Feature b) {
  if (is_of_another_call(a)) return is_of_a_stream(b) || is_of_another_call(b);
  return (a == F::kPacked && b == F::kCompact) || (a == F::kBothSides && b == F::kCut) ||
         (a == F::kLabels && b == F::kCut);
}

}  // namespace

std::span<const RequestRule> request_rules() { return kRules; }

const RequestRule* find_rule(Feature a, Feature b) {
  const auto* rule = std::ranges::find_if(kRules, [&](const RequestRule& candidate) {
    return (candidate.feature == a && candidate.beside == b) ||
           (candidate.feature == b && candidate.beside == a);
  });
  return rule == std::end(kRules) ? nullptr : rule;
}

bool can_be_asked_together(Feature a, Feature b) {
  return a != b && !are_one_choice(a, b) && !are_one_choice(b, a);
}

FeatureNames field_names() {
  return FeatureNames({"name",
                       "grid_name",
                       "grid_names",
                       "scene",
                       "iso",
                       "inside",
                       "labels",
                       "preset both-sides",
                       "box",
                       "manifold",
                       "sizing",
                       "sizing.grid",
                       "sizing.grade_surface",
                       "improve",
                       "fields",
                       "faces",
                       "face_regions",
                       "fidelity",
                       "coordinate_type COORDINATE_TYPE_FLOAT64",
                       "skip_statistics",
                       "start_chunk",
                       "ENCODING_PACKED",
                       "encoding ENCODING_COMPACT",
                       "base_name",
                       "a session",
                       "a job",
                       "points"});
}

FeatureNames field_names(const MeshRequest& request) {
  FeatureNames names = field_names();
  if (request.iso) names.set(F::kIso, absl::StrFormat("iso %g", *request.iso));
  return names;
}

Features features_of(const MeshRequest& request) {
  const Sizing& sizing = request.sizing;
  return Features()
      .add(F::kIso, request.iso.has_value())
      .add(F::kInside, request.inside.has_value())
      .add(F::kLabels, request.labels.has_value())
      .add(F::kBothSides, stuffing_rules(request.preset).both_sides)
      .add(F::kCut, has_cut(request))
      .add(F::kManifold, request.manifold)
      .add(F::kSizing, sizing.any())
      .add(F::kSizingGrid, sizing.grid.has_value())
      .add(F::kGradedSurface, sizing.grade_surface)
      .add(F::kImprove, request.improve)
      .add(F::kFields, !request.fields.empty())
      .add(F::kFaces, request.faces)
      .add(F::kFaceRegions, !request.face_regions.empty())
      .add(F::kFidelity, request.fidelity)
      .add(F::kFloat64, request.coordinates == CoordinateType::kFloat64)
      .add(F::kSkipStatistics, request.skip_statistics);
}

Features features_of(const Shape& shape) {
  if (scene_of(shape) != nullptr) return {F::kScene};
  if (grids_of(shape) != nullptr) return {F::kStoredGrid, F::kSeveralGrids};
  return {F::kStoredGrid};
}

std::string message_of(const RequestRule& rule, const FeatureNames& names) {
  const std::string template_text = absl::StrFormat("%s: %s", rule.refusal, rule.instead);
  return absl::Substitute(template_text, names.of(rule.feature), names.of(rule.beside),
                          names.of(F::kPacked));
}

absl::Status check_features(Features features, const FeatureNames& names) {
  for (const RequestRule& rule : kRules) {
    if (rule.outcome != kRefused || !features.has(rule.feature) || !features.has(rule.beside)) {
      continue;
    }
    return absl::InvalidArgumentError(message_of(rule, names));
  }
  return absl::OkStatus();
}

bool may_keep_parts(Features features) {
  return std::ranges::none_of(kRules, [&](const RequestRule& rule) {
    return rule.outcome == kSentWhole && features.has(rule.feature) &&
           features.has(rule.beside);
  });
}

}  // namespace tet
