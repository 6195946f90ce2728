#include "proto/convert/request.h"

#include <cmath>
#include <set>
#include <utility>
#include <variant>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "proto/convert/box_request.h"
#include "proto/convert/field_request.h"
#include "proto/convert/grid_names_request.h"
#include "proto/convert/scene_request.h"
#include "proto/convert/sizing_request.h"
#include "proto/convert/status.h"
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

absl::Status parse_input(const v1::MeshRequest& request, MeshOrder& order) {
  if (request.has_scene()) return parse_scene(request, order);
  absl::StatusOr<std::string> digest = parse_grid_name(request.name());
  if (!digest.ok()) return digest.status();
  order.digest = *std::move(digest);
  order.grid_name = request.grid_name();
  return absl::OkStatus();
}

std::int64_t signed_count(std::uint64_t count) { return static_cast<std::int64_t>(count); }

}  // namespace

absl::StatusOr<std::string> parse_grid_name(const std::string& name) {
  const std::string_view digest = digest_of_name(name);
  if (!digest.empty()) return std::string(digest);
  return invalid_field(absl::StrCat("name \"", name.substr(0, 100),
                                    "\" is not grids/ and 64 lower-case hexadecimal digits"));
}

absl::StatusOr<MeshOrder> parse_mesh_request(const v1::MeshRequest& request) {
  MeshOrder order;
  if (const auto status = parse_input(request, order); !status.ok()) return status;
  if (const auto status = check_numbers(request); !status.ok()) return status;
  const auto preset = parse_preset_field(request.preset());
  if (!preset.ok()) return preset.status();
  const auto box = parse_box(request);
  if (!box.ok()) return box.status();
  const auto origin = parse_origin(request);
  if (!origin.ok()) return origin.status();
  const auto coordinates = parse_coordinates(request.coordinate_type());
  if (!coordinates.ok()) return coordinates.status();
  if (const auto status = parse_fields(request, order.request); !status.ok()) return status;
  if (request.has_spacing()) order.request.spacing = request.spacing();
  if (request.has_iso()) order.request.iso = request.iso();
  if (request.has_levels()) order.request.levels = request.levels();
  order.request.preset = *preset;
  order.request.box = *box;
  order.request.origin = *origin;
  order.request.manifold = request.manifold();
  order.request.coordinates = *coordinates;
  order.request.improve = request.improve();
  order.request.skip_statistics = request.skip_statistics();
  if (const auto status = parse_sizing(request, order.request); !status.ok()) return status;
  if (const auto status = check_cut(order.request); !status.ok()) {
    return invalid_field(std::string(status.message()));
  }
  if (const auto status = parse_grid_names(request, order); !status.ok()) return status;
  if (!order.is_scene() || order.scene.has_grids()) return order;
  const auto made = scene_of_order(order);
  if (!made.ok()) return made.status();
  order.made_scene = *made;
  return order;
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
  if (auto status = check_stream_of_grids(request); !status.ok()) return status;
  const bool compact = request.encoding() == v1::ENCODING_COMPACT;
  if (compact && mesh->request.improve) {
    return invalid_field(
        "encoding ENCODING_COMPACT cannot carry an improved mesh: leave improve unset, or ask "
        "for ENCODING_PACKED");
  }
  if (compact && mesh->request.sizing.grade_surface) {
    return invalid_field(
        "encoding ENCODING_COMPACT cannot carry a mesh with a graded surface: leave "
        "sizing.grade_surface unset, or ask for ENCODING_PACKED");
  }
  if (compact && has_cut(mesh->request)) {
    return invalid_field(
        "encoding ENCODING_COMPACT cannot carry a mesh that a box cuts: leave box unset, or "
        "ask for ENCODING_PACKED");
  }
  if (compact && !mesh->request.fields.empty()) {
    return invalid_field(
        "encoding ENCODING_COMPACT cannot carry fields, whose grids only the server has: ask "
        "for ENCODING_PACKED");
  }
  StreamOrder order{*std::move(mesh),
                    static_cast<std::uint64_t>(request.start_chunk()),
                    static_cast<std::uint64_t>(request.end_chunk()),
                    request.expected_mesh_id(),
                    request.encoding(),
                    {},
                    {}};
  if (request.base_mesh_id().empty() != request.base_name().empty()) {
    return invalid_field("base_mesh_id and base_name go together: set both or neither");
  }
  const bool plain = !compact && request.encoding() != v1::ENCODING_PACKED;
  const bool stored = plain && !request.skip_cache();
  if (request.base_name().empty()) {
    if (stored) order.stored_name = name_of_request(request.mesh());
    return order;
  }
  if (order.mesh.is_scene()) {
    return invalid_field("base_name is for grids: a scene's mesh is sent whole");
  }
  if (compact) {
    return invalid_field(
        "base_name does not go with ENCODING_COMPACT, which carries whole meshes: leave it "
        "unset, "
        "or ask for ENCODING_PACKED");
  }
  absl::StatusOr<std::string> base = parse_grid_name(request.base_name());
  if (!base.ok()) return base.status();
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
    canonical.set_iso(order.request.iso.value_or(default_iso(shape)));
  } else {
    set_canonical_scene(order, canonical);
  }
  if (grids_of(shape) == nullptr) {
    canonical.set_spacing(order.request.spacing.value_or(default_spacing(shape)));
  }
  canonical.set_levels(order.request.levels);
  canonical.set_preset(to_proto(order.request.preset));
  if (order.request.box) set_box(*order.request.box, *canonical.mutable_box());
  if (order.request.origin) set_point(*order.request.origin, *canonical.mutable_origin());
  set_canonical_sizing(order.request.sizing, canonical);
  set_canonical_fields(order.request.fields, canonical);
  canonical.set_manifold(order.request.manifold);
  canonical.set_improve(order.request.improve);
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
                   exact_fields(canonical), exact_grids(canonical)),
      canonical.grid_name()));
  if (canonical.has_scene()) digest.add(canonical.scene().SerializeAsString());
  return digest.finish_hex();
}

