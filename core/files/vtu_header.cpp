#include "core/files/vtu_header.h"

#include <algorithm>
#include <array>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/escaping.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_replace.h>

#include "core/base/utf8.h"

namespace tet {
namespace {

constexpr std::size_t kMaxArrays = 256, kMaxNameBytes = 256;
constexpr std::uint32_t kMaxComponents = 64;
constexpr const char* kRemedy =
    "; tetstream reads what it writes itself: one piece, with raw appended data (in ParaView: "
    "Data Mode Appended, Encode Appended Data off, Compressor None)";

constexpr std::array<std::pair<const char*, std::size_t>, 10> kVtuTypes{{{"Int8", 1},
                                                                         {"UInt8", 1},
                                                                         {"Int16", 2},
                                                                         {"UInt16", 2},
                                                                         {"Int32", 4},
                                                                         {"UInt32", 4},
                                                                         {"Int64", 8},
                                                                         {"UInt64", 8},
                                                                         {"Float32", 4},
                                                                         {"Float64", 8}}};

absl::Status wrong(const std::string& why) { return absl::InvalidArgumentError(why); }

std::string shown(std::string_view text) {
  constexpr std::size_t kMost = 64;
  return absl::StrCat("\"", absl::CHexEscape(std::string(text.substr(0, kMost))), "\"");
}

/// A tag of the XML: its name, with / in front of one that ends, and its attributes.
struct Tag {
  std::string_view name;
  std::vector<std::pair<std::string_view, std::string_view>> attributes;

  std::optional<std::string_view> find(std::string_view wanted) const {
    for (const auto& [key, value] : attributes) {
      if (key == wanted) return value;
    }
    return std::nullopt;
  }
  std::string_view get(std::string_view wanted) const { return find(wanted).value_or(""); }
};

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

std::string_view take_space(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  return text;
}

/// Reads tags one after the other; text between them is passed over.
class TagReader {
 public:
  explicit TagReader(std::string_view text) : text_(text) {}

  /// Where the next tag begins to be looked for, and where the last one began.
  std::size_t position() const noexcept { return at_; }
  std::size_t begin_of_last() const noexcept { return begin_; }

  absl::StatusOr<Tag> next() {
    const std::size_t begin = text_.find('<', at_);
    if (begin == std::string_view::npos) return wrong("its XML has no end");
    const std::size_t end = end_of_tag(begin);
    if (end == std::string_view::npos) return wrong("a tag of its XML has no end");
    begin_ = begin;
    at_ = end + 1;
    return parse(text_.substr(begin + 1, end - begin - 1));
  }

 private:
  /// The first > that is not in quotes.
  std::size_t end_of_tag(std::size_t begin) const {
    char quote = 0;
    for (std::size_t i = begin; i < text_.size(); ++i) {
      const char c = text_[i];
      if (quote != 0) {
        if (c == quote) quote = 0;
      } else if (c == '"' || c == '\'') {
        quote = c;
      } else if (c == '>') {
        return i;
      }
    }
    return std::string_view::npos;
  }

  static absl::StatusOr<Tag> parse(std::string_view text) {
    Tag tag;
    const auto ends_name = [](char c) { return is_space(c); };
    const auto name_end = std::ranges::find_if(text, ends_name);
    tag.name = text.substr(0, static_cast<std::size_t>(name_end - text.begin()));
    if (tag.name.ends_with('/')) tag.name.remove_suffix(1);
    if (tag.name.starts_with('?') || tag.name.starts_with('!')) return tag;
    std::string_view rest = text.substr(tag.name.size());
    for (rest = take_space(rest); !rest.empty() && rest != "/"; rest = take_space(rest)) {
      const std::size_t equals = rest.find('=');
      if (equals == std::string_view::npos || equals + 1 >= rest.size()) {
        return wrong(absl::StrCat("its tag ", shown(text), " is no XML"));
      }
      std::string_view key = rest.substr(0, equals);
      while (!key.empty() && is_space(key.back())) key.remove_suffix(1);
      rest = take_space(rest.substr(equals + 1));
      const char quote = rest.empty() ? '\0' : rest.front();
      const std::size_t end = rest.size() > 1 ? rest.find(quote, 1) : std::string_view::npos;
      if ((quote != '"' && quote != '\'') || end == std::string_view::npos) {
        return wrong(absl::StrCat("its tag ", shown(text), " is no XML"));
      }
      tag.attributes.emplace_back(key, rest.substr(1, end - 1));
      rest.remove_prefix(end + 1);
    }
    return tag;
  }

