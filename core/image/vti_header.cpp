#include "core/image/vti_header.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/base/utf8.h"
#include "core/image/header_numbers.h"
#include "core/image/image_refusal.h"
#include "core/image/text_header.h"
#include "core/image/xml_tags.h"

namespace tet {
namespace {

constexpr std::size_t kMostArrays = 1024, kMostNameBytes = 1024;

constexpr std::pair<std::string_view, ScalarType> kVtkTypes[] = {
    {"Int8", ScalarType::kInt8},       {"UInt8", ScalarType::kUint8},
    {"Int16", ScalarType::kInt16},     {"UInt16", ScalarType::kUint16},
    {"Int32", ScalarType::kInt32},     {"UInt32", ScalarType::kUint32},
    {"Int64", ScalarType::kInt64},     {"UInt64", ScalarType::kUint64},
    {"Float32", ScalarType::kFloat32}, {"Float64", ScalarType::kFloat64},
};

const std::string& attribute(const XmlTag& tag, std::string_view name) {
  const std::string* value = tag.find(name);
  if (value == nullptr)
    refuse_image(absl::StrCat("its tag ", as_absl(tag.name), " has no ", as_absl(name)));
  return *value;
}

/// First and last points along each axis.
using Extent = std::array<std::int64_t, 6>;

Extent extent_of(const std::string& text) {
  const auto words = words_of(text, 6, "extent");
  if (words.size() != 6) refuse_image(absl::StrCat("its extent is ", quoted_text(text)));
  Extent extent{};
  for (std::size_t i = 0; i < 6; ++i) {
    extent[i] = integer_of(words[i], "extent");
    if (std::abs(extent[i]) > std::numeric_limits<std::int32_t>::max()) {
      refuse_image(absl::StrCat("its extent is ", quoted_text(text)));
    }
  }
  return extent;
}

class VtiReader {
 public:
  VtiReader(std::string_view text, std::uint64_t file_bytes)
      : text_(text), file_bytes_(file_bytes) {}

  ImageOutline read() {
    outline_.format = ImageFormat::kVti;
    bool appended = false;
    // What follows the tag of appended data is theirs, and no XML.
    for (std::size_t at = 0; !appended && !ends_;) {
      const std::optional<XmlTag> tag = next_tag(text_, at);
      if (!tag) break;
      take(*tag);
      at = tag->end;
      appended = tag->name == "AppendedData";
    }
    outline_.cut = !appended && !ends_;
    const bool whole = text_.size() == file_bytes_;
    if (outline_.cut && whole) refuse_image("it is truncated: its XML has no end");
    if (!extent_) refuse_image("its XML has no ImageData");
    place_appended();
    if (!outline_.cut) {
      for (const ImageArray& array : outline_.arrays) {
        if (array.components == 1) check_claim(array);
      }
    }
    if (outline_.arrays.empty() && !outline_.cut) {
      refuse_contents("it has no array of numbers, at points or at cells");
    }
    return std::move(outline_);
  }

 private:
  void take(const XmlTag& tag) {
    if (tag.closes) {
      if (tag.name == "VTKFile") ends_ = true;
      if (tag.name == "PointData" || tag.name == "CellData") at_.reset();
      return;
    }
    if (tag.name == "VTKFile") return take_file(tag);
    if (tag.name == "ImageData") return take_image(tag);
    if (tag.name == "Piece") return take_piece(tag);
    if (tag.name == "PointData" || tag.name == "CellData") {
      if (!tag.closes_itself) at_ = tag.name == "PointData";
      return;
    }
    if (tag.name == "DataArray" && at_) return take_array(tag);
    if (tag.name == "AppendedData") take_appended(tag);
  }

