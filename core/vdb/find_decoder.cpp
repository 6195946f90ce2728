#include "core/vdb/find_decoder.h"

#include <filesystem>
#include <system_error>
#include <unistd.h>

#include <absl/strings/str_format.h>

#include "core/base/failure_name.h"

namespace tet {
namespace {

constexpr const char* kProgram = "tetstream-decoder";

bool can_run(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error) && ::access(path.c_str(), X_OK) == 0;
}

absl::Status not_found(const std::string& message) {
  return named_failure("DECODER_UNAVAILABLE", absl::UnavailableError(message));
}

}  // namespace

absl::StatusOr<std::string> find_decoder(const std::string& given) {
  if (!given.empty()) {
    if (can_run(given)) return given;
    return not_found(absl::StrFormat("there is no decoder program '%s'", given));
  }
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  const auto beside = self / kProgram;
  const auto installed = self.parent_path() / "libexec" / "tetstream" / kProgram;
  if (can_run(beside)) return beside.string();
  if (can_run(installed)) return installed.string();
  return not_found(absl::StrFormat("there is no decoder program '%s' or '%s'", beside.string(),
                                   installed.string()));
}

}  // namespace tet
