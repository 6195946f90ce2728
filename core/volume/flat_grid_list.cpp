#include "core/volume/flat_grid_list.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/base/utf8.h"

namespace tet {
namespace {

constexpr std::array<char, 8> kListMagic{'t', 'e', 't', '-', 'i', 'n', 'f', '\n'};
constexpr std::uint32_t kListVersion = 3;
constexpr std::size_t kMaxTextBytes = 1000;

struct ListHeader {
  std::array<char, 8> magic = kListMagic;
  std::uint32_t version = kListVersion;
  std::uint32_t reserved = 0;
  std::uint64_t grid_count = 0;
  std::uint64_t text_bytes = 0;
};
static_assert(sizeof(ListHeader) == 32);

/// A grid but for its texts, which follow each other in a column of their own.
struct Record {
  std::uint64_t active_voxels = 0;
  double voxel_size = 0;
  VoxelBox active_box;
  float background = 0;
  std::uint32_t name_bytes = 0;
  std::uint32_t value_type_bytes = 0;
  std::uint32_t grid_class_bytes = 0;
  std::uint32_t not_meshable_bytes = 0;
  std::uint32_t field_components = 0;
  std::uint32_t made_of_bytes = 0;
  std::uint32_t place_bytes = 0;
};
static_assert(sizeof(Record) == 72);

Record record_of(const GridInfo& grid) {
  Record record;
  record.active_voxels = grid.active_voxels;
  record.voxel_size = grid.voxel_size;
  record.active_box = grid.active_box;
  record.background = grid.background;
  record.name_bytes = static_cast<std::uint32_t>(grid.name.size());
  record.value_type_bytes = static_cast<std::uint32_t>(grid.value_type.size());
  record.grid_class_bytes = static_cast<std::uint32_t>(grid.grid_class.size());
  record.not_meshable_bytes = static_cast<std::uint32_t>(grid.not_meshable.size());
  record.field_components = grid.field_components;
  record.made_of_bytes = static_cast<std::uint32_t>(grid.made_of.size());
  record.place_bytes = static_cast<std::uint32_t>(grid.place.size());
  return record;
}

absl::Status wrong_list(const std::string& what) {
  return absl::InvalidArgumentError(absl::StrCat("the list of grids is not valid: ", what));
}

absl::StatusOr<ListHeader> read_header(FlatReader& reader) {
  const auto bytes = reader.column<std::byte>(sizeof(ListHeader));
  if (!bytes) return wrong_list("it has no header");
  ListHeader header;
  std::memcpy(&header, bytes->data(), sizeof(ListHeader));
  if (header.magic != kListMagic) return wrong_list("it does not begin with its magic number");
  if (header.version != kListVersion || header.reserved != 0) {
    return wrong_list(absl::StrFormat("its version is %d and only %d can be read",
                                      header.version, kListVersion));
  }
  return header;
}

/// Takes the first `count` bytes of `rest`.
bool take(std::string_view& rest, std::size_t count, std::size_t limit, std::string& text) {
  if (count > rest.size() || count > limit) return false;
  text = rest.substr(0, count);
  rest.remove_prefix(count);
  return true;
}

bool is_printable(std::string_view text) {
  return std::all_of(text.begin(), text.end(),
                     [](char c) { return absl::ascii_isprint(static_cast<unsigned char>(c)); });
}

bool is_box(const VoxelBox& box) {
  const VoxelBox empty;
  return (box.min == empty.min && box.max == empty.max) ||
         (box.min.x <= box.max.x && box.min.y <= box.max.y && box.min.z <= box.max.z);
}

bool is_component_count(std::uint32_t components) {
  return components == 0 || components == 1 || components == 3;
}

absl::StatusOr<GridInfo> read_grid(const Record& record, std::string_view& text) {
  GridInfo grid;
  if (!take(text, record.name_bytes, kMaxGridNameBytes, grid.name) ||
      !take(text, record.value_type_bytes, kMaxTextBytes, grid.value_type) ||
      !take(text, record.grid_class_bytes, kMaxTextBytes, grid.grid_class) ||
      !take(text, record.not_meshable_bytes, kMaxTextBytes, grid.not_meshable) ||
      !take(text, record.made_of_bytes, kMaxTextBytes, grid.made_of) ||
      !take(text, record.place_bytes, kMaxTextBytes, grid.place)) {
    return wrong_list("a text is too long");
  }
  // A message of protobuf holds nothing else, and would be refused as a whole.
  if (!is_utf8(grid.name)) return wrong_list("a name is not UTF-8");
  if (!is_printable(grid.value_type) || !is_printable(grid.grid_class) ||
      !is_printable(grid.not_meshable) || !is_printable(grid.made_of) ||
      !is_printable(grid.place)) {
    return wrong_list("a text is not printable");
  }
  if (!is_box(record.active_box)) return wrong_list("a box is none");
  if (!is_component_count(record.field_components))
    return wrong_list("a field has no such values");
  if (!std::isfinite(record.voxel_size) && grid.not_meshable.empty()) {
    return wrong_list("a voxel size is not finite");
  }
  grid.voxel_size = record.voxel_size;
  grid.active_voxels = record.active_voxels;
  grid.active_box = record.active_box;
  grid.background = record.background;
  grid.field_components = record.field_components;
  return grid;
}

}  // namespace

absl::Status write_flat_grid_list(std::span<const GridInfo> grids, const ByteSink& sink) {
  std::vector<Record> records;
  std::string text;
  for (const GridInfo& grid : grids) {
    records.push_back(record_of(grid));
    absl::StrAppend(&text, grid.name, grid.value_type, grid.grid_class, grid.not_meshable,
                    grid.made_of, grid.place);
  }
  ListHeader header;
  header.grid_count = records.size();
  header.text_bytes = text.size();
  FlatWriter writer(sink);
  writer.add(std::span<const ListHeader>(&header, 1));
  writer.add(std::span<const Record>(records));
  writer.add(std::span<const char>(text));
  return writer.status();
}

absl::StatusOr<std::vector<GridInfo>> read_flat_grid_list(std::span<const std::byte> block) {
  FlatReader reader(block);
  const absl::StatusOr<ListHeader> header = read_header(reader);
  if (!header.ok()) return header.status();
  const auto records = reader.column<Record>(header->grid_count);
  if (!records)
    return wrong_list(absl::StrFormat("%d grids do not fit in it", header->grid_count));
  const auto bytes = reader.column<char>(header->text_bytes);
  if (!bytes || !reader.at_end()) return wrong_list("its texts do not fill it");
  std::string_view text(bytes->data(), bytes->size());
  std::vector<GridInfo> grids;
  for (const Record& record : *records) {
    absl::StatusOr<GridInfo> grid = read_grid(record, text);
    if (!grid.ok()) return grid.status();
    grids.push_back(*std::move(grid));
  }
  if (!text.empty()) return wrong_list("its texts do not fill it");
  return grids;
}

}  // namespace tet
