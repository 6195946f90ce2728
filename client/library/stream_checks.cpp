#include "client/library/stream_checks.h"

#include <algorithm>
#include <optional>
#include <set>
#include <vector>

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>

#include "core/base/utf8.h"
#include "core/plan/vertex_field.h"
#include "core/volume/grid_info.h"

namespace tet {

namespace {

// Beyond any mesh that fits a machine, and small enough that sizes in bytes do not overflow.
constexpr std::int64_t kMaxCount = std::int64_t{1} << 48;

bool is_valid(const v1::MeshHeader& header) {
  return is_count(header.vertex_count()) && is_count(header.tet_count()) &&
         is_count(header.chunk_count()) &&
         header.coordinate_type() != v1::COORDINATE_TYPE_UNSPECIFIED &&
         v1::CoordinateType_IsValid(header.coordinate_type()) &&
         header.index_type() != v1::INDEX_TYPE_UNSPECIFIED &&
         v1::IndexType_IsValid(header.index_type());
}

bool is_valid(const v1::FieldArray& field) {
  return is_array_name(field.name()) && (field.components() == 1 || field.components() == 3);
}

/// Converts the header's fields; std::nullopt where a name or a count cannot be right.
std::optional<std::vector<FieldArray>> to_core(
    const google::protobuf::RepeatedPtrField<v1::FieldArray>& messages) {
  std::set<std::string> names;
  std::vector<FieldArray> fields;
  for (const v1::FieldArray& field : messages) {
    if (!is_valid(field) || !names.insert(field.name()).second) return std::nullopt;
    fields.push_back({field.name(), static_cast<std::uint32_t>(field.components())});
  }
  if (fields.size() > VertexField::kMaxFields) return std::nullopt;
  return fields;
}

/// A name that may be shown and written into files.
bool is_part_name(const std::string& name) {
  return !name.empty() && name.size() <= kMaxGridNameBytes && is_utf8(name) &&
         std::none_of(name.begin(), name.end(),
                      [](unsigned char c) { return absl::ascii_iscntrl(c); });
}

/// Converts the header's parts; std::nullopt where they are not all of the mesh, one behind the
/// other.
std::optional<std::vector<MeshPart>> parts_of(const v1::MeshHeader& header) {
  if (header.parts().size() > int{kMaxMeshParts}) return std::nullopt;
  std::vector<MeshPart> parts;
  std::int64_t vertices = 0, tets = 0;
  for (const v1::MeshPart& part : header.parts()) {
    if (!is_part_name(part.name()) || !is_count(part.vertex_count()) ||
        !is_count(part.tet_count()) || part.first_vertex() != vertices ||
        part.first_tet() != tets) {
      return std::nullopt;
    }
    vertices += part.vertex_count();
    tets += part.tet_count();
    const auto count = [](std::int64_t value) { return static_cast<std::uint64_t>(value); };
    parts.push_back({part.name(), count(part.first_vertex()), count(part.vertex_count()),
                     count(part.first_tet()), count(part.tet_count()), part.spacing(),
                     part.levels()});
  }
  const bool whole = vertices == header.vertex_count() && tets == header.tet_count();
  if (!parts.empty() && !whole) return std::nullopt;
  return parts;
}

}  // namespace

absl::Status bad_stream(const std::string& message) {
  return absl::DataLossError(absl::StrCat("the server's stream is broken: ", message));
}

WorldPoint world_point(const v1::Point& point) { return {point.x(), point.y(), point.z()}; }

bool is_count(std::int64_t count) { return 0 <= count && count <= kMaxCount; }

bool is_count(std::uint64_t count) { return count <= std::uint64_t{kMaxCount}; }

absl::StatusOr<MeshHeader> checked_header(const v1::MeshHeader& message) {
  if (!is_valid(message)) return bad_stream("a header with impossible values");
  MeshHeader header;
  header.vertex_count = static_cast<std::uint64_t>(message.vertex_count());
  header.tet_count = static_cast<std::uint64_t>(message.tet_count());
  header.chunk_count = static_cast<std::uint64_t>(message.chunk_count());
  header.coordinate_type = message.coordinate_type() == v1::COORDINATE_TYPE_FLOAT64
                               ? CoordinateType::kFloat64
                               : CoordinateType::kFloat32;
  header.index_type =
      message.index_type() == v1::INDEX_TYPE_UINT64 ? IndexType::kUint64 : IndexType::kUint32;
  header.origin = world_point(message.origin());
  header.bounds = {world_point(message.bounds().min()), world_point(message.bounds().max())};
  header.spacing = message.spacing();
  header.levels = message.levels();
  header.has_regions = message.has_regions();
  auto fields = to_core(message.fields());
  if (!fields) return bad_stream("a header with impossible fields");
  header.fields = *std::move(fields);
  auto parts = parts_of(message);
  if (!parts) return bad_stream("a header with impossible parts");
  header.parts = *std::move(parts);
  return header;
}

}  // namespace tet