v1::CoordinateType to_proto(CoordinateType type) {
  return type == CoordinateType::kFloat32 ? v1::COORDINATE_TYPE_FLOAT32
                                          : v1::COORDINATE_TYPE_FLOAT64;
}

v1::IndexType to_proto(IndexType type) {
  return type == IndexType::kUint32 ? v1::INDEX_TYPE_UINT32 : v1::INDEX_TYPE_UINT64;
}

v1::Preset to_proto(Preset preset) {
  switch (preset) {
    case Preset::kDefault:
      return v1::PRESET_DEFAULT;
    case Preset::kMinAngle:
      return v1::PRESET_MIN_ANGLE;
    case Preset::kBothSides:
      return v1::PRESET_BOTH_SIDES;
  }
  return v1::PRESET_UNSPECIFIED;
}

void to_proto(const GridInfo& info, v1::GridInfo& message) {
  message.set_name(info.name);
  message.set_value_type(info.value_type);
  message.set_grid_class(info.grid_class);
  message.set_voxel_size(info.voxel_size);
  message.set_active_voxel_count(info.active_voxels);
  message.set_background(info.background);
  message.set_not_meshable_reason(info.not_meshable);
  message.set_field_components(static_cast<std::int32_t>(info.field_components));
  if (info.active_box.empty()) return;
  v1::VoxelBox& box = *message.mutable_active_box();
  box.set_min_x(info.active_box.min.x);
  box.set_min_y(info.active_box.min.y);
  box.set_min_z(info.active_box.min.z);
  box.set_max_x(info.active_box.max.x);
  box.set_max_y(info.active_box.max.y);
  box.set_max_z(info.active_box.max.z);
}

void to_proto(const MeshPart& part, v1::MeshPart& message) {
  message.set_name(part.name);
  message.set_first_vertex(signed_count(part.first_vertex));
  message.set_vertex_count(signed_count(part.vertex_count));
  message.set_first_tet(signed_count(part.first_tet));
  message.set_tet_count(signed_count(part.tet_count));
  message.set_spacing(part.spacing);
  message.set_levels(part.levels);
}

