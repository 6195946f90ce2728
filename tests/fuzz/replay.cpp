// Runs a fuzz target over the files of folders, where there is no libFuzzer:
//   fuzz_replay TARGET FOLDER...
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/fuzz/fuzz_target.h"

namespace tet {

std::map<std::string, FuzzTarget>& fuzz_targets() {
  static std::map<std::string, FuzzTarget> targets;
  return targets;
}

std::map<std::string, void (*)()>& replay_checks() {
  static std::map<std::string, void (*)()> checks;
  return checks;
}

namespace {

int replay(FuzzTarget target, const std::filesystem::path& folder) {
  int files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::printf("%s\n", entry.path().c_str());
    std::fflush(stdout);  // before what may end it
    std::ifstream file(entry.path(), std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    target(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    ++files;
  }
  return files;
}

}  // namespace
}  // namespace tet

int main(int argc, char** argv) {
  const auto target = tet::fuzz_targets().find(argc > 1 ? argv[1] : "");
  if (target == tet::fuzz_targets().end()) {
    std::fprintf(stderr, "usage: fuzz_replay TARGET FOLDER...; targets are\n");
    for (const auto& [name, run] : tet::fuzz_targets())
      std::fprintf(stderr, "  %s\n", name.c_str());
    return 2;
  }
  int files = 0;
  for (int i = 2; i < argc; ++i) files += tet::replay(target->second, argv[i]);
  const auto check = tet::replay_checks().find(target->first);
  if (check != tet::replay_checks().end()) check->second();
  return files > 0 ? 0 : 1;  // none would show nothing
}
