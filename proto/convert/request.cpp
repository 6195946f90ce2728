#include "proto/convert/request.h"

#include <cmath>
#include <set>
#include <utility>
#include <variant>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/volume/inside.h"
#include "core/volume/label_volume.h"
#include "proto/convert/box_request.h"
#include "proto/convert/face_regions.h"
#include "proto/convert/field_request.h"
#include "proto/convert/grid_names_request.h"
#include "proto/convert/labels_request.h"
#include "proto/convert/mesh_header.h"
#include "proto/convert/points.h"
#include "proto/convert/request_rules.h"
#include "proto/convert/scene_request.h"
#include "proto/convert/sizing_request.h"
#include "proto/convert/status.h"
#include "proto/sizing/sizing_message.h"
#include "proto/wire/sha256.h"

namespace tet {

namespace {

absl::StatusOr<Preset> parse_preset_field(v1::Preset preset) {
  switch (preset) {
    case v1::PRESET_UNSPECIFIED:
    case v1::PRESET_DEFAULT:
      return Preset::kDefault;
    case v1::PRESET_MIN_ANGLE:
      return Preset::kMinAngle;
    case v1::PRESET_BOTH_SIDES:
      return Preset::kBothSides;
    default:
      return invalid_field(absl::StrCat("preset ", static_cast<int>(preset), " is unknown"));
  }
}

absl::StatusOr<std::optional<CoordinateType>> parse_coordinates(v1::CoordinateType type) {
  switch (type) {
    case v1::COORDINATE_TYPE_UNSPECIFIED:
      return std::nullopt;
    case v1::COORDINATE_TYPE_FLOAT32:
      return CoordinateType::kFloat32;
    case v1::COORDINATE_TYPE_FLOAT64:
      return CoordinateType::kFloat64;
    default:
      return invalid_field(
          absl::StrCat("coordinate_type ", static_cast<int>(type), " is unknown"));
  }
}

absl::StatusOr<std::optional<InsideSide>> parse_inside(v1::Inside inside) {
  switch (inside) {
    case v1::INSIDE_UNSPECIFIED:
      return std::nullopt;
    case v1::INSIDE_BELOW:
      return InsideSide::kBelow;
    case v1::INSIDE_ABOVE:
      return InsideSide::kAbove;
    default:
      return invalid_field(absl::StrCat("inside ", static_cast<int>(inside), " is unknown"));
  }
}

v1::Inside to_proto(InsideSide side) {
  return side == InsideSide::kAbove ? v1::INSIDE_ABOVE : v1::INSIDE_BELOW;
}

absl::Status check_numbers(const v1::MeshRequest& request) {
  if (request.has_spacing() && !(request.spacing() > 0 && std::isfinite(request.spacing()))) {
    return invalid_field(
        absl::StrCat("spacing ", request.spacing(), " is not positive and finite"));
  }
  if (request.has_iso() && !std::isfinite(request.iso())) {
    return invalid_field(absl::StrCat("iso ", request.iso(), " is not finite"));
  }
  if (request.has_levels() && (request.levels() < 0 || request.levels() > kMaxLevels)) {
    return invalid_field(
        absl::StrCat("levels ", request.levels(), " is not from 0 to ", kMaxLevels));
  }
  return absl::OkStatus();
}

/// Empty where the inside is below, as in every mesh before there was a choice, and where each
/// of several grids says it.
std::string exact_inside(const v1::MeshRequest& canonical) {
  if (!canonical.grid_names().empty()) {
    return canonical.inside() == v1::INSIDE_UNSPECIFIED
               ? ""
               : absl::StrCat(" inside ", static_cast<int>(canonical.inside()));
  }
  return canonical.inside() == v1::INSIDE_ABOVE ? " above" : "";
}

absl::Status parse_input(const v1::MeshRequest& request, MeshOrder& order) {
  if (request.has_scene()) return parse_scene(request, order);
  absl::StatusOr<std::string> digest = parse_grid_name(request.name());
  if (!digest.ok()) return digest.status();
  order.digest = *std::move(digest);
  order.grid_name = request.grid_name();
  return absl::OkStatus();
}

/// Regions ask for the faces that they are pieces of, and fidelity for those that it measures.
absl::Status parse_faces(const v1::MeshRequest& request, MeshRequest& out) {
  auto regions = face_regions_of(request.face_regions());
  if (!regions.ok()) return invalid_field(std::string(regions.status().message()));
  out.fidelity = request.fidelity();
  out.faces = request.faces() || out.fidelity || !regions->empty();
  out.face_regions = *std::move(regions);
  return absl::OkStatus();
}

/// A client that makes the tets itself has no scene to ask which node made a face, and all
/// chunks have to be there before patches are.
absl::Status check_compact_faces(const v1::StreamMeshRequest& request) {
  if (request.encoding() != v1::ENCODING_COMPACT) return absl::OkStatus();
  for (int i = 0; i < request.mesh().face_regions_size(); ++i) {
    const v1::FaceRegion& region = request.mesh().face_regions(i);
    if (region.node().empty() && !region.has_creases()) continue;
    return invalid_field(absl::StrFormat(
        "encoding ENCODING_COMPACT cannot carry face_regions[%d].%s: ask for ENCODING_PACKED",
        i,
        region.has_creases() ? "creases, as labels of faces come of all chunks together"
                             : "node, as only the server knows which node made a face"));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::string> parse_grid_name(const std::string& name) {
  const std::string_view digest = digest_of_name(name);
  if (!digest.empty()) return std::string(digest);
  return invalid_field(absl::StrCat("name \"", name.substr(0, 100),
                                    "\" is not grids/ and 64 lower-case hexadecimal digits"));
}

absl::StatusOr<MeshOrder> parse_mesh_request(const v1::MeshRequest& request) {
  if (auto status = check_rules(request); !status.ok()) return status;
  MeshOrder order;
  if (const auto status = parse_input(request, order); !status.ok()) return status;
  if (const auto status = check_numbers(request); !status.ok()) return status;
  const auto preset = parse_preset_field(request.preset());
  if (!preset.ok()) return preset.status();
  const auto inside = parse_inside(request.inside());
  if (!inside.ok()) return inside.status();
  const auto box = parse_box(request);
  if (!box.ok()) return box.status();
  const auto origin = parse_origin(request);
  if (!origin.ok()) return origin.status();
  const auto coordinates = parse_coordinates(request.coordinate_type());
  if (!coordinates.ok()) return coordinates.status();
  if (const auto status = parse_fields(request, order.request); !status.ok()) return status;
  if (request.has_spacing()) order.request.spacing = request.spacing();
  if (request.has_iso()) order.request.iso = request.iso();
  order.request.inside = *inside;
  order.request.preset = *preset;
  order.request.box = *box;
  order.request.origin = *origin;
  order.request.manifold = request.manifold();
  order.request.coordinates = *coordinates;
  order.request.improve = request.improve();
  if (const auto status = parse_faces(request, order.request); !status.ok()) return status;
  order.request.skip_statistics = request.skip_statistics();
  if (const auto status = parse_labels(request, order.request); !status.ok()) return status;
  if (const auto status = parse_sizing(request, order.request); !status.ok()) return status;
  order.request.levels =
      request.has_levels() ? request.levels() : default_levels(order.request);
  if (const auto status = parse_grid_names(request, order); !status.ok()) return status;
  if (!order.is_scene() || order.scene.has_grids()) return order;
  const auto made = scene_of_order(order);
  if (!made.ok()) return made.status();
  order.made_scene = *made;
  return order;
}

void to_proto(const MeshRequest& request, v1::MeshRequest& message) {
  if (request.spacing) message.set_spacing(*request.spacing);
  if (request.iso) message.set_iso(*request.iso);
  if (request.inside) message.set_inside(to_proto(*request.inside));
  message.set_levels(request.levels);
  message.set_preset(to_proto(request.preset));
  if (request.coordinates) message.set_coordinate_type(to_proto(*request.coordinates));
  if (request.box) to_proto(*request.box, *message.mutable_box());
  if (request.origin) to_proto(*request.origin, *message.mutable_origin());
  message.set_manifold(request.manifold);
  message.set_improve(request.improve);
  message.set_faces(request.faces);
  message.set_fidelity(request.fidelity);
  to_proto(request.face_regions, message);
  message.set_skip_statistics(request.skip_statistics);
  if (request.labels) *message.mutable_labels() = message_of_labels(*request.labels);
  if (request.sizing.any()) *message.mutable_sizing() = message_of_sizing(request.sizing);
  to_proto(request.fields, message);
}

absl::StatusOr<StreamOrder> parse_stream_request(const v1::StreamMeshRequest& request) {
  auto mesh = parse_mesh_request(request.mesh());
  if (!mesh.ok()) return within_field("mesh", mesh.status());
  if (request.start_chunk() < 0) {
    return invalid_field(absl::StrCat("start_chunk ", request.start_chunk(), " is negative"));
  }
  if (request.end_chunk() != 0 && request.end_chunk() < request.start_chunk()) {
    return invalid_field(absl::StrCat("end_chunk ", request.end_chunk(),
                                      " is below start_chunk ", request.start_chunk()));
  }
  if (!v1::Encoding_IsValid(request.encoding())) {
    return invalid_field(absl::StrCat("encoding ", static_cast<int>(request.encoding()),
                                      " is unknown: see Capabilities.encodings"));
  }
  if (auto status = check_rules(request); !status.ok()) return status;
  if (auto status = check_compact_faces(request); !status.ok()) return status;
  StreamOrder order{*std::move(mesh),
                    static_cast<std::uint64_t>(request.start_chunk()),
                    static_cast<std::uint64_t>(request.end_chunk()),
                    request.expected_mesh_id(),
                    request.encoding(),
                    {},
                    {}};
  order.shared_memory = request.shared_memory();
  order.shared_memory_events = request.shared_memory_events();
  if (request.base_mesh_id().empty() != request.base_name().empty()) {
    return invalid_field("base_mesh_id and base_name go together: set both or neither");
  }
  if (request.base_name().empty()) {
    const bool encoded =
        request.encoding() == v1::ENCODING_PACKED || request.encoding() == v1::ENCODING_COMPACT;
    // What a job has stored was never measured.
    const bool measured = request.mesh().fidelity();
    if (!encoded && !measured && !request.skip_cache())
      order.stored_name = name_of_request(request.mesh());
    return order;
  }
  absl::StatusOr<std::string> base = parse_grid_name(request.base_name());
  if (!base.ok()) return base.status();
  // Planning an earlier mesh of which nothing can be kept would be wasted.
  if (!may_keep_parts(features_of(request))) return order;
  order.base_mesh_id = request.base_mesh_id();
  order.base_digest = *std::move(base);
  return order;
}

std::vector<std::string> files_of(const MeshOrder& order) {
  std::set<std::string> digests;
  if (!order.digest.empty()) digests.insert(order.digest);
  const auto add = [&](const std::string& name) { digests.emplace(digest_of_name(name)); };
  const auto& sizes = order.request.sizing.grid;
  if (sizes && !sizes->file.empty()) add(sizes->file);
  for (const VertexField& field : order.request.fields) {
    if (!field.file.empty()) add(field.file);
  }
  for (const scene::Node& node : order.scene.nodes) {
    if (const auto* grid = std::get_if<scene::GridSolid>(&node.kind)) add(grid->file);
  }
  return {digests.begin(), digests.end()};
}

v1::MeshRequest canonical_request(const MeshOrder& order,
                                  const Shape& shape,
                                  const MeshHeader* header) {
  v1::MeshRequest canonical;
  if (const GridList* grids = grids_of(shape)) {
    set_canonical_grids(order, *grids, canonical);
  } else if (const Volume* volume = volume_of(shape)) {
    canonical.set_name(name_of_grid(order.digest));
    canonical.set_grid_name(volume->name);
    canonical.set_iso(order.request.iso.value_or(default_iso(shape, order.request)));
    canonical.set_inside(to_proto(inside_side(*volume, order.request.inside)));
  } else if (const auto labels = labels_of(shape)) {
    canonical.set_name(name_of_grid(order.digest));
    canonical.set_grid_name(labels->name);
  } else {
    set_canonical_scene(order, canonical);
  }
  if (order.request.labels) {
    *canonical.mutable_labels() = message_of_labels(*order.request.labels);
  }
  if (grids_of(shape) == nullptr) {
    canonical.set_spacing(order.request.spacing.value_or(default_spacing(shape)));
  }
  canonical.set_levels(order.request.levels);
  canonical.set_preset(to_proto(order.request.preset));
  if (order.request.box) to_proto(*order.request.box, *canonical.mutable_box());
  if (order.request.origin) to_proto(*order.request.origin, *canonical.mutable_origin());
  set_canonical_sizing(order.request.sizing, canonical);
  set_canonical_fields(order.request.fields, canonical);
  canonical.set_manifold(order.request.manifold);
  canonical.set_improve(order.request.improve);
  canonical.set_faces(order.request.faces);
  canonical.set_fidelity(order.request.fidelity);
  to_proto(order.request.face_regions, canonical);
  canonical.set_skip_statistics(order.request.skip_statistics);
  const auto coordinates =
      header != nullptr ? std::optional(header->coordinate_type) : order.request.coordinates;
  if (coordinates) canonical.set_coordinate_type(to_proto(*coordinates));
  return canonical;
}

std::string name_of_request(v1::MeshRequest request) {
  request.clear_skip_statistics();
  Sha256 digest;
  digest.add(kAlgorithmVersion);
  digest.add("\n");
  digest.add(request.SerializeAsString());
  return digest.finish_hex();
}

std::string mesh_id_of(const v1::MeshRequest& canonical) {
  // Hexadecimal floats say every bit. The grid's name comes last: it may hold anything.
  Sha256 digest;
  digest.add(absl::StrFormat(
      "tetstream mesh %s\n%s\n%a %a %d %d %d %d %d\n%s\n%s", kAlgorithmVersion,
      canonical.name(), canonical.spacing(), canonical.iso(), canonical.levels(),
      static_cast<int>(canonical.preset()), static_cast<int>(canonical.coordinate_type()),
      static_cast<int>(canonical.manifold()), static_cast<int>(canonical.improve()),
      absl::StrCat(exact_box(canonical), exact_sizing(canonical), exact_origin(canonical),
                   exact_fields(canonical), exact_grids(canonical), exact_inside(canonical),
                   exact_labels(canonical), canonical.faces() ? " faces" : "",
                   exact_face_regions(canonical)),
      canonical.grid_name()));
  if (canonical.has_scene()) digest.add(canonical.scene().SerializeAsString());
  return digest.finish_hex();
}

}  // namespace tet