void to_proto(const MeshHeader& header, v1::MeshHeader& message) {
  message.set_vertex_count(signed_count(header.vertex_count));
  message.set_tet_count(signed_count(header.tet_count));
  message.set_chunk_count(signed_count(header.chunk_count));
  message.set_coordinate_type(to_proto(header.coordinate_type));
  message.set_index_type(to_proto(header.index_type));
  set_point(header.origin, *message.mutable_origin());
  set_box(header.bounds, *message.mutable_bounds());
  message.set_spacing(header.spacing);
  message.set_levels(header.levels);
  message.set_has_regions(header.has_regions);
  for (const FieldArray& field : header.fields) {
    v1::FieldArray& array = *message.add_fields();
    array.set_name(field.name);
    array.set_components(static_cast<std::int32_t>(field.components));
  }
  for (const MeshPart& part : header.parts) to_proto(part, *message.add_parts());
  message.set_mesh_bytes(
      signed_count(ChunkSizes(header, header.vertex_count, header.tet_count).total()));
}

void to_proto(const KeptParts& kept, v1::KeptParts& message) {
  const auto add_all = [](const std::vector<KeptRun>& runs, auto& list) {
    for (const KeptRun& run : runs) {
      v1::KeptRun& added = *list.Add();
      added.set_from(signed_count(run.from));
      added.set_to(signed_count(run.to));
      added.set_count(signed_count(run.count));
    }
  };
  add_all(kept.vertices, *message.mutable_vertices());
  add_all(kept.tets, *message.mutable_tets());
}

void to_proto(const LatticeToWorld& to_world, v1::Lattice& message) {
  for (const auto& row : to_world.linear) {
    for (const double entry : row) message.add_linear(entry);
  }
  message.set_origin_x(to_world.origin.x);
  message.set_origin_y(to_world.origin.y);
  message.set_origin_z(to_world.origin.z);
}

void to_proto(const Improvement& improvement, v1::Improvement& message) {
  message.set_min_dihedral_before_deg(improvement.min_dihedral_before_deg);
  message.set_max_dihedral_before_deg(improvement.max_dihedral_before_deg);
  message.set_moved_vertices(signed_count(improvement.moved_vertices));
  message.set_seconds(improvement.seconds);
}

void to_proto(const QualityStats& stats, v1::QualityStats& message) {
  message.set_min_dihedral_deg(stats.min_dihedral_deg);
  message.set_max_dihedral_deg(stats.max_dihedral_deg);
  message.set_volume(stats.volume);
  for (const std::uint64_t count : stats.histogram) {
    message.add_dihedral_histogram(signed_count(count));
  }
}

void to_proto(const BoundaryTopology& boundary, v1::BoundaryTopology& message) {
  message.set_triangles(signed_count(boundary.triangles));
  message.set_vertices(signed_count(boundary.vertices));
  message.set_components(signed_count(boundary.components));
  message.set_euler_characteristic(boundary.euler_characteristic);
  message.set_non_manifold_edges(signed_count(boundary.non_manifold_edges));
  message.set_non_manifold_vertices(signed_count(boundary.non_manifold_vertices));
  message.set_restored_nodes(signed_count(boundary.restored_nodes));
}

void to_proto(const ThinWalls& walls, v1::ThinWalls& message) {
  message.set_inside_spots(signed_count(walls.inside));
  message.set_outside_spots(signed_count(walls.outside));
  message.set_region_count(signed_count(walls.region_count));
  for (const ThinWalls::Region& region : walls.regions) {
    v1::ThinRegion& listed = *message.add_regions();
    set_point(region.box.min, *listed.mutable_box()->mutable_min());
    set_point(region.box.max, *listed.mutable_box()->mutable_max());
    listed.set_inside_spots(signed_count(region.inside));
    listed.set_outside_spots(signed_count(region.outside));
  }
  message.set_thickness(walls.thickness);
  message.set_suggested_spacing(walls.suggested_spacing);
}

}  // namespace tet
