#include "proto/scene/message_parts.h"

#include <absl/strings/str_cat.h>

namespace tet {

std::string in_one_line(const std::string& message) {
  const std::size_t end = message.find('\n');
  if (end == std::string::npos) return message;
  const std::size_t place_end = message.find('\n', end + 1);
  return absl::StrCat(message.substr(0, end),
                      " Near: ", message.substr(end + 1, place_end - end - 1));
}

}  // namespace tet
