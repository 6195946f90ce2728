#include "client/library/text_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include <absl/strings/str_cat.h>

namespace tet {

absl::StatusOr<std::string> read_text_file(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  if (file && text << file.rdbuf()) return text.str();
  return absl::NotFoundError(absl::StrCat("cannot read ", path, ": ", std::strerror(errno)));
}

absl::Status about(const std::string& path, const absl::Status& status) {
  return {status.code(), absl::StrCat(path, ": ", status.message())};
}

}  // namespace tet
