#include "core/image/meta_header.h"

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/image/header_numbers.h"
#include "core/image/image_refusal.h"
#include "core/image/text_header.h"

namespace tet {
namespace {

constexpr std::size_t kMostMetaDimensions = 10;

constexpr std::pair<std::string_view, ScalarType> kMetaTypes[] = {
    {"MET_CHAR", ScalarType::kInt8},       {"MET_UCHAR", ScalarType::kUint8},
    {"MET_SHORT", ScalarType::kInt16},     {"MET_USHORT", ScalarType::kUint16},
    {"MET_INT", ScalarType::kInt32},       {"MET_UINT", ScalarType::kUint32},
    {"MET_LONG_LONG", ScalarType::kInt64}, {"MET_ULONG_LONG", ScalarType::kUint64},
    {"MET_FLOAT", ScalarType::kFloat32},   {"MET_DOUBLE", ScalarType::kFloat64},
};

struct MetaFields {
  std::map<std::string, std::string, std::less<>> of;
  std::vector<std::string> listed_files;  ///< those after "ElementDataFile = LIST"
  std::string attached;                   ///< its lines but those about files
  std::size_t end = 0;                    ///< where the data begin

  const std::string* find(std::string_view name) const {
    const auto found = of.find(name);
    return found == of.end() ? nullptr : &found->second;
  }
  /// The first that there is: fields have several names.
  const std::string* any(std::initializer_list<std::string_view> names) const {
    for (const std::string_view name : names) {
      if (const std::string* value = find(name)) return value;
    }
    return nullptr;
  }
  const std::string& get(std::string_view name) const {
    const std::string* value = find(name);
    if (value == nullptr) refuse_image(absl::StrCat("its header has no field ", as_absl(name)));
    return *value;
  }
  bool is_true(std::string_view name) const {
    const std::string* value = find(name);
    return value != nullptr && absl::EqualsIgnoreCase(*value, "true");
  }
};

/// The data's file is the last field.
MetaFields read_meta_fields(std::span<const std::byte> head) {
  HeaderLines lines(head.first(std::min(head.size(), kTextHeaderBytes)));
  MetaFields fields;
  while (const auto line = lines.next()) {
    fields.end = lines.position();
    const std::size_t equals = line->find('=');
    if (equals == std::string_view::npos) {
      if (trimmed(*line).empty()) continue;
      refuse_image(
          absl::StrCat("its header has the line ", quoted_text(*line), ", which is no field"));
    }
    const std::string name(trimmed(line->substr(0, equals)));
    const std::string value(trimmed(line->substr(equals + 1)));
    if (!fields.of.emplace(name, value).second) {
      refuse_image(absl::StrCat("its header has the field ", quoted_text(name), " twice"));
    }
    if (name == "ElementDataFile") {
      if (!absl::StartsWith(value, "LIST")) return fields;
      while (const auto listed = lines.next()) {
        const auto file = trimmed(*listed);
        if (!file.empty()) fields.listed_files.emplace_back(file);
      }
      return fields;
    }
    if (name != "HeaderSize") absl::StrAppend(&fields.attached, as_absl(*line), "\n");
  }
  if (head.size() >= kTextHeaderBytes) {
    refuse_image(absl::StrFormat("its header has no end within %d bytes", kTextHeaderBytes));
  }
  refuse_image("it is truncated: its header has no ElementDataFile");
}

ScalarType meta_type(const std::string& text) {
  for (const auto& [known, type] : kMetaTypes) {
    if (text == known) return type;
  }
  refuse_contents(absl::StrCat("its values are of the type ", quoted_text(text),
                               ", and MET_CHAR to MET_LONG_LONG, MET_FLOAT and MET_DOUBLE are "
                               "read"));
}

/// As many numbers as there are dimensions, of which the first three are taken.
std::vector<double> meta_numbers(const std::string& text, std::size_t count, const char* what) {
  const auto words = words_of(text, kMostMetaDimensions * kMostMetaDimensions, what);
  if (words.size() != count) {
    refuse_image(
        absl::StrFormat("its %s has %d numbers and not %d", what, words.size(), count));
  }
  std::vector<double> numbers;
  numbers.reserve(words.size());
  for (const std::string_view word : words) numbers.push_back(number_of(word, what));
  return numbers;
}

/// The lines of the matrix are the directions of the image's axes, in LPS: ITK's order.
void set_meta_axes(const MetaFields& fields, std::size_t dimensions, ImageArray& array) {
  std::vector<double> spacing(dimensions, 1), origin(dimensions, 0);
  if (const auto* text = fields.any({"ElementSpacing", "ElementSize"})) {
    spacing = meta_numbers(*text, dimensions, "ElementSpacing");
  }
  if (const auto* text = fields.any({"Offset", "Origin", "Position"})) {
    origin = meta_numbers(*text, dimensions, "Offset");
  }
  std::array<Triple, 3> axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  if (const auto* text = fields.any({"TransformMatrix", "Rotation", "Orientation"})) {
    const auto matrix = meta_numbers(*text, dimensions * dimensions, "TransformMatrix");
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < 3; ++k) axes[i][k] = matrix[i * dimensions + k];
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    for (double& entry : axes[i]) entry *= spacing[i];
  }
  set_axes(axes, {origin[0], origin[1], origin[2]}, array);
}

void set_meta_scaling(const MetaFields& fields, ImageArray& array) {
  if (const auto* slope = fields.find("ElementToIntensityFunctionSlope")) {
    array.slope = number_of(*slope, "ElementToIntensityFunctionSlope");
  }
  if (const auto* offset = fields.find("ElementToIntensityFunctionOffset")) {
    array.intercept = number_of(*offset, "ElementToIntensityFunctionOffset");
  }
}

/// All but where the data are.
ImageArray read_meta_array(const MetaFields& fields) {
  const std::string* kind = fields.find("ObjectType");
  if (kind != nullptr && *kind != "Image") {
    refuse_contents(absl::StrCat("its object is ", quoted_text(*kind), " and no image"));
  }
  const std::string* channels = fields.find("ElementNumberOfChannels");
  if (channels != nullptr && integer_of(*channels, "ElementNumberOfChannels") != 1) {
    refuse_contents(absl::StrCat("its voxels have ", quoted_text(*channels),
                                 " values each: write one number a voxel"));
  }
  ImageArray array;
  array.name = "image";
  array.type = meta_type(fields.get("ElementType"));
  array.big_endian =
      fields.is_true("BinaryDataByteOrderMSB") || fields.is_true("ElementByteOrderMSB");
  const std::string* binary = fields.find("BinaryData");
  const bool text = binary != nullptr && absl::EqualsIgnoreCase(*binary, "false");
  array.encoding = text                               ? ImageEncoding::kText
                   : fields.is_true("CompressedData") ? ImageEncoding::kDeflate
                                                      : ImageEncoding::kRaw;
  const std::int64_t dimensions = integer_of(fields.get("NDims"), "NDims");
  const auto words = words_of(fields.get("DimSize"), kMostMetaDimensions, "DimSize");
  if (dimensions < 1 || static_cast<std::uint64_t>(dimensions) != words.size()) {
    refuse_image(
        absl::StrFormat("its NDims is %d, and its DimSize has %d", dimensions, words.size()));
  }
  std::vector<std::int64_t> sizes;
  sizes.reserve(words.size());
  for (const std::string_view word : words) sizes.push_back(integer_of(word, "DimSize"));
  set_size(sizes, array);
  set_meta_axes(fields, words.size(), array);
  set_meta_scaling(fields, array);
  return array;
}

}  // namespace