  void take_file(const XmlTag& tag) {
    if (attribute(tag, "type") != "ImageData") {
      refuse_contents(absl::StrCat("it is VTK's ", quoted_text(attribute(tag, "type")),
                                   ", and of VTK's files only ImageData is read"));
    }
    const std::string& order = attribute(tag, "byte_order");
    if (order != "LittleEndian" && order != "BigEndian") {
      refuse_image(absl::StrCat("its byte_order is ", quoted_text(order)));
    }
    big_endian_ = order == "BigEndian";
    if (const std::string* lengths = tag.find("header_type")) {
      if (*lengths != "UInt32" && *lengths != "UInt64") {
        refuse_image(absl::StrCat("its header_type is ", quoted_text(*lengths)));
      }
      length_bytes_ = *lengths == "UInt64" ? 8 : 4;
    }
    const std::string* compressor = tag.find("compressor");
    if (compressor == nullptr || compressor->empty()) return;
    if (*compressor != "vtkZLibDataCompressor") {
      refuse_contents(absl::StrCat("it is compressed by ", quoted_text(*compressor),
                                   ", and only vtkZLibDataCompressor is read: set that"));
    }
    deflated_ = true;
  }

  void take_image(const XmlTag& tag) {
    extent_ = extent_of(attribute(tag, "WholeExtent"));
    origin_ = triple_of(attribute(tag, "Origin"), "Origin");
    const Triple spacing = triple_of(attribute(tag, "Spacing"), "Spacing");
    std::array<double, 9> direction{1, 0, 0, 0, 1, 0, 0, 0, 1};
    if (const std::string* text = tag.find("Direction")) {
      const auto words = words_of(*text, 9, "Direction");
      if (words.size() != 9) refuse_image("its Direction has not 9 numbers");
      for (std::size_t i = 0; i < 9; ++i) direction[i] = number_of(words[i], "Direction");
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t row = 0; row < 3; ++row) {
        steps_[axis][row] = direction[3 * row + axis] * spacing[axis];
      }
    }
  }

  void take_piece(const XmlTag& tag) {
    if (!extent_) refuse_image("its XML has a Piece outside ImageData");
    if (has_piece_ || extent_of(attribute(tag, "Extent")) != *extent_) {
      refuse_contents("it is in several pieces: write it in one");
    }
    has_piece_ = true;
  }

  void take_array(const XmlTag& tag) {
    if (!extent_) refuse_image("its XML has a DataArray outside ImageData");
    if (outline_.arrays.size() == kMostArrays) refuse_image("it has more than 1024 arrays");
    ImageArray array;
    const std::string& type = attribute(tag, "type");
    const auto* known =
        std::ranges::find_if(kVtkTypes, [&](const auto& t) { return t.first == type; });
    if (known == std::end(kVtkTypes)) return;  // texts and bits are no numbers
    array.type = known->second;
    array.big_endian = big_endian_;
    array.length_bytes = length_bytes_;
    array.blocks_deflated = deflated_;
    const std::string* components = tag.find("NumberOfComponents");
    const std::int64_t count =
        components == nullptr ? 1 : integer_of(*components, "NumberOfComponents");
    if (count < 1 || count > 1'000'000) refuse_image("an array has too many components");
    array.components = static_cast<std::uint32_t>(count);
    array.name = name_of(tag);
    set_place(array);
    set_data(tag, array);
    outline_.arrays.push_back(std::move(array));
    at_points_.push_back(*at_);
  }

  /// The array that was taken with that name, if there is one.
  std::optional<std::size_t> find_taken(const std::string& name) const {
    for (std::size_t i = 0; i < outline_.arrays.size(); ++i) {
      if (outline_.arrays[i].name == name) return i;
    }
    return std::nullopt;
  }

  /// Its name, in UTF-8. Points and cells may each have an array of the same name: the second
  /// one is told apart by where it is.
  std::string name_of(const XmlTag& tag) const {
    const std::string* stored = tag.find("Name");
    std::string name = stored == nullptr || stored->empty() ? "image" : *stored;
    if (name.size() > kMostNameBytes) refuse_image("an array has a name of over 1024 bytes");
    const std::string_view where = *at_ ? "[points]" : "[cells]";
    name = as_utf8(name, kMostNameBytes - where.size());
    std::optional<std::size_t> taken = find_taken(name);
    if (taken && at_points_[*taken] != *at_ && name.size() + where.size() <= kMostNameBytes) {
      name += where;
      taken = find_taken(name);
    }
    if (taken) refuse_image(absl::StrCat("it has two arrays ", quoted_text(name)));
    return name;
  }

