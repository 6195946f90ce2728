#include "core/triangle_files/ply_header.h"

#include <algorithm>
#include <array>
#include <utility>

#include <absl/status/status.h>
#include <absl/strings/str_format.h>

#include "core/triangle_files/surface_reading.h"

namespace tet {
namespace {

std::optional<PlyType> parse_type(std::string_view word) {
  static constexpr std::array<std::pair<std::string_view, PlyType>, 18> kTypes{{
      {"char", {PlyType::kSigned, 1}},
      {"int8", {PlyType::kSigned, 1}},
      {"uchar", {PlyType::kUnsigned, 1}},
      {"uint8", {PlyType::kUnsigned, 1}},
      {"short", {PlyType::kSigned, 2}},
      {"int16", {PlyType::kSigned, 2}},
      {"ushort", {PlyType::kUnsigned, 2}},
      {"uint16", {PlyType::kUnsigned, 2}},
      {"int", {PlyType::kSigned, 4}},
      {"int32", {PlyType::kSigned, 4}},
      {"uint", {PlyType::kUnsigned, 4}},
      {"uint32", {PlyType::kUnsigned, 4}},
      {"int64", {PlyType::kSigned, 8}},
      {"uint64", {PlyType::kUnsigned, 8}},
      {"float", {PlyType::kFloat, 4}},
      {"float32", {PlyType::kFloat, 4}},
      {"double", {PlyType::kFloat, 8}},
      {"float64", {PlyType::kFloat, 8}},
  }};
  const auto* const found = std::find_if(kTypes.begin(), kTypes.end(),
                                         [&](const auto& type) { return type.first == word; });
  if (found == kTypes.end()) return std::nullopt;
  return found->second;
}

absl::Status bad(std::string_view what, std::string_view word) {
  return absl::InvalidArgumentError(absl::StrFormat("%s '%s'", what, word));
}

absl::Status parse_format(std::string_view words, PlyHeader& header) {
  const std::string_view word = take_word(words);
  if (word == "ascii") {
    header.format = PlyFormat::kAscii;
  } else if (word == "binary_little_endian") {
    header.format = PlyFormat::kLittleEndian;
  } else if (word == "binary_big_endian") {
    header.format = PlyFormat::kBigEndian;
  } else {
    return bad("unknown format", word);
  }
  return absl::OkStatus();
}

absl::Status parse_element(std::string_view words, PlyHeader& header) {
  PlyElement element;
  element.name = take_word(words);
  const std::string_view word = take_word(words);
  std::int64_t count = 0;
  if (!parse_number(word, count) || count < 0) return bad("not a count of elements:", word);
  element.count = static_cast<std::uint64_t>(count);
  header.elements.push_back(std::move(element));
  return absl::OkStatus();
}

absl::Status parse_property(std::string_view words, PlyHeader& header) {
  if (header.elements.empty()) return bad("no element before the property", words);
  PlyProperty property;
  std::string_view word = take_word(words);
  if (word == "list") {
    word = take_word(words);
    property.count_type = parse_type(word);
    if (!property.count_type) return bad("unknown type", word);
    if (property.count_type->kind == PlyType::kFloat) return bad("a count cannot be", word);
    word = take_word(words);
  }
  const std::optional<PlyType> type = parse_type(word);
  if (!type) return bad("unknown type", word);
  property.type = *type;
  property.name = take_word(words);
  header.elements.back().properties.push_back(std::move(property));
  return absl::OkStatus();
}

absl::Status parse_line(std::string_view keyword, std::string_view words, PlyHeader& header) {
  if (keyword == "format") return parse_format(words, header);
  if (keyword == "element") return parse_element(words, header);
  if (keyword == "property") return parse_property(words, header);
  const bool says_nothing = keyword.empty() || keyword == "comment" || keyword == "obj_info";
  if (says_nothing) return absl::OkStatus();
  return bad("unknown keyword", keyword);
}

}  // namespace

absl::StatusOr<PlyHeader> read_ply_header(std::string_view bytes) {
  PlyHeader header;
  if (absl::Status s = check_not_utf16(bytes); !s.ok()) return s;
  LineReader lines(without_byte_order_mark(bytes));
  std::string_view first = lines.next() ? lines.line() : std::string_view();
  if (take_word(first) != "ply" || !take_word(first).empty()) {
    return line_error(1, "the first line is not 'ply'");
  }
  const bool ends_with_return = lines.line_end() == "\r";
  while (lines.next()) {
    std::string_view words = lines.line();
    const std::string_view keyword = take_word(words);
    if (keyword == "end_header") {
      header.body = bytes.size() - lines.rest().size();
      // Where \r ends every line, \n is the first byte of the body.
      if (ends_with_return && lines.line_end() == "\r\n") --header.body;
      for (const PlyElement& element : header.elements) {
        if (element.properties.empty()) return bad("no properties in element", element.name);
      }
      return header;
    }
    const absl::Status status = parse_line(keyword, words, header);
    if (!status.ok()) return line_error(lines.number(), std::string(status.message()));
  }
  return line_error(lines.number(), "the header does not end");
}

}  // namespace tet
