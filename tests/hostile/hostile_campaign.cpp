// Puts many broken .vdb files through the walker, or through the whole reader, in this process.
//
//   hostile_campaign --mutants N [--first I] [--seed S] [--through walker|load]
//                    [--keep-accepted DIR] [--keep-all DIR] [--describe]
//
// Prints counts by outcome and the slowest, and fails with exit code 1 when a file was neither
// accepted nor refused as hostile files are. A crash is a crash. Mutant I of seed S is the same
// file each time: --mutants 1 --first I --describe --keep-all DIR shows one.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <span>
#include <string>

#include <CLI/CLI.hpp>
#include <absl/strings/str_cat.h>

#include "core/vdb/openvdb/load.h"
#include "core/vdb/walk/walk_vdb.h"
#include "tests/hostile/campaign.h"
#include "tests/hostile/seed_files.h"

namespace {

using tet::test::Mutant;

struct Options {
  std::uint64_t mutants = 1000;
  std::uint64_t first = 0;
  std::uint64_t seed = 1;
  std::string through = "walker";
  std::string keep_accepted, keep_all;
  bool describe = false;
};

void keep(const std::string& directory, std::uint64_t index, const Mutant& mutant) {
  std::filesystem::create_directories(directory);
  std::ofstream(absl::StrCat(directory, "/mutant-", index, ".vdb"), std::ios::binary)
      << mutant.bytes;
}

absl::Status walk(const Mutant& mutant) {
  return tet::walk_vdb(tet::ByteSource(std::as_bytes(std::span(mutant.bytes)))).status();
}

/// The walker, then OpenVDB.
absl::Status load(const Mutant& mutant, const std::string& path) {
  std::ofstream(path, std::ios::binary) << mutant.bytes;
  const tet::LoadLimits limits{.max_bytes = std::uint64_t{1} << 30};
  const auto listed = tet::list_grids(path);
  for (const tet::GridInfo& grid : listed.value_or(std::vector<tet::GridInfo>())) {
    for (std::uint32_t i = 0; i < grid.field_components; ++i) {
      const absl::Status field = tet::load_field(path, grid.name, i, limits).status();
      if (absl::IsInternal(field) || absl::IsUnknown(field)) return field;
    }
  }
  const absl::Status loaded = tet::load_volume(path, "", limits).status();
  return loaded.ok() ? listed.status() : loaded;
}

int run(const Options& options) {
  const tet::test::Mutator mutator(tet::test::seed_files(), options.seed);
  const std::string path = std::filesystem::temp_directory_path() / "hostile_campaign.vdb";
  std::uint64_t next = options.first;
  const auto trial = [&](const Mutant& mutant) {
    const std::uint64_t index = next++;
    if (options.describe) std::cout << index << ": " << mutant.description << std::endl;
    if (!options.keep_all.empty()) keep(options.keep_all, index, mutant);
    const absl::Status status = options.through == "load" ? load(mutant, path) : walk(mutant);
    if (options.describe) std::cout << "  " << status << '\n';
    return status;
  };
  const auto accepted = [&](std::uint64_t index, const Mutant& mutant) {
    if (!options.keep_accepted.empty()) keep(options.keep_accepted, index, mutant);
  };
  const tet::test::CampaignResult result =
      run_campaign(mutator, {options.first, options.mutants},
                   {trial, tet::test::processor_seconds}, accepted, std::cout);
  print_result(result, std::cout);
  return result.unexpected == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Puts mutants of .vdb files through the walker or the reader");
  app.add_option("--mutants", options.mutants, "how many");
  app.add_option("--first", options.first, "the first one's number");
  app.add_option("--seed", options.seed, "the campaign's number");
  app.add_option("--through", options.through, "walker, or load: the walker and OpenVDB")
      ->check(CLI::IsMember({"walker", "load"}));
  app.add_option("--keep-accepted", options.keep_accepted, "write accepted mutants here");
  app.add_option("--keep-all", options.keep_all, "write every mutant here");
  app.add_flag("--describe", options.describe, "say of each what was changed");
  CLI11_PARSE(app, argc, argv);
  return run(options);
}
