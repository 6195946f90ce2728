#include "server/jobs/results/needed_meshes.h"

#include <memory>
#include <string>
#include <vector>

#include <absl/time/time.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/convert/mesh_header.h"
#include "server/jobs/results/job_spec.h"
#include "tests/server/jobs/store/sqlite_home.h"

namespace tet::test {
namespace {

using testing::ElementsAre;

v1::MeshHeader header_of(const std::string& mesh_id) {
  v1::MeshHeader header;
  header.set_mesh_id(mesh_id);
  header.set_vertex_count(1000);
  header.set_tet_count(5000);
  header.set_chunk_count(2);
  header.set_coordinate_type(v1::COORDINATE_TYPE_FLOAT32);
  header.set_index_type(v1::INDEX_TYPE_UINT32);
  return header;
}

/// Jobs in a store of their own, whose shards are claimed one at a time.
class NeededMeshesTest : public testing::Test {
 protected:
  /// A job that was counted, and has one shard left.
  std::string create(const std::string& space, const std::string& plan) {
    NewJob job;
    job.space = space;
    const std::string id = store_->create(job).value().job.id;
    EXPECT_EQ(store_->set_plan(claim(), {Phase::kMesh, plan, {{0, 2}}}), absl::OkStatus());
    return id;
  }
  std::string create(const std::string& space, const v1::MeshHeader& header) {
    stored::JobPlan plan;
    *plan.mutable_header() = header;
    return create(space, plan.SerializeAsString());
  }
  LeaseId claim() { return store_->claim({"w", 1, absl::Hours(1)}).value().at(0).id; }
  std::vector<NeededMesh> needed() { return needed_meshes(*store_).value(); }

  SqliteHome home_;
  const std::unique_ptr<JobStore> store_ = home_.open({});
};

TEST_F(NeededMeshesTest, AreThoseOfCountedJobs) {
  const v1::MeshHeader header = header_of("mesh");
  const std::string job = create("ana", header);
  const auto found = needed();
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].job, job);
  EXPECT_EQ(found[0].key, (ResultKey{"ana", "mesh"}));
  EXPECT_EQ(found[0].bytes, stored_bytes(from_proto(header).value()));
  EXPECT_GT(found[0].bytes, 5000U * 16) << "four ids of four bytes a tet";
  EXPECT_THAT(needed_results(*store_).value(), ElementsAre(ResultKey{"ana", "mesh"}));
  store_->cancel(job).value();
  EXPECT_TRUE(needed().empty());
}

TEST_F(NeededMeshesTest, AreWithoutThoseWhosePlansCannotBeRead) {
  create("ana", "\xff\xff");
  claim();
  v1::MeshHeader wrong = header_of("wrong");
  wrong.set_vertex_count(-1);
  create("ana", wrong);
  EXPECT_EQ(store_->planned().value().size(), 2U);
  EXPECT_TRUE(needed().empty());
}

TEST_F(NeededMeshesTest, GoOnWhileTheyAreMadeAndFindRoom) {
  create("ana", header_of("mesh"));
  const auto expect = [&](bool waits, bool goes_on) {
    EXPECT_EQ(needed().at(0).waits, waits);
    EXPECT_EQ(needed().at(0).goes_on, goes_on);
  };
  expect(false, false);
  LeaseId lease = claim();
  expect(false, true);
  const GiveBack for_room{absl::ResourceExhaustedError("no room"), absl::ZeroDuration(), true};
  EXPECT_EQ(store_->release(lease, for_room), absl::OkStatus());
  expect(true, false);
  lease = claim();
  expect(true, false);
  EXPECT_EQ(store_->found_room(lease), absl::OkStatus());
  expect(false, true);
}

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
