#include "server/grids/volume_cache.h"

#include <atomic>
#include <future>
#include <list>
#include <new>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tet {
namespace {

using Loaded = absl::StatusOr<GridInMemory>;

Volume volume_of(std::size_t values) {
  Volume volume;
  volume.values.resize(values);
  return volume;
}

const std::uint64_t kOneVolume = volume_of(1000).size_bytes();

class CacheTest : public testing::Test {
 protected:
  VolumeCache& cache(std::uint64_t budget) {
    return caches_.emplace_back(
        tasks_, budget,
        [this](const VolumeCache::Load& load, const VolumeCache::Cancelled& abandoned,
               const VolumeCache::LoadDone& done) {
          ++loads_;
          if (load.key.grid_name == "no memory") throw std::bad_alloc();
          if (load.key.grid_name == "lost") return;
          pool_.post(
              [name = load.key.grid_name, abandoned, done] { done(read(name, abandoned)); });
        },
        [this] { ++releases_; });
  }

  /// "slow" is read until nobody wants it.
  static Loaded read(const std::string& name, const VolumeCache::Cancelled& abandoned) {
    if (name == "bad") return absl::NotFoundError("no such grid");
    do {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    } while (name == "slow" && !abandoned());
    if (name == "slow") return absl::CancelledError();
    return std::make_shared<const Volume>(volume_of(1000));
  }

  static std::future<Loaded> ask(
      VolumeCache& cache,
      const std::string& name,
      const VolumeCache::Cancelled& cancelled = [] { return false; }) {
    auto promise = std::make_shared<std::promise<Loaded>>();
    cache.get(
        {"default", "digest", name}, "path",
        {"client", cancelled, [promise](const Loaded& loaded) { promise->set_value(loaded); }});
    return promise->get_future();
  }

  /// Waits until nobody but the cache and the caller holds the volume.
  static Loaded load(VolumeCache& cache, const std::string& name) {
    Loaded loaded = ask(cache, name).get();
    while (loaded.ok() && std::get<0>(*loaded).use_count() > 2) std::this_thread::yield();
    return loaded;
  }

  std::atomic<int> loads_{0}, releases_{0};
  std::list<VolumeCache> caches_;
  FairTasks tasks_{pool_};
  TaskPool pool_{2};  // ends first: the last task of a load refers to its cache
};

TEST_F(CacheTest, LoadsOnceForRequestsThatMeet) {
  VolumeCache& volumes = cache(10 * kOneVolume);
  auto first = ask(volumes, "a");
  auto second = ask(volumes, "a");
  EXPECT_EQ(*first.get(), *second.get());
  EXPECT_EQ(loads_, 1);
}

TEST_F(CacheTest, EvictsTheLeastRecentlyUsed) {
  VolumeCache& volumes = cache(2 * kOneVolume);
  for (const char* name : {"a", "b", "a", "c", "a"}) ASSERT_TRUE(load(volumes, name).ok());
  EXPECT_EQ(loads_, 3);
  ASSERT_TRUE(load(volumes, "b").ok());
  EXPECT_EQ(loads_, 4);
}

TEST_F(CacheTest, RefusesWhatDoesNotFitBesideVolumesInUse) {
  VolumeCache& volumes = cache(kOneVolume);
  auto held = load(volumes, "a");
  EXPECT_EQ(load(volumes, "b").status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(releases_, 1);
  held = absl::CancelledError();
  EXPECT_TRUE(load(volumes, "b").ok());
}

TEST_F(CacheTest, RefusesAVolumeOverTheBudgetWithBothNumbers) {
  VolumeCache& volumes = cache(kOneVolume - 1);
  const auto status = load(volumes, "a").status();
  EXPECT_THAT(std::string(status.message()),
              testing::HasSubstr(std::to_string(kOneVolume - 1)));
}

TEST_F(CacheTest, EndsALoadWhenNobodyWantsItAnyMore) {
  VolumeCache& volumes = cache(kOneVolume);
  std::atomic<bool> first_gone{false}, second_gone{false};
  auto first = ask(volumes, "slow", [&] { return first_gone.load(); });
  auto second = ask(volumes, "slow", [&] { return second_gone.load(); });
  first_gone = true;
  EXPECT_EQ(first.wait_for(std::chrono::milliseconds(100)), std::future_status::timeout);
  second_gone = true;
  EXPECT_EQ(first.get().status().code(), absl::StatusCode::kCancelled);
  EXPECT_EQ(second.get().status().code(), absl::StatusCode::kCancelled);
}

TEST_F(CacheTest, AnswersWhereALoadNeverEnds) {
  VolumeCache& volumes = cache(kOneVolume);
  for (const char* name : {"no memory", "lost"}) {
    loads_ = 0;
    for (int turn = 1; turn <= 2; ++turn) {
      EXPECT_EQ(load(volumes, name).status().code(), absl::StatusCode::kInternal) << name;
      EXPECT_EQ(loads_, turn) << name;
    }
  }
}

TEST_F(CacheTest, TriesAgainAfterAFailure) {
  VolumeCache& volumes = cache(kOneVolume);
  EXPECT_EQ(load(volumes, "bad").status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(load(volumes, "bad").status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(loads_, 2);
}

}  // namespace
}  // namespace tet
