// What a worker does with shards that it claimed ahead, and cannot do.
#include "server/jobs/work/job_worker.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/convert/status.h"
#include "tests/server/jobs/work/workshop.h"
#include "tests/support/eventually.h"

namespace tet::test {
namespace {

using testing::HasSubstr;

/// A worker with one thread, which claims two shards at once and begins with the older job's.
JobWorkerSettings one_thread() { return {.name = "w", .threads = 1}; }

/// A NumPy file of 2 x 2 x 2 numbers, as only a decoder reads it.
std::string tiny_image() {
  std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 2, 2), }";
  header.resize(117, ' ');
  return std::string("\x93NUMPY\x01\x00\x76\x00", 10) + header + '\n' + std::string(32, '\0');
}

TEST(JobWorker, SaysNothingOfJobsThatItDidNotTryForWantOfRoom) {
  Workshop shop;
  const Job tried = shop.create(ball_of(8)), untried = shop.create(ball_of(7));
  for (const ShardLease& plan : shop.claim(2)) ASSERT_EQ(shop.run(plan), absl::OkStatus());
  shop.open_results({.budget_bytes = Workshop::kPlenty, .keep_free_bytes = UINT64_MAX / 2});
  JobWorker worker(shop.jobs(), shop.maker(), shop.place(), shop.results(), one_thread());
  // The store's time stands still, so that nobody claims them again.
  EXPECT_TRUE(eventually([&] { return shop.jobs().counts().value().backing_off == 2; }));
  worker.stop();
  EXPECT_EQ(shop.get(tried).given_back, 1);
  EXPECT_EQ(reason_of(shop.get(tried).trouble), "DISK_FULL");
  EXPECT_THAT(std::string(shop.get(tried).trouble.message()), HasSubstr("worker w: "));
  EXPECT_TRUE(shop.get(tried).waits_for_room);
  EXPECT_EQ(shop.get(untried).given_back, 0);
  EXPECT_EQ(shop.get(untried).trouble, absl::OkStatus());
  EXPECT_FALSE(shop.get(untried).waits_for_room);
  EXPECT_EQ(worker.given_back_shards(), 2);
}

TEST(JobWorker, TellsJobsThatItDidNotTryOfATroubleOfItsOwn) {
  Config config;
  config.decoder = "/nowhere/decoder";
  Workshop shop(config);
  v1::MeshRequest mesh;
  mesh.set_name(shop.store_grid(tiny_image()));
  const Job tried = shop.create(mesh), untried = shop.create(mesh);
  JobWorker worker(shop.jobs(), shop.maker(), shop.place(), shop.results(), one_thread());
  EXPECT_TRUE(eventually([&] { return shop.get(untried).given_back > 0; }));
  worker.stop();
  for (const Job& job : {tried, untried}) {
    EXPECT_EQ(reason_of(shop.get(job).trouble), "DECODER_UNAVAILABLE");
    EXPECT_THAT(std::string(shop.get(job).trouble.message()), HasSubstr("worker w: "));
    EXPECT_FALSE(shop.get(job).waits_for_room);
  }
  // At once another's, and no attempt is used up.
  const auto leases = shop.claim(2);
  ASSERT_EQ(leases.size(), 2U);
  for (const ShardLease& lease : leases) EXPECT_EQ(lease.attempt, 1);
}

}  // namespace
}  // namespace tet::test