  /// Values at cells lie in their middles.
  void set_place(ImageArray& array) const {
    const bool points = *at_;
    std::vector<std::int64_t> sizes;
    Triple first{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      sizes.push_back((*extent_)[2 * axis + 1] - (*extent_)[2 * axis] + (points ? 1 : 0));
      first[axis] = static_cast<double>((*extent_)[2 * axis]) + (points ? 0 : 0.5);
    }
    set_size(sizes, array);
    Triple origin = origin_;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t row = 0; row < 3; ++row) origin[row] += first[axis] * steps_[axis][row];
    }
    set_axes(steps_, origin, array);
  }

  void set_data(const XmlTag& tag, ImageArray& array) const {
    const std::string& format = attribute(tag, "format");
    if (format == "appended") {
      const std::int64_t offset = integer_of(attribute(tag, "offset"), "offset");
      if (offset < 0) refuse_image("an array begins before its data");
      array.encoding = ImageEncoding::kVtiRaw;  // or base64: AppendedData says
      array.offset = static_cast<std::uint64_t>(offset);
      return;
    }
    if (tag.closes_itself) refuse_image(absl::StrCat(quoted_text(array.name), " has no data"));
    if (format != "ascii" && format != "binary") {
      refuse_image(absl::StrCat("an array has the format ", quoted_text(format)));
    }
    array.encoding = format == "ascii" ? ImageEncoding::kText : ImageEncoding::kVtiBase64;
    array.offset = tag.end;
    const std::size_t end = text_.find('<', tag.end);
    array.bytes = (end == std::string_view::npos ? text_.size() : end) - tag.end;
    inline_.push_back(outline_.arrays.size());
  }

  void take_appended(const XmlTag& tag) {
    const std::string& encoding = attribute(tag, "encoding");
    if (encoding != "raw" && encoding != "base64") {
      refuse_image(absl::StrCat("its appended data are ", quoted_text(encoding)));
    }
    appended_base64_ = encoding == "base64";
    const std::size_t begin = text_.find('_', tag.end);
    if (begin == std::string_view::npos || begin > tag.end + 4096) {
      refuse_image("its appended data have no beginning");
    }
    appended_ = begin + 1;
  }

  void place_appended() {
    for (std::size_t i = 0; i < outline_.arrays.size(); ++i) {
      ImageArray& array = outline_.arrays[i];
      if (std::ranges::binary_search(inline_, i)) continue;
      if (!appended_) {
        if (outline_.cut) continue;
        refuse_image("an array's data are appended, and there are no appended data");
      }
      if (array.offset >= file_bytes_ - *appended_) {
        refuse_image(absl::StrCat("it is truncated: ", quoted_text(array.name),
                                  " begins beyond its end"));
      }
      array.offset += *appended_;
      array.bytes = file_bytes_ - array.offset;
      if (appended_base64_) array.encoding = ImageEncoding::kVtiBase64;
    }
  }

  std::string_view text_;
  const std::uint64_t file_bytes_;
  ImageOutline outline_;
  bool big_endian_ = false, deflated_ = false, has_piece_ = false, ends_ = false;
  bool appended_base64_ = false;
  std::uint32_t length_bytes_ = 4;
  std::optional<Extent> extent_;
  Triple origin_{};
  std::array<Triple, 3> steps_{};
  std::optional<bool> at_;       // points, or else cells, whose arrays follow
  std::vector<bool> at_points_;  // of the arrays so far
  std::optional<std::uint64_t> appended_;
  mutable std::vector<std::size_t> inline_;  // arrays whose data are between tags
};

}  // namespace

bool is_vti(std::span<const std::byte> head) noexcept {
  const std::string_view text(reinterpret_cast<const char*>(head.data()),
                              std::min<std::size_t>(head.size(), 4096));
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos || text[first] != '<') return false;
  return text.find("<VTKFile") != std::string_view::npos;
}

ImageOutline read_vti_header(std::span<const std::byte> head, std::uint64_t file_bytes) {
  return VtiReader({reinterpret_cast<const char*>(head.data()), head.size()}, file_bytes)
      .read();
}

}  // namespace tet
