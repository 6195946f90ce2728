// Broken files that were found to crash, hang or fool OpenVDB's reader, and some that are only
// odd. tests/data/hostile_vdb/MANIFEST.tsv says what is expected of each.
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/vdb/openvdb/load.h"
#include "core/vdb/walk/walk_vdb.h"

namespace tet {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

struct HostileFile {
  std::string name;
  std::string expected;  // "accepted", or a part of the refusal
};

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

TEST(HostileCorpus, IsToldByTheWalker) {
  for (const HostileFile& file : manifest()) {
    SCOPED_TRACE(file.name);
    const absl::Status status = walk_vdb(path_of(file.name)).status();
    if (file.expected == "accepted") {
      EXPECT_TRUE(status.ok()) << status;
      continue;
    }
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(file.expected));
    EXPECT_THAT(std::string(status.message()), Not(HasSubstr(TET_HOSTILE_VDB)));
  }
}

/// What the walker lets through, OpenVDB reads or refuses.
TEST(HostileCorpus, NeverHarmsTheReader) {
  for (const HostileFile& file : manifest()) {
    SCOPED_TRACE(file.name);
    const absl::StatusCode listed = list_grids(path_of(file.name)).status().code();
    const absl::StatusCode loaded = load_volume(path_of(file.name), "").status().code();
    const bool accepted = file.expected == "accepted";
    EXPECT_EQ(listed == absl::StatusCode::kInvalidArgument, !accepted);
    EXPECT_TRUE(loaded == absl::StatusCode::kInvalidArgument ||
                (accepted && (loaded == absl::StatusCode::kOk ||
                              loaded == absl::StatusCode::kFailedPrecondition)))
        << absl::StatusCodeToString(loaded);
  }
}

TEST(HostileCorpus, NeverHarmsWhoeverLooksValuesUp) {
  for (const HostileFile& file : manifest()) {
    SCOPED_TRACE(file.name);
    const std::string path = path_of(file.name);
    const bool accepted = file.expected == "accepted";
    EXPECT_TRUE(accepted || !load_field(path, "", 0).ok());
    const auto grids = list_grids(path);
    if (!grids.ok()) continue;
    for (const GridInfo& grid : *grids) {
      for (std::uint32_t i = 0; i < grid.field_components; ++i) {
        const absl::StatusCode loaded = load_field(path, grid.name, i).status().code();
        EXPECT_TRUE(loaded == absl::StatusCode::kOk ||
                    loaded == absl::StatusCode::kInvalidArgument ||
                    loaded == absl::StatusCode::kFailedPrecondition)
            << absl::StatusCodeToString(loaded);
      }
    }
  }
}

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