bool is_meta(std::span<const std::byte> head) noexcept {
  const std::string_view text(reinterpret_cast<const char*>(head.data()),
                              std::min<std::size_t>(head.size(), 64));
  const auto begins = [&](std::string_view key) {
    if (!text.starts_with(key)) return false;
    const std::size_t next = text.find_first_not_of(" \t", key.size());
    return next != std::string_view::npos && text[next] == '=';
  };
  return begins("ObjectType") || begins("NDims") || begins("Comment");
}

ImageOutline read_meta_header(std::span<const std::byte> head, std::uint64_t file_bytes) {
  const MetaFields fields = read_meta_fields(head);
  ImageOutline outline;
  outline.format = ImageFormat::kMeta;
  outline.space.axes = "LPS";
  ImageArray array = read_meta_array(fields);
  if (!absl::EqualsIgnoreCase(fields.get("ElementDataFile"), "LOCAL")) {
    refuse_contents(
        "its data are in another file: join them, as tetstream does with a header "
        "that it is given on the command line");
  }
  set_attached_data(fields.end, file_bytes, array);
  outline.arrays.push_back(std::move(array));
  return outline;
}

bool is_detached_meta(std::span<const std::byte> head) {
  if (!is_meta(head)) return false;
  const std::string file = read_meta_fields(head).get("ElementDataFile");
  return !absl::EqualsIgnoreCase(file, "LOCAL");
}

DetachedHeader read_detached_meta(std::span<const std::byte> head) {
  const MetaFields fields = read_meta_fields(head);
  const ImageArray array = read_meta_array(fields);
  const std::string& file = fields.get("ElementDataFile");
  DetachedHeader header;
  const bool lists = absl::StartsWith(file, "LIST");
  header.files = lists ? fields.listed_files : std::vector<std::string>{file};
  if (file.empty() || header.files.empty()) refuse_image("its ElementDataFile names no file");
  if (file.find('%') != std::string::npos) {
    refuse_contents("its ElementDataFile is a pattern: list the files, or write one .mha");
  }
  const bool raw = array.encoding == ImageEncoding::kRaw;
  const std::string* skip = fields.find("HeaderSize");
  const std::int64_t skipped = skip == nullptr ? 0 : integer_of(*skip, "HeaderSize");
  if (skipped < -1) refuse_image(absl::StrFormat("its HeaderSize is %d", skipped));
  header.skip_to_last = skipped == -1;
  header.skip_bytes = skipped > 0 ? static_cast<std::uint64_t>(skipped) : 0;
  if (header.skip_to_last && !raw)
    refuse_image("its HeaderSize is -1, and its data are packed");
  if (header.files.size() > 1 && !raw) {
    refuse_contents("its data are packed in several files: write them to one");
  }
  header.data_bytes = raw ? array.value_bytes() : 0;
  header.attached = absl::StrCat(fields.attached, "ElementDataFile = LOCAL\n");
  return header;
}

}  // namespace tet
