// What messages that are written by hand have in common: lists of three numbers, and JSON.
#pragma once

#include <array>
#include <cstddef>
#include <string>

#include <absl/status/statusor.h>
#include <absl/strings/str_cat.h>
#include <google/protobuf/util/json_util.h>

namespace tet {

/// Reads a list of three numbers, if there is one. `size has 2 numbers, not 3`; empty if
/// nothing is wrong.
template <class Field, class Number>
std::string read_three(const char* field, const Field& given, std::array<Number, 3>& numbers) {
  if (given.empty()) return "";  // its default, or what is refused later
  if (given.size() != 3) {
    return absl::StrCat(field, " has ", given.size(), " numbers, not 3");
  }
  for (int i = 0; i < 3; ++i) numbers[static_cast<std::size_t>(i)] = given[i];
  return "";
}

/// What protobuf says of JSON in one line: its second and third line point at a place.
std::string in_one_line(const std::string& message);

/// Errors: kInvalidArgument (not a `what`; says where).
template <class Message>
absl::StatusOr<Message> message_from_json(const std::string& json, const char* what) {
  Message message;
  const auto status = google::protobuf::util::JsonStringToMessage(json, &message);
  if (status.ok()) return message;
  return absl::InvalidArgumentError(
      absl::StrCat("is not a ", what, ": ", in_one_line(std::string(status.message()))));
}

}  // namespace tet
