#include "core/vdb/parts/find_decoder.h"

#include <algorithm>
#include <dlfcn.h>
#include <filesystem>
#include <system_error>
#include <unistd.h>
#include <vector>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_join.h>

#include "core/base/failure_name.h"

namespace tet {
namespace {

constexpr const char* kProgram = "tetstream-decoder";

bool is_file(const std::string& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

bool can_run(const std::string& path) {
  return is_file(path) && ::access(path.c_str(), X_OK) == 0;
}

/// The folder of the shared library that this code is part of; of the program itself where it
/// is part of that.
std::filesystem::path own_folder() {
  Dl_info info{};
  if (::dladdr(reinterpret_cast<const void*>(&own_folder), &info) == 0) return {};
  std::error_code error;
  return std::filesystem::canonical(info.dli_fname, error).parent_path();
}

/// Where the decoder and what it loads may be, the likeliest first.
std::vector<std::string> candidates(const char* name) {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  const std::filesystem::path installed = std::filesystem::path("libexec") / "tetstream";
  const auto library = own_folder();
  std::vector<std::string> paths;
  for (const auto& folder :
       {self, self.parent_path() / installed, library, library.parent_path() / installed,
        library.parent_path().parent_path() / installed}) {
    std::string path = (folder / name).string();
    if (std::find(paths.begin(), paths.end(), path) == paths.end()) {
      paths.push_back(std::move(path));
    }
  }
  return paths;
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
  const std::vector<std::string> paths = candidates(kProgram);
  const auto found = std::find_if(paths.begin(), paths.end(), can_run);
  if (found != paths.end()) return *found;
  return not_found(
      absl::StrCat("there is no decoder program '", absl::StrJoin(paths, "' or '"), "'"));
}

absl::StatusOr<std::string> find_module(const char* name) {
  const std::vector<std::string> paths = candidates(name);
  const auto found = std::find_if(paths.begin(), paths.end(), is_file);
  if (found != paths.end()) return *found;
  return absl::NotFoundError(
      absl::StrCat("there is no '", absl::StrJoin(paths, "' or '"), "'"));
}

}  // namespace tet
