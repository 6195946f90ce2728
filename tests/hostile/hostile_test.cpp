// Broken files that were found to crash, hang or fool OpenVDB's reader, and some that are only
// odd. tests/data/hostile_vdb/MANIFEST.tsv says what is expected of each.
#include <filesystem>
#include <fstream>
#include <ostream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/grid/load.h"
#include "core/grid/walk_vdb.h"

namespace tet {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

struct HostileFile {
  std::string name;
  std::string expected;  // "accepted", or a part of the refusal
};

void PrintTo(const HostileFile& file, std::ostream* out) { *out << file.name; }

std::string path_of(const std::string& name) {
  return std::string(TET_HOSTILE_VDB) + "/" + name;
}

std::vector<HostileFile> manifest() {
  std::ifstream in(path_of("MANIFEST.tsv"));
  std::vector<HostileFile> files;
  for (std::string line; std::getline(in, line);) {
    const std::size_t tab = line.find('\t');
    if (line.starts_with('#') || tab == std::string::npos) continue;
    files.push_back({line.substr(0, tab), line.substr(tab + 1)});
  }
  return files;
}

class Hostile : public ::testing::TestWithParam<HostileFile> {};

TEST_P(Hostile, IsToldByTheWalker) {
  const absl::Status status = walk_vdb(path_of(GetParam().name)).status();
  if (GetParam().expected == "accepted") {
    EXPECT_TRUE(status.ok()) << status;
    return;
  }
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr(GetParam().expected));
  EXPECT_THAT(std::string(status.message()), Not(HasSubstr(TET_HOSTILE_VDB)));
}

/// What the walker lets through, OpenVDB reads or refuses.
TEST_P(Hostile, NeverHarmsTheReader) {
  const std::string path = path_of(GetParam().name);
  const absl::StatusCode listed = list_grids(path).status().code();
  const absl::StatusCode loaded = load_volume(path, "").status().code();
  const bool accepted = GetParam().expected == "accepted";
  EXPECT_EQ(listed == absl::StatusCode::kInvalidArgument, !accepted);
  EXPECT_TRUE(loaded == absl::StatusCode::kInvalidArgument ||
              (accepted && (loaded == absl::StatusCode::kOk ||
                            loaded == absl::StatusCode::kFailedPrecondition)))
      << absl::StatusCodeToString(loaded);
}

INSTANTIATE_TEST_SUITE_P(Corpus,
                         Hostile,
                         ::testing::ValuesIn(manifest()),
                         [](const auto& test) {
                           return std::filesystem::path(test.param.name).stem().string();
                         });

TEST(HostileCorpus, IsListedInFull) {
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(TET_HOSTILE_VDB)) {
    files += entry.path().extension() == ".vdb" ? 1U : 0U;
  }
  EXPECT_EQ(manifest().size(), files);
  EXPECT_GT(files, 40U);
}

}  // namespace
}  // namespace tet
