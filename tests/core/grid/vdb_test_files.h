// What the grid tests share: a directory for files, and small OpenVDB grids to write into it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>

namespace tet::test {

/// A file path of this test's own; removed files and all when the test ends.
class TestDirectory {
 public:
  TestDirectory() {
    std::string pattern = ::testing::TempDir() + "/grid_test.XXXXXX";
    path_ = ::mkdtemp(pattern.data());
  }
  ~TestDirectory() { std::filesystem::remove_all(path_); }
  TestDirectory(const TestDirectory&) = delete;
  TestDirectory& operator=(const TestDirectory&) = delete;

  std::string file(const std::string& name) const { return path_ / name; }
  std::size_t file_count() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(path_), {}));
  }

 private:
  std::filesystem::path path_;
};

inline std::string read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline void write_bytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

inline void write_vdb(const std::string& path, const openvdb::GridCPtrVec& grids) {
  openvdb::io::File(path).write(grids);
}

/// A ball of `radius` voxels, with inside tiles when it is large enough.
inline openvdb::FloatGrid::Ptr ball(float radius,
                                    const std::string& name = "ball",
                                    const openvdb::Vec3f& centre = {0, 0, 0}) {
  openvdb::initialize();
  auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(radius, centre, 1);
  grid->setName(name);
  return grid;
}

}  // namespace tet::test
