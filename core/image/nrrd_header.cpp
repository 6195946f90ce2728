#include "core/image/nrrd_header.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_split.h>

#include "core/image/header_numbers.h"
#include "core/image/image_refusal.h"
#include "core/image/nrrd_axis.h"
#include "core/image/nrrd_fields.h"
#include "core/image/text_header.h"

namespace tet {
namespace {

constexpr std::size_t kMostNrrdDimensions = 16;

using NamedType = std::pair<std::string_view, ScalarType>;
constexpr NamedType kNrrdTypes[] = {
    {"signed char", ScalarType::kInt8},
    {"int8", ScalarType::kInt8},
    {"int8_t", ScalarType::kInt8},
    {"uchar", ScalarType::kUint8},
    {"unsigned char", ScalarType::kUint8},
    {"uint8", ScalarType::kUint8},
    {"uint8_t", ScalarType::kUint8},
    {"short", ScalarType::kInt16},
    {"short int", ScalarType::kInt16},
    {"signed short", ScalarType::kInt16},
    {"signed short int", ScalarType::kInt16},
    {"int16", ScalarType::kInt16},
    {"int16_t", ScalarType::kInt16},
    {"ushort", ScalarType::kUint16},
    {"unsigned short", ScalarType::kUint16},
    {"unsigned short int", ScalarType::kUint16},
    {"uint16", ScalarType::kUint16},
    {"uint16_t", ScalarType::kUint16},
    {"int", ScalarType::kInt32},
    {"signed int", ScalarType::kInt32},
    {"int32", ScalarType::kInt32},
    {"int32_t", ScalarType::kInt32},
    {"uint", ScalarType::kUint32},
    {"unsigned int", ScalarType::kUint32},
    {"uint32", ScalarType::kUint32},
    {"uint32_t", ScalarType::kUint32},
    {"longlong", ScalarType::kInt64},
    {"long long", ScalarType::kInt64},
    {"long long int", ScalarType::kInt64},
    {"signed long long", ScalarType::kInt64},
    {"signed long long int", ScalarType::kInt64},
    {"int64", ScalarType::kInt64},
    {"int64_t", ScalarType::kInt64},
    {"ulonglong", ScalarType::kUint64},
    {"unsigned long long", ScalarType::kUint64},
    {"unsigned long long int", ScalarType::kUint64},
    {"uint64", ScalarType::kUint64},
    {"uint64_t", ScalarType::kUint64},
    {"float", ScalarType::kFloat32},
    {"double", ScalarType::kFloat64},
};

/// A world, and whether x has to be turned round for it to be right-handed.
struct NamedSpace {
  std::string_view name, axes;
  bool turns_x;
};
constexpr NamedSpace kSpaces[] = {
    {"right-anterior-superior", "RAS", false},
    {"ras", "RAS", false},
    {"left-anterior-superior", "RAS", true},
    {"las", "RAS", true},
    {"left-posterior-superior", "LPS", false},
    {"lps", "LPS", false},
    {"scanner-xyz", "", false},
    {"3d-right-handed", "", false},
    {"3d-left-handed", "", true},
};

ScalarType nrrd_type(const std::string& text) {
  const std::string name = absl::AsciiStrToLower(text);
  for (const auto& [known, type] : kNrrdTypes) {
    if (name == known) return type;
  }
  refuse_contents(
      absl::StrCat("its values are of the type ", quoted_text(text),
                   ", and only integers of 8 to 64 bits, float and double are read"));
}

std::vector<std::int64_t> sizes_of(const NrrdFields& fields) {
  const std::int64_t dimension = integer_of(fields.get("dimension"), "dimension");
  const auto words = words_of(fields.get("sizes"), kMostNrrdDimensions, "sizes");
  if (dimension < 1 || static_cast<std::uint64_t>(dimension) != words.size()) {
    refuse_image(
        absl::StrFormat("its dimension is %d, and it has %d sizes", dimension, words.size()));
  }
  std::vector<std::int64_t> sizes;
  sizes.reserve(words.size());
  for (const std::string_view word : words) sizes.push_back(integer_of(word, "sizes"));
  return sizes;
}

/// "(1,0,0)", or "none".
std::optional<Triple> vector_of(std::string_view text, const char* what) {
  if (text == "none") return std::nullopt;
  if (text.size() < 2 || text.front() != '(' || text.back() != ')') {
    refuse_image(
        absl::StrCat("its ", what, " has ", quoted_text(text), ", which is no vector"));
  }
  const std::vector<std::string_view> parts =
      split_text(text.substr(1, text.size() - 2), ',', 5);
  if (parts.size() != 3) {
    refuse_image(
        absl::StrCat("its ", what, " has ", quoted_text(text), ", and a world has 3 axes"));
  }
  Triple vector{};
  for (std::size_t i = 0; i < 3; ++i) {
    vector[i] = number_of(trimmed(parts[i]), what);
  }
  return vector;
}

/// Vectors may have blanks within.
std::vector<std::string> vector_words(std::string_view text, const char* what) {
  std::vector<std::string> words;
  std::string word;
  bool open = false;
  for (const char c : text) {
    if (absl::ascii_isspace(static_cast<unsigned char>(c)) != 0) {
      if (!open && !word.empty()) words.push_back(std::exchange(word, {}));
      continue;
    }
    word += c;
    open = c == '(' || (open && c != ')');
    if (c == ')') words.push_back(std::exchange(word, {}));
  }
  if (!word.empty()) words.push_back(word);
  if (words.size() > kMostNrrdDimensions) {
    refuse_image(absl::StrCat("its ", what, " has too many entries"));
  }
  return words;
}

/// Which axes of the file are those of space: the three that have directions, or all.
struct Axes {
  std::vector<std::int64_t> sizes;  ///< those of space first, then the others
  std::array<Triple, 3> steps{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  Triple origin{};
};

Axes directed_axes(const NrrdFields& fields, const std::vector<std::int64_t>& sizes) {
  const auto words = vector_words(fields.get("space directions"), "space directions");
  if (words.size() != sizes.size()) {
    refuse_image(
        absl::StrFormat("it has %d sizes and %d space directions", sizes.size(), words.size()));
  }
  Axes axes;
  std::vector<std::int64_t> others;
  std::int64_t largest = 1;  // of the others
  bool mixed = false;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::optional<Triple> step = vector_of(words[i], "space directions");
    if (!step) {
      others.push_back(sizes[i]);
      largest = std::max(largest, sizes[i]);
      continue;
    }
    mixed = mixed || largest > 1;
    if (axes.sizes.size() == 3) refuse_image("it has more than 3 space directions");
    axes.steps[axes.sizes.size()] = *step;
    axes.sizes.push_back(sizes[i]);
  }
  if (mixed) {
    refuse_contents(absl::StrFormat(
        "its voxels have %d values each: write one number a voxel (of a segmentation with "
        "overlaps, export a label map)",
        others.front()));
  }
  if (axes.sizes.size() < 3 && largest > 1) {
    refuse_contents(absl::StrFormat(
        "it has directions for %d axes, and an axis of %d without one: write one slice, or a "
        "direction for each axis",
        axes.sizes.size(), largest));
  }
  axes.sizes.insert(axes.sizes.end(), others.begin(), others.end());
  if (const std::string* origin = fields.find("space origin")) {
    const auto at = vector_of(*origin, "space origin");
    if (at) axes.origin = *at;
  }
  return axes;
}

/// Numbers for each axis, of which "NaN" says nothing.
std::vector<std::optional<double>> numbers_of(const NrrdFields& fields, const char* name) {
  std::vector<std::optional<double>> numbers;
  const std::string* text = fields.find(name);
  if (text == nullptr) return numbers;
  for (const std::string_view word : words_of(*text, kMostNrrdDimensions, name)) {
    if (absl::EqualsIgnoreCase(as_absl(word), "nan")) {
      numbers.emplace_back(std::nullopt);
    } else {
      numbers.emplace_back(number_of(word, name));
    }
  }
  return numbers;
}

std::vector<Centering> centerings_of(const NrrdFields& fields) {
  std::vector<Centering> centerings;
  const std::string* text = fields.find("centers");
  if (text == nullptr) return centerings;
  for (const std::string_view word : words_of(*text, kMostNrrdDimensions, "centers")) {
    centerings.push_back(absl::EqualsIgnoreCase(as_absl(word), "cell")   ? Centering::kCell
                         : absl::EqualsIgnoreCase(as_absl(word), "node") ? Centering::kNode
                                                                         : Centering::kUnsaid);
  }
  return centerings;
}

Axes plain_axes(const NrrdFields& fields, const std::vector<std::int64_t>& sizes) {
  Axes axes;
  axes.sizes = sizes;
  const auto spacings = numbers_of(fields, "spacings"), mins = numbers_of(fields, "axis mins"),
             maxs = numbers_of(fields, "axis maxs");
  const std::vector<Centering> centerings = centerings_of(fields);
  for (std::size_t i = 0; i < std::min<std::size_t>(3, sizes.size()); ++i) {
    PlainAxis axis;
    axis.size = static_cast<double>(sizes[i]);
    if (i < spacings.size()) axis.spacing = spacings[i];
    if (i < mins.size()) axis.min = mins[i];
    if (i < maxs.size()) axis.max = maxs[i];
    if (i < centerings.size()) axis.centering = centerings[i];
    check_plain_axis(axis, i);
    axes.steps[i][i] = axis.step();
    axes.origin[i] = axis.origin();
  }
  return axes;
}

void set_space(const NrrdFields& fields, Axes& axes, ImageSpace& space) {
  const std::string* name = fields.find("space");
  if (name == nullptr) return;
  const std::string lower = absl::AsciiStrToLower(*name);
  const auto* known = std::find_if(std::begin(kSpaces), std::end(kSpaces),
                                   [&](const NamedSpace& s) { return lower == s.name; });
  if (known == std::end(kSpaces)) {
    refuse_contents(absl::StrCat("its space is ", quoted_text(*name),
                                 ", and a mesh has one of 3 dimensions and no time"));
  }
  space.axes = known->axes;
  if (!known->turns_x) return;
  space.note =
      absl::StrCat("its space is ", *name, ", which is left-handed: x is turned round");
  for (Triple& step : axes.steps) step[0] = -step[0];
  axes.origin[0] = -axes.origin[0];
}

ImageEncoding encoding_of(const std::string& text) {
  const std::string name = absl::AsciiStrToLower(text);
  if (name == "raw") return ImageEncoding::kRaw;
  if (name == "gz" || name == "gzip") return ImageEncoding::kDeflate;
  if (name == "txt" || name == "text" || name == "ascii") return ImageEncoding::kText;
  refuse_contents(absl::StrCat("its encoding is ", quoted_text(text),
                               ", and raw, gzip and ascii are read: write it again with one"));
}

bool is_big_endian(const NrrdFields& fields, const ImageArray& array) {
  const bool matters = bytes_of(array.type) > 1 && array.encoding != ImageEncoding::kText;
  const std::string* endian = fields.find("endian");
  if (endian == nullptr) {
    if (matters) refuse_image("its header has no field 'endian'");
    return false;
  }
  if (*endian != "little" && *endian != "big") {
    refuse_image(absl::StrCat("its endian is ", quoted_text(*endian)));
  }
  return *endian == "big";
}

/// All but where the data are.
ImageArray read_array(const NrrdFields& fields, ImageSpace& space) {
  ImageArray array;
  array.name = "image";
  array.type = nrrd_type(fields.get("type"));
  array.encoding = encoding_of(fields.get("encoding"));
  array.big_endian = is_big_endian(fields, array);
  const std::vector<std::int64_t> sizes = sizes_of(fields);
  Axes axes = fields.find("space directions") != nullptr ? directed_axes(fields, sizes)
                                                         : plain_axes(fields, sizes);
  set_size(axes.sizes, array);
  set_space(fields, axes, space);
  set_axes(axes.steps, axes.origin, array);
  return array;
}

std::int64_t skip_of(const NrrdFields& fields, const char* name) {
  const std::string* skip = fields.find(name);
  return skip == nullptr ? 0 : integer_of(*skip, name);
}

}  // namespace

ImageOutline read_nrrd_header(std::span<const std::byte> head, std::uint64_t file_bytes) {
  const NrrdFields fields = read_nrrd_fields(head);
  if (fields.find("data file") != nullptr) {
    refuse_contents(
        "its data are in another file: join them, as tetstream does with a header "
        "that it is given on the command line");
  }
  ImageOutline outline;
  outline.format = ImageFormat::kNrrd;
  ImageArray array = read_array(fields, outline.space);
  if (skip_of(fields, "byte skip") != 0 || skip_of(fields, "line skip") != 0) {
    refuse_contents(
        "it skips bytes before its data, though they follow its header: write it "
        "without 'byte skip' and 'line skip'");
  }
  set_attached_data(fields.end, file_bytes, array);
  outline.arrays.push_back(std::move(array));
  return outline;
}

bool is_detached_nrrd(std::span<const std::byte> head) {
  return is_nrrd(head) && read_nrrd_fields(head).find("data file") != nullptr;
}

DetachedHeader read_detached_nrrd(std::span<const std::byte> head) {
  const NrrdFields fields = read_nrrd_fields(head);
  ImageSpace space;
  const ImageArray array = read_array(fields, space);
  const std::string& file = fields.get("data file");
  DetachedHeader header;
  if (file.empty()) refuse_image("its data file has no name");
  if (absl::StartsWith(file, "LIST")) {
    header.files = fields.listed_files;
    if (header.files.empty()) refuse_image("its list of data files is empty");
  } else if (file.find('%') != std::string::npos) {
    header.files = numbered_files(file);
  } else {
    header.files = {file};
  }
  const std::int64_t skip = skip_of(fields, "byte skip");
  if (skip < -1 || skip_of(fields, "line skip") != 0) {
    refuse_contents("it skips lines of its data: write it with 'byte skip' alone");
  }
  header.skip_to_last = skip == -1;
  header.skip_bytes = skip > 0 ? static_cast<std::uint64_t>(skip) : 0;
  const bool raw = array.encoding == ImageEncoding::kRaw;
  if (skip != 0 && !raw) {
    // By the format these are bytes of what the file unpacks to.
    refuse_contents(
        absl::StrFormat("%d bytes of its packed data are to be skipped ('byte skip'): unpack "
                        "them, or pack them "
                        "without those",
                        skip));
  }
  if (header.files.size() > 1 && !raw) {
    refuse_contents("its data are packed in several files: write them to one");
  }
  header.data_bytes = raw ? array.value_bytes() : 0;
  header.attached = absl::StrCat(fields.attached, "\n");
  return header;
}

}  // namespace tet
