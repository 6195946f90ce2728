#include "core/volume/flat_grid_contents.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include <absl/strings/str_cat.h>

namespace tet {
namespace {

constexpr std::array<char, 8> kContentsMagic{'t', 'e', 't', '-', 'v', 'a', 'l', '\n'};
constexpr std::uint32_t kContentsVersion = 1;

struct ContentsHeader {
  std::array<char, 8> magic = kContentsMagic;
  std::uint32_t version = kContentsVersion;
  std::uint32_t has_values = 0;
  float min = 0, max = 0, background = 0;
  std::uint32_t inside = 0, source = 0;
  std::uint32_t reserved = 0;
  std::uint64_t label_count = 0, listed = 0;
};
static_assert(sizeof(ContentsHeader) == 56);

struct LabelRecord {
  std::int64_t value = 0;
  std::uint64_t voxels = 0;
  VoxelBox box;
};
static_assert(sizeof(LabelRecord) == 40);

absl::Status wrong_contents(const char* what) {
  return absl::InvalidArgumentError(
      absl::StrCat("what a grid's values tell is not valid: ", what));
}

bool is_ordered(const VoxelBox& box) {
  return box.min.x <= box.max.x && box.min.y <= box.max.y && box.min.z <= box.max.z;
}

absl::Status check_contents_header(const ContentsHeader& header) {
  if (header.magic != kContentsMagic || header.version != kContentsVersion) {
    return wrong_contents("it does not begin with its magic number and version");
  }
  const bool is_known = header.has_values <= 1 && header.inside <= 1 &&
                        header.source <= static_cast<std::uint32_t>(KindSource::kNobody);
  if (!is_known) return wrong_contents("it has a number that means nothing");
  const bool is_finite = std::isfinite(header.min) && std::isfinite(header.max) &&
                         std::isfinite(header.background) && header.min <= header.max;
  if (!is_finite) return wrong_contents("a value is not finite");
  const auto listed = std::min<std::uint64_t>(header.label_count, kMostListedLabels);
  if (header.listed != listed || header.label_count > LabelVolume::kMostLabels) {
    return wrong_contents("its labels are not as many as it says");
  }
  return absl::OkStatus();
}

absl::Status add_labels(std::span<const LabelRecord> records, GridContents& contents) {
  for (const LabelRecord& record : records) {
    const bool ascends = contents.labels.empty() || contents.labels.back().value < record.value;
    if (!ascends || !is_ordered(record.box) || record.voxels == 0) {
      return wrong_contents("a label is none, or in the wrong place");
    }
    contents.labels.push_back({record.value, record.voxels, record.box});
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status write_flat_contents(const GridContents& contents, const ByteSink& sink) {
  ContentsHeader header;
  if (contents.values) {
    header.has_values = 1;
    header.min = contents.values->range.min;
    header.max = contents.values->range.max;
    header.background = contents.values->background;
    header.inside = static_cast<std::uint32_t>(contents.values->inside);
    header.source = static_cast<std::uint32_t>(contents.values->source);
  }
  header.label_count = contents.label_count;
  header.listed = contents.labels.size();
  std::vector<LabelRecord> records;
  for (const LabelExtent& label : contents.labels) {
    records.push_back({label.value, label.voxels, label.box});
  }
  FlatWriter writer(sink);
  writer.add(std::span<const ContentsHeader>(&header, 1));
  writer.add(std::span<const LabelRecord>(records));
  return writer.status();
}

absl::StatusOr<GridContents> read_flat_contents(std::span<const std::byte> block) {
  FlatReader reader(block);
  const auto bytes = reader.column<std::byte>(sizeof(ContentsHeader));
  if (!bytes) return wrong_contents("it has no header");
  ContentsHeader header;
  std::memcpy(&header, bytes->data(), sizeof(header));
  if (auto status = check_contents_header(header); !status.ok()) return status;
  const auto records = reader.column<LabelRecord>(header.listed);
  if (!records || !reader.at_end()) return wrong_contents("its labels do not fill it");
  GridContents contents;
  if (header.has_values == 1) {
    contents.values = GridValues{{header.min, header.max},
                                 header.background,
                                 static_cast<InsideSide>(header.inside),
                                 static_cast<KindSource>(header.source)};
  }
  contents.label_count = header.label_count;
  if (auto status = add_labels(*records, contents); !status.ok()) return status;
  return contents;
}

}  // namespace tet
