// A request that asks for any two features, for tests of what excludes what.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/plan/request_rules.h"
#include "tetstream/v1/meshes.pb.h"

namespace tet::test {

namespace v1 = ::tetstream::v1;

/// For a stored file with the grids of the fixture `parts`, and a stored segmentation.
class FeatureRequest {
 public:
  FeatureRequest(std::string stored_file, std::string stored_labels)
      : file_(std::move(stored_file)), labels_(std::move(stored_labels)) {}
  explicit FeatureRequest(const std::string& stored_file)
      : FeatureRequest(stored_file, stored_file) {}

  v1::StreamMeshRequest with(Feature a, Feature b) const {
    v1::StreamMeshRequest stream;
    add(a, stream);
    add(b, stream);
    const bool is_scene = stream.mesh().has_scene();
    v1::MeshRequest& mesh = *stream.mutable_mesh();
    if (!is_scene)
      mesh.set_name(mesh.has_labels() && mesh.grid_names().empty() ? labels_ : file_);
    if (mesh.has_labels() && !is_scene && mesh.grid_names().empty()) {
      if (!stream.base_name().empty()) stream.set_base_name(labels_);
      mesh.clear_grid_name();  // an image's only array
      return stream;
    }
    if (!is_scene && mesh.grid_names().empty()) mesh.set_grid_name("ball");
    return stream;
  }

 private:
  void add(Feature feature, v1::StreamMeshRequest& stream) const {
    v1::MeshRequest& mesh = *stream.mutable_mesh();
    switch (feature) {
      case Feature::kStoredGrid:
        return mesh.set_name(file_);
      case Feature::kGridName:
        return mesh.set_grid_name("ball");
      case Feature::kSeveralGrids:
        return mesh.mutable_grid_names()->Assign(kSeveral.begin(), kSeveral.end());
      case Feature::kScene:
        mesh.set_spacing(0.1);
        return mesh.mutable_scene()->add_nodes()->mutable_sphere()->set_radius(1);
      case Feature::kIso:
        return mesh.set_iso(0.125);
      case Feature::kInside:
        return mesh.set_inside(v1::INSIDE_BELOW);
      case Feature::kLabels:
        return mesh.mutable_labels()->add_only()->set_last(1);
      case Feature::kBothSides:
        return mesh.set_preset(v1::PRESET_BOTH_SIDES);
      case Feature::kCut:
        return add_cut(*mesh.mutable_box());
      case Feature::kManifold:
        return mesh.set_manifold(true);
      case Feature::kSizing:
        return mesh.mutable_sizing()->set_growth(0.5);
      case Feature::kSizingGrid:
        mesh.mutable_sizing()->mutable_grid()->set_name(file_);
        return mesh.mutable_sizing()->mutable_grid()->set_grid_name("ball");
      case Feature::kGradedSurface:
        mesh.mutable_sizing()->set_coarsest(0.4);
        return mesh.mutable_sizing()->set_grade_surface(true);
      case Feature::kImprove:
        return mesh.set_improve(true);
      case Feature::kFields:
        return add_field(*mesh.add_fields());
      case Feature::kFaces:
        return mesh.set_faces(true);
      case Feature::kFaceRegions:
        return add_region(*mesh.add_face_regions());
      case Feature::kFidelity:
        return mesh.set_fidelity(true);
      case Feature::kFloat64:
        return mesh.set_coordinate_type(v1::COORDINATE_TYPE_FLOAT64);
      case Feature::kSkipStatistics:
        return mesh.set_skip_statistics(true);
      case Feature::kChunkRange:
        return stream.set_end_chunk(1);
      case Feature::kPacked:
        return stream.set_encoding(v1::ENCODING_PACKED);
      case Feature::kCompact:
        return stream.set_encoding(v1::ENCODING_COMPACT);
      case Feature::kEarlierMesh:
        stream.set_base_name(file_);
        return stream.set_base_mesh_id("another");
      case Feature::kSession:
      case Feature::kJob:
      case Feature::kPoints:
        return;  // which are other calls
    }
  }

  /// A part of the ball, and a part of the ring.
  static void add_cut(v1::Box& box) {
    for (v1::Point* const corner : {box.mutable_min(), box.mutable_max()}) {
      const double at = corner == &box.min() ? -6 : 6;
      corner->set_x(at);
      corner->set_y(at);
      corner->set_z(at);
    }
    box.mutable_max()->set_y(0.3);
  }

  static void add_region(v1::FaceRegion& region) {
    region.set_name("half");
    region.mutable_half_space()->mutable_normal()->Add(1);
    region.mutable_half_space()->mutable_normal()->Add(0);
    region.mutable_half_space()->mutable_normal()->Add(0);
  }

  void add_field(v1::Field& field) const {
    field.set_grid(file_);
    field.set_grid_name("velocity");
  }

  static inline const std::vector<std::string> kSeveral{"ball", "ring"};

  std::string file_, labels_;
};

}  // namespace tet::test
