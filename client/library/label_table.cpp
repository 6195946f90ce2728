#include "client/library/label_table.h"

#include <cstdint>
#include <limits>
#include <set>
#include <string_view>

#include <absl/strings/ascii.h>
#include <absl/strings/escaping.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_split.h>
#include <nlohmann/json.hpp>

#include "core/mesh/tet_mesh.h"

namespace tet {
namespace {

/// Gathers names, and refuses what could not be told in a file.
class NamesOfTable {
 public:
  /// `where` says which line or member it is.
  absl::Status add(std::int64_t value, const std::string& name, const std::string& where) {
    if (!is_label_name(name)) {
      return absl::InvalidArgumentError(absl::StrFormat(
          "%s: \"%s\" cannot name a label: it takes UTF-8 of 1 to %d bytes without control "
          "characters",
          where, absl::CHexEscape(name.substr(0, kMaxLabelNameBytes)), kMaxLabelNameBytes));
    }
    if (!values_.insert(value).second) {
      return absl::InvalidArgumentError(
          absl::StrFormat("%s: label %d has a name already", where, value));
    }
    names_.push_back({value, name});
    return absl::OkStatus();
  }
  std::vector<LabelName> take() { return std::move(names_); }

 private:
  std::set<std::int64_t> values_;
  std::vector<LabelName> names_;
};

absl::Status no_label_line(const std::string& where, const std::string& line) {
  return absl::InvalidArgumentError(absl::StrFormat(
      "%s: \"%s\" is no label: it takes `7 bone 255 0 0 255`, as 3D Slicer has it, or `7 255 0 "
      "0 1 1 1 \"bone\"`, as ITK-SNAP",
      where, absl::CHexEscape(line.substr(0, 60))));
}

absl::Status add_line(const std::string& line, const std::string& where, NamesOfTable& names) {
  const std::vector<std::string> words =
      absl::StrSplit(line, absl::ByAnyChar(" \t"), absl::SkipEmpty());
  std::int64_t value = 0;
  if (words.size() < 2 || !absl::SimpleAtoi(words[0], &value)) {
    return no_label_line(where, line);
  }
  const std::size_t quote = line.find('"'), last = line.rfind('"');
  if (quote == std::string::npos) return names.add(value, words[1], where);
  if (quote == last) return no_label_line(where, line);
  return names.add(value, line.substr(quote + 1, last - quote - 1), where);
}

absl::StatusOr<std::vector<LabelName>> parse_lines(const std::string& text) {
  NamesOfTable names;
  std::size_t number = 0;
  const std::vector<std::string> lines = absl::StrSplit(text, '\n');
  for (const std::string& each : lines) {
    const std::string line(absl::StripAsciiWhitespace(each));
    ++number;
    if (line.empty() || line.front() == '#') continue;
    if (auto status = add_line(line, absl::StrCat("line ", number), names); !status.ok()) {
      return status;
    }
  }
  return names.take();
}

absl::Status add_member(const nlohmann::json& value,
                        const nlohmann::json& name,
                        const std::string& where,
                        NamesOfTable& names) {
  std::int64_t number = 0;
  // A number beyond 64 bits with a sign would become another label's.
  const bool is_too_large =
      value.is_number_unsigned() &&
      value.get<std::uint64_t>() > std::uint64_t{std::numeric_limits<std::int64_t>::max()};
  const bool is_number = value.is_number_integer() && !is_too_large;
  if (is_number) number = value.get<std::int64_t>();
  const bool is_text = value.is_string() && absl::SimpleAtoi(value.get<std::string>(), &number);
  if (!(is_number || is_text) || !name.is_string()) {
    return absl::InvalidArgumentError(absl::StrCat(
        where, " is no label: it takes {\"7\": \"bone\"} or [{\"value\": 7, \"name\": ",
        "\"bone\"}]"));
  }
  return names.add(number, name.get<std::string>(), where);
}

absl::StatusOr<std::vector<LabelName>> parse_json(const std::string& text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (json.is_discarded()) return absl::InvalidArgumentError("it is no JSON");
  NamesOfTable names;
  std::size_t number = 0;
  for (const auto& [key, member] : json.items()) {
    const std::string where = absl::StrCat("member ", number++);
    const bool has_both = json.is_array() && member.is_object() && member.contains("value") &&
                          member.contains("name");
    const absl::Status status =
        has_both ? add_member(member["value"], member["name"], where, names)
                 : add_member(json.is_object() ? nlohmann::json(key) : nlohmann::json(), member,
                              where, names);
    if (!status.ok()) return status;
  }
  return names.take();
}

}  // namespace

absl::StatusOr<std::vector<LabelName>> parse_label_table(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  const bool is_json = first != std::string::npos && (text[first] == '{' || text[first] == '[');
  return is_json ? parse_json(text) : parse_lines(text);
}

}  // namespace tet
