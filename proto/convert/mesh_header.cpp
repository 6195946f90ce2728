#include "proto/convert/mesh_header.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/base/utf8.h"
#include "core/plan/vertex_field.h"
#include "core/volume/check_transform.h"
#include "core/volume/grid_info.h"
#include "proto/convert/counts.h"
#include "proto/convert/face_labels.h"
#include "proto/convert/face_regions.h"
#include "proto/convert/labels_request.h"
#include "proto/convert/points.h"

namespace tet {
namespace {

absl::Status bad(const std::string& message) { return absl::InvalidArgumentError(message); }

absl::Status check_count(const char* field, std::int64_t count) {
  if (is_count(count)) return absl::OkStatus();
  return bad(absl::StrFormat("%s %d is not from 0 to %d", field, count, kMaxCount));
}

absl::Status check_counts(const v1::MeshHeader& message) {
  absl::Status status = check_count("vertex_count", message.vertex_count());
  if (status.ok()) status = check_count("tet_count", message.tet_count());
  if (status.ok()) status = check_count("chunk_count", message.chunk_count());
  if (status.ok()) status = check_count("face_count", message.face_count());
  return status;
}

absl::Status check_spacing(double spacing, int levels) {
  if (spacing != 0 && !may_be_edge(spacing)) {
    return bad(absl::StrFormat("spacing %g is not from %g to %g", spacing, kShortestEdge,
                               kLongestEdge));
  }
  if (0 <= levels && levels <= kMaxLevels) return absl::OkStatus();
  return bad(absl::StrFormat("levels %d is not from 0 to %d", levels, kMaxLevels));
}

absl::Status check_place(const v1::MeshHeader& message) {
  if (!is_finite(message.origin())) return bad("origin is not finite");
  if (!is_finite(message.bounds())) return bad("bounds are not finite");
  if (message.has_box() && !is_finite(message.box())) return bad("box is not finite");
  return check_spacing(message.spacing(), message.levels());
}

/// A part's name is shown, and written into files.
bool is_part_name(const std::string& name) {
  return !name.empty() && name.size() <= kMaxGridNameBytes && is_utf8(name) &&
         std::none_of(name.begin(), name.end(),
                      [](unsigned char c) { return absl::ascii_iscntrl(c); });
}

absl::Status check_part(const v1::MeshPart& part, std::int64_t vertices, std::int64_t tets) {
  if (!is_part_name(part.name())) return bad("name cannot be shown");
  if (!is_count(part.vertex_count()) || !is_count(part.tet_count())) {
    return bad("its counts are impossible");
  }
  if (part.first_vertex() != vertices || part.first_tet() != tets) {
    return bad("it does not begin where the one before it ends");
  }
  return check_spacing(part.spacing(), part.levels());
}

MeshPart part_of(const v1::MeshPart& part) {
  return {part.name(),
          unsigned_count(part.first_vertex()),
          unsigned_count(part.vertex_count()),
          unsigned_count(part.first_tet()),
          unsigned_count(part.tet_count()),
          part.spacing(),
          part.levels()};
}

absl::StatusOr<std::vector<MeshPart>> parts_of(const v1::MeshHeader& message) {
  if (message.parts_size() > int{kMaxMeshParts}) {
    return bad(absl::StrCat("parts has ", message.parts_size(), " entries; the limit is ",
                            kMaxMeshParts));
  }
  std::vector<MeshPart> parts;
  std::int64_t vertices = 0, tets = 0;
  for (const v1::MeshPart& part : message.parts()) {
    if (const absl::Status status = check_part(part, vertices, tets); !status.ok()) {
      return bad(absl::StrFormat("parts[%d]: %s", parts.size(), status.message()));
    }
    vertices += part.vertex_count();
    tets += part.tet_count();
    parts.push_back(part_of(part));
  }
  const bool whole = vertices == message.vertex_count() && tets == message.tet_count();
  if (!parts.empty() && !whole) return bad("parts are not all of the mesh");
  return parts;
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

}  // namespace

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

std::optional<CoordinateType> from_proto(v1::CoordinateType type) {
  if (type == v1::COORDINATE_TYPE_FLOAT32) return CoordinateType::kFloat32;
  if (type == v1::COORDINATE_TYPE_FLOAT64) return CoordinateType::kFloat64;
  return std::nullopt;
}

std::optional<IndexType> from_proto(v1::IndexType type) {
  if (type == v1::INDEX_TYPE_UINT32) return IndexType::kUint32;
  if (type == v1::INDEX_TYPE_UINT64) return IndexType::kUint64;
  return std::nullopt;
}

std::optional<Preset> from_proto(v1::Preset preset) {
  for (const Preset known : kPresets) {
    if (to_proto(known) == preset) return known;
  }
  return std::nullopt;
}

void to_proto(const std::vector<FieldArray>& arrays, ArrayMessages& messages) {
  for (const FieldArray& array : arrays) {
    v1::FieldArray& message = *messages.Add();
    message.set_name(array.name);
    message.set_components(static_cast<std::int32_t>(array.components));
  }
}

absl::StatusOr<std::vector<FieldArray>> from_proto(const ArrayMessages& messages) {
  constexpr int kMostArrays = int{VertexField::kMaxFields} + 1;  // a cut adds its own
  if (messages.size() > kMostArrays) {
    return bad(absl::StrFormat("fields has %d entries; the limit is %d", messages.size(),
                               kMostArrays));
  }
  std::set<std::string> names;
  std::vector<FieldArray> fields;
  for (const v1::FieldArray& field : messages) {
    const bool is_new = names.insert(field.name()).second;
    const bool is_array = field.components() == 1 || field.components() == 3;
    if (!is_new || !is_array || !is_array_name(field.name())) {
      return bad(absl::StrCat("fields[", fields.size(), "] is no array of its own"));
    }
    fields.push_back({field.name(), static_cast<std::uint32_t>(field.components())});
  }
  return fields;
}

void to_proto(const MeshHeader& header, v1::MeshHeader& message) {
  message.set_vertex_count(signed_count(header.vertex_count));
  message.set_tet_count(signed_count(header.tet_count));
  message.set_chunk_count(signed_count(header.chunk_count));
  message.set_coordinate_type(to_proto(header.coordinate_type));
  message.set_index_type(to_proto(header.index_type));
  to_proto(header.origin, *message.mutable_origin());
  to_proto(header.bounds, *message.mutable_bounds());
  message.set_spacing(header.spacing);
  message.set_levels(header.levels);
  message.set_has_regions(header.has_regions);
  to_proto(header.fields, *message.mutable_fields());
  for (const MeshPart& part : header.parts) to_proto(part, *message.add_parts());
  if (header.box) to_proto(*header.box, *message.mutable_box());
  message.set_inside_guess(header.inside_guess);
  for (const FaceLabel& label : header.face_labels) to_proto(label, *message.add_face_labels());
  for (const MeshLabel& label : header.labels) to_proto(label, *message.add_labels());
  message.set_face_count(signed_count(header.face_count));
  message.set_mesh_bytes(signed_count(ChunkSizes(header, whole_of(header)).total()));
}

absl::StatusOr<MeshHeader> from_proto(const v1::MeshHeader& message) {
  if (auto status = check_counts(message); !status.ok()) return status;
  if (auto status = check_place(message); !status.ok()) return status;
  const auto coordinates = from_proto(message.coordinate_type());
  if (!coordinates) return bad("coordinate_type is unknown");
  const auto indices = from_proto(message.index_type());
  if (!indices) return bad("index_type is unknown");
  auto fields = from_proto(message.fields());
  if (!fields.ok()) return fields.status();
  auto parts = parts_of(message);
  if (!parts.ok()) return parts.status();
  auto labels = face_labels_of(message);
  if (!labels.ok()) return labels.status();
  auto regions = face_regions_of(message.canonical_request().face_regions());
  if (!regions.ok()) return regions.status();
  auto mesh_labels = labels_of(message);
  if (!mesh_labels.ok()) return mesh_labels.status();
  MeshHeader header;
  header.vertex_count = unsigned_count(message.vertex_count());
  header.tet_count = unsigned_count(message.tet_count());
  header.chunk_count = unsigned_count(message.chunk_count());
  header.coordinate_type = *coordinates;
  header.index_type = *indices;
  header.origin = from_proto(message.origin());
  header.bounds = from_proto(message.bounds());
  header.spacing = message.spacing();
  header.levels = message.levels();
  header.has_regions = message.has_regions();
  header.fields = *std::move(fields);
  header.parts = *std::move(parts);
  if (message.has_box()) header.box = from_proto(message.box());
  header.inside_guess = message.inside_guess();
  header.face_labels = *std::move(labels);
  header.labels = *std::move(mesh_labels);
  header.face_count = unsigned_count(message.face_count());
  header.face_regions = *std::move(regions);
  return header;
}

}  // namespace tet
