#include "core/image/nrrd_fields.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/image/header_numbers.h"
#include "core/image/image_refusal.h"
#include "core/image/nrrd_header.h"
#include "core/image/text_header.h"

namespace tet {
namespace {

constexpr std::string_view kNrrdMagic = "NRRD000";

/// Other names of fields.
constexpr std::pair<std::string_view, std::string_view> kOtherNames[] = {
    {"datafile", "data file"},       {"byteskip", "byte skip"},
    {"lineskip", "line skip"},       {"axismins", "axis mins"},
    {"axismaxs", "axis maxs"},       {"centerings", "centers"},
    {"spaceunits", "space units"},   {"spacedirections", "space directions"},
    {"spaceorigin", "space origin"},
};

std::string field_name(std::string_view text) {
  std::string name = absl::AsciiStrToLower(as_absl(trimmed(text)));
  for (const auto& [other, own] : kOtherNames) {
    if (name == other) return std::string(own);
  }
  return name;
}

bool is_about_files(std::string_view name) {
  return name == "data file" || name == "byte skip" || name == "line skip";
}

void read_line(std::string_view line, NrrdFields& fields) {
  const std::size_t colon = line.find(": ");
  const std::size_t pair = line.find(":=");
  const bool is_pair =
      pair != std::string_view::npos && (colon == std::string_view::npos || pair < colon);
  if (is_pair) {
    absl::StrAppend(&fields.attached, as_absl(line), "\n");
    return;  // what a program says to itself
  }
  const std::size_t end = colon != std::string_view::npos ? colon : line.find(':');
  if (end == std::string_view::npos) {
    refuse_image(absl::StrCat("its header has the line ", quoted_text(line),
                              ", which is neither a field nor a comment"));
  }
  const std::string name = field_name(line.substr(0, end));
  const std::string value(trimmed(line.substr(end + 1)));
  if (!is_about_files(name)) absl::StrAppend(&fields.attached, as_absl(line), "\n");
  if (!fields.of.emplace(name, value).second) {
    refuse_image(absl::StrCat("its header has the field ", quoted_text(name), " twice"));
  }
}

}  // namespace

const std::string* NrrdFields::find(const std::string& name) const {
  const auto found = of.find(name);
  return found == of.end() ? nullptr : &found->second;
}

const std::string& NrrdFields::get(const std::string& name) const {
  const std::string* value = find(name);
  if (value == nullptr) refuse_image(absl::StrCat("its header has no field '", name, "'"));
  return *value;
}

bool is_nrrd(std::span<const std::byte> head) noexcept {
  return head.size() > kNrrdMagic.size() &&
         std::equal(kNrrdMagic.begin(), kNrrdMagic.end(), head.begin(),
                    [](char a, std::byte b) { return static_cast<std::byte>(a) == b; });
}

NrrdFields read_nrrd_fields(std::span<const std::byte> head) {
  HeaderLines lines(head.first(std::min(head.size(), kTextHeaderBytes)));
  NrrdFields fields;
  bool lists = false;
  while (const auto line = lines.next()) {
    fields.end = lines.position();
    if (lists) {
      if (!line->empty()) fields.listed_files.emplace_back(*line);
      continue;
    }
    if (line->empty()) return fields;
    if (line->starts_with('#') || line->starts_with(kNrrdMagic)) {
      absl::StrAppend(&fields.attached, as_absl(*line), "\n");
      continue;
    }
    read_line(*line, fields);
    const std::string* files = fields.find("data file");
    lists = files != nullptr && absl::StartsWith(*files, "LIST");
  }
  if (fields.find("data file") != nullptr) return fields;
  if (head.size() >= kTextHeaderBytes) {
    refuse_image(absl::StrFormat("its header has no end within %d bytes", kTextHeaderBytes));
  }
  refuse_image("it is truncated: its header has no end");
}

std::vector<std::string> numbered_files(const std::string& text) {
  const auto words = words_of(text, 5, "data file");
  const std::string_view pattern = words[0];
  constexpr std::size_t kMostPathBytes = 4096;  // which systems open
  if (pattern.size() > kMostPathBytes) {
    refuse_image(absl::StrFormat("its data file has a name of %d bytes; the limit is %d",
                                 pattern.size(), kMostPathBytes));
  }
  const std::size_t percent = pattern.find('%');
  std::size_t end = percent + 1;
  int width = 0;
  while (end < pattern.size() &&
         absl::ascii_isdigit(static_cast<unsigned char>(pattern[end])) && width < 100) {
    width = 10 * width + (pattern[end++] - '0');
  }
  const bool fits = end < pattern.size() && pattern[end] == 'd' && width < 20 &&
                    pattern.find('%', end) == std::string_view::npos && words.size() >= 4;
  if (!fits) refuse_image(absl::StrCat("its data file is ", quoted_text(text)));
  const std::int64_t first = integer_of(words[1], "data file"),
                     last = integer_of(words[2], "data file"),
                     step = integer_of(words[3], "data file");
  constexpr std::int64_t kMostFiles = 100'000;
  const bool counts = step != 0 && first >= 0 && last >= 0 && first < kMostFiles &&
                      last < kMostFiles && std::abs(step) < kMostFiles &&
                      (last - first) / step < kMostFiles && (last - first) / step >= 0;
  if (!counts) refuse_image(absl::StrCat("its data file counts from ", first, " to ", last));
  std::vector<std::string> files;
  for (std::int64_t i = first; step > 0 ? i <= last : i >= last; i += step) {
    const bool with_zeros = pattern[percent + 1] == '0';
    const std::string number =
        with_zeros ? absl::StrFormat("%0*d", width, i) : absl::StrFormat("%*d", width, i);
    files.push_back(absl::StrCat(as_absl(pattern.substr(0, percent)), number,
                                 as_absl(pattern.substr(end + 1))));
  }
  return files;
}

}  // namespace tet