  std::string_view text_;
  std::size_t begin_ = 0, at_ = 0;
};

template <class Number>
absl::StatusOr<Number> number_of(const Tag& tag, std::string_view attribute) {
  Number value = 0;
  const std::string text(tag.get(attribute));
  if (absl::SimpleAtoi(text, &value)) return value;
  return wrong(absl::StrCat("its ", std::string(tag.name), " has ", std::string(attribute), " ",
                            shown(text), ", which is no count"));
}

std::string array_name(const Tag& tag) {
  return absl::StrReplaceAll(
      std::string(tag.get("Name")),
      {{"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&apos;", "'"}, {"&amp;", "&"}});
}

absl::StatusOr<VtuColumn> column_of(const Tag& tag) {
  VtuColumn column;
  column.name = array_name(tag);
  if (column.name.size() > kMaxNameBytes || !is_utf8(column.name)) {
    return wrong(absl::StrCat("its array ", shown(column.name),
                              " has a name that is no UTF-8 of ", kMaxNameBytes,
                              " bytes at most"));
  }
  const std::string_view type = tag.get("type");
  const auto* const found =
      std::ranges::find_if(kVtuTypes, [&](const auto& each) { return type == each.first; });
  if (found == kVtuTypes.end()) {
    return wrong(absl::StrCat("its array ", shown(column.name), " is of type ", shown(type)));
  }
  column.type = static_cast<NumberType>(found - kVtuTypes.begin());
  if (tag.get("format") != "appended") {
    return wrong(absl::StrCat("its array ", shown(column.name), " has the format ",
                              shown(tag.get("format")), kRemedy));
  }
  const absl::StatusOr<std::uint64_t> offset = number_of<std::uint64_t>(tag, "offset");
  if (!offset.ok()) return offset.status();
  column.offset = *offset;
  if (!tag.find("NumberOfComponents")) return column;
  const auto components = number_of<std::uint32_t>(tag, "NumberOfComponents");
  if (!components.ok()) return components.status();
  if (*components < 1 || *components > kMaxComponents) {
    return wrong(absl::StrCat("its array ", shown(column.name), " has ", *components,
                              " components; 1 to ", kMaxComponents, " are read"));
  }
  column.components = *components;
  return column;
}

absl::Status check_file_tag(const Tag& tag, VtuHeader& header) {
  if (tag.get("type") != "UnstructuredGrid") {
    return wrong(
        absl::StrCat("it has a ", shown(tag.get("type")), ", not an UnstructuredGrid"));
  }
  if (tag.get("byte_order") != "LittleEndian") {
    return wrong(absl::StrCat("its byte order is ", shown(tag.get("byte_order")), kRemedy));
  }
  if (tag.find("compressor")) return wrong(absl::StrCat("it is compressed", kRemedy));
  const std::string_view sizes = tag.find("header_type").value_or("UInt32");
  if (sizes != "UInt32" && sizes != "UInt64") {
    return wrong(absl::StrCat("its header_type is ", shown(sizes), kRemedy));
  }
  header.size_bytes = sizes == "UInt64" ? 8 : 4;
  return absl::OkStatus();
}

/// Reads a file's XML, tag by tag.
class HeaderParser {
 public:
  explicit HeaderParser(std::string_view text) : text_(text), tags_(text) {}

  absl::StatusOr<VtuHeader> parse() {
    while (true) {
      const absl::StatusOr<Tag> tag = tags_.next();
      if (!tag.ok()) return tag.status();
      if (tag->name == "AppendedData") return end(*tag);
      if (auto status = take(*tag); !status.ok()) return status;
    }
  }

 private:
  absl::Status take(const Tag& tag) {
    if (tag.name == "VTKFile") {
      is_vtk_ = true;
      return check_file_tag(tag, header_);
    }
    if (!is_vtk_ && !tag.name.starts_with('?') && !tag.name.starts_with('!')) {
      return wrong("it does not begin with a VTKFile");
    }
    if (tag.name == "Piece") return take_piece(tag);
    if (tag.name == "/DataArray") keep_text();
    if (tag.name == "DataArray") return take_array(tag);
    static constexpr std::array kSections{"Points", "Cells", "PointData", "CellData",
                                          "FieldData"};
    if (std::ranges::find(kSections, tag.name) != kSections.end()) {
      section_ = tag.name;
      text_begin_.reset();
    }
    return absl::OkStatus();
  }

