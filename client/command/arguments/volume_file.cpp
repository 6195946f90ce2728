#include "client/command/arguments/volume_file.h"

#include <algorithm>
#include <array>

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>

namespace tet {

bool is_volume_file(const std::string& path) {
  constexpr std::array kEndings{".vdb", ".nii", ".nii.gz", ".nrrd", ".nhdr",
                                ".mha", ".mhd", ".vti",    ".npy"};
  const std::string name = absl::AsciiStrToLower(path);
  return std::ranges::any_of(kEndings,
                             [&](const char* ending) { return absl::EndsWith(name, ending); });
}

}  // namespace tet
