#include "server/jobs/results/needed_meshes.h"

#include <string>

#include <gtest/gtest.h>

namespace tet::test {
namespace {

NeededMesh idle(const std::string& job) { return {job, {"default", job}, 1000}; }

NeededMesh waiting(const std::string& job) {
  NeededMesh mesh = idle(job);
  mesh.waits = true;
  return mesh;
}

NeededMesh going_on(const std::string& job) {
  NeededMesh mesh = idle(job);
  mesh.goes_on = true;
  return mesh;
}

TEST(NeededMeshes, EndTheYoungestOfThoseThatWaitForEachOther) {
  EXPECT_TRUE(is_youngest_of_waiting({waiting("1"), waiting("2")}, "2"));
  EXPECT_FALSE(is_youngest_of_waiting({waiting("1"), waiting("2")}, "1"));
  // Also where it has found no room for the first time.
  EXPECT_TRUE(is_youngest_of_waiting({waiting("1"), going_on("2")}, "2"));
}

TEST(NeededMeshes, EndNothingWhereNobodyElseWaits) {
  EXPECT_FALSE(is_youngest_of_waiting({waiting("2")}, "2"));
  EXPECT_FALSE(is_youngest_of_waiting({idle("1"), waiting("2")}, "2"));
}

TEST(NeededMeshes, AreNotHeldUpByAYoungerJobThatNobodyTries) {
  EXPECT_TRUE(is_youngest_of_waiting({waiting("1"), waiting("2"), idle("3")}, "2"));
}

TEST(NeededMeshes, EndNothingAsLongAsAnotherGoesOn) {
  EXPECT_FALSE(is_youngest_of_waiting({waiting("1"), waiting("2"), going_on("3")}, "2"));
  EXPECT_FALSE(is_youngest_of_waiting({going_on("0"), waiting("1"), waiting("2")}, "2"));
}

}  // namespace
}  // namespace tet::test