  absl::Status take_piece(const Tag& tag) {
    if (std::exchange(has_piece_, true)) {
      return wrong(absl::StrCat("it has several pieces", kRemedy));
    }
    const auto points = number_of<std::uint64_t>(tag, "NumberOfPoints");
    if (!points.ok()) return points.status();
    const auto cells = number_of<std::uint64_t>(tag, "NumberOfCells");
    if (!cells.ok()) return cells.status();
    header_.points = *points;
    header_.cells = *cells;
    return absl::OkStatus();
  }

  absl::Status take_array(const Tag& tag) {
    if (section_ == "FieldData") return take_whole_array(tag);
    absl::StatusOr<VtuColumn> column = column_of(tag);
    if (!column.ok()) return column.status();
    if (section_ == "Points") return set(header_.places, *std::move(column));
    if (section_ == "Cells") {
      if (column->name == "connectivity") return set(header_.connectivity, *std::move(column));
      if (column->name == "offsets") return set(header_.offsets, *std::move(column));
      if (column->name == "types") return set(header_.types, *std::move(column));
      return wrong(absl::StrCat("its cells have an array ", shown(column->name),
                                ": only tets are read"));
    }
    if (section_ == "PointData") return add(header_.point_data, *std::move(column));
    if (section_ == "CellData") return add(header_.cell_data, *std::move(column));
    return wrong("it has an array that belongs to nothing");
  }

  /// One that is text is kept as it stands, once its end is found.
  absl::Status take_whole_array(const Tag& tag) {
    text_begin_.reset();
    if (tag.get("format") == "ascii") {
      text_begin_ = tags_.begin_of_last();
    } else if (header_.of_whole.left_out.size() < kMaxArrays) {
      header_.of_whole.left_out.push_back(array_name(tag));
    }
    return absl::OkStatus();
  }

  void keep_text() {
    const auto begin = std::exchange(text_begin_, std::nullopt);
    if (!begin) return;
    const std::string array(text_.substr(*begin, tags_.position() - *begin));
    absl::StrAppend(&header_.of_whole.text, "      ", array, "\n");
  }

  static absl::Status set(std::optional<VtuColumn>& place, VtuColumn column) {
    if (place) return wrong(absl::StrCat("it has two arrays ", shown(column.name)));
    place = std::move(column);
    return absl::OkStatus();
  }

  static absl::Status add(std::vector<VtuColumn>& columns, VtuColumn column) {
    if (columns.size() == kMaxArrays) {
      return wrong(absl::StrCat("it has more than ", kMaxArrays, " arrays"));
    }
    const bool is_there = std::ranges::any_of(
        columns, [&](const VtuColumn& other) { return other.name == column.name; });
    if (is_there || column.name.empty()) {
      return wrong(
          absl::StrCat("it has two arrays ", shown(column.name), ", or one without name"));
    }
    columns.push_back(std::move(column));
    return absl::OkStatus();
  }

  absl::StatusOr<VtuHeader> end(const Tag& tag) {
    if (tag.get("encoding") != "raw") {
      return wrong(
          absl::StrCat("its data is encoded as ", shown(tag.get("encoding")), kRemedy));
    }
    const std::size_t mark = text_.find('_', tags_.position());
    if (mark == std::string_view::npos) return wrong("its data does not begin");
    header_.data_start = mark + 1;
    const bool whole = has_piece_ && header_.places && header_.connectivity &&
                       header_.offsets && header_.types;
    if (!whole) return wrong("it lacks a piece, its points, or its cells");
    return std::move(header_);
  }

  std::string_view text_;
  TagReader tags_;
  VtuHeader header_;
  std::string_view section_;
  std::optional<std::size_t> text_begin_;  ///< of an array of text of the whole mesh
  bool is_vtk_ = false, has_piece_ = false;
};

}  // namespace

absl::StatusOr<VtuHeader> parse_vtu_header(std::string_view beginning) {
  return HeaderParser(beginning).parse();
}

std::size_t size_of(NumberType type) noexcept {
  return kVtuTypes[static_cast<std::size_t>(type)].second;
}

const char* vtu_name_of(NumberType type) noexcept {
  return kVtuTypes[static_cast<std::size_t>(type)].first;
}

}  // namespace tet
