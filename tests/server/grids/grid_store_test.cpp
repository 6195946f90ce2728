#include "server/grids/grid_store.h"

#include <csignal>
#include <sys/resource.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/convert/status.h"
#include "proto/wire/sha256.h"
#include "server/grids/grid_upload.h"
#include "tests/server/test_folder.h"

namespace tet {
namespace {

using testing::HasSubstr;

std::string digest_of(std::string_view text) {
  Sha256 digest;
  digest.add(text);
  return digest.finish_hex();
}

/// Its key in the default namespace.
GridKey key_of(std::string_view text) { return {std::string(kDefaultSpace), digest_of(text)}; }

/// Text of its own for each `number`, 100 bytes.
std::string content(int number) {
  std::string text = "grid " + std::to_string(number) + " ";
  text.resize(100, '.');
  return text;
}

class StoreTest : public testing::Test {
 protected:
  std::unique_ptr<GridStore> open(std::uint64_t budget = 1000) {
    auto store = GridStore::open(folder_.path(), budget);
    EXPECT_TRUE(store.ok()) << store.status();
    return *std::move(store);
  }

  static absl::Status put(GridStore& store, const std::string& text) {
    auto upload = store.begin_upload(key_of(text), text.size());
    if (!upload.ok()) return upload.status();
    if (const auto status = (*upload)->append(0, text); !status.ok()) return status;
    return (*upload)->commit();
  }

  test::TestFolder folder_;
};

TEST_F(StoreTest, KeepsWhatWasUploaded) {
  const auto store = open();
  ASSERT_TRUE(put(*store, content(1)).ok());
  const auto lease = store->acquire(key_of(content(1)));
  ASSERT_TRUE(lease.ok());
  EXPECT_EQ(test::read_text((*lease)->path.string()), content(1));
}

TEST_F(StoreTest, SurvivesARestart) {
  ASSERT_TRUE(put(*open(), content(1)).ok());
  const auto store = open();
  EXPECT_TRUE(store->touch(key_of(content(1))));
  EXPECT_EQ(store->list(std::string(kDefaultSpace), "", 10).size(), 1U);
}

TEST_F(StoreTest, ResumesAnUploadAfterARestart) {
  const std::string text = content(1);
  const GridKey key = key_of(text);
  {
    const auto store = open();
    auto upload = store->begin_upload(key, text.size());
    ASSERT_TRUE((*upload)->append(0, text.substr(0, 60)).ok());
  }
  const auto store = open();
  EXPECT_EQ(store->upload_state(key).committed_size, 60U);
  auto upload = store->begin_upload(key, text.size());
  ASSERT_TRUE(upload.ok());
  ASSERT_TRUE((*upload)->digest_part(1000).ok());
  ASSERT_TRUE((*upload)->append(60, text.substr(60)).ok());
  EXPECT_TRUE((*upload)->commit().ok());
  EXPECT_TRUE(store->upload_state(key).complete);
}

TEST_F(StoreTest, DigestsAPartALittleAtATimeAndLosesNothingMeanwhile) {
  const std::string text = content(1);
  const GridKey key = key_of(text);
  const auto store = open();
  {
    auto upload = store->begin_upload(key, text.size());
    EXPECT_TRUE((*upload)->has_digested_part());
    ASSERT_TRUE((*upload)->append(0, text.substr(0, 60)).ok());
  }
  {
    auto upload = store->begin_upload(key, text.size());
    EXPECT_FALSE((*upload)->has_digested_part());
    ASSERT_TRUE((*upload)->digest_part(25).ok());
    EXPECT_EQ((*upload)->committed_size(), 25U);
    EXPECT_FALSE((*upload)->has_digested_part());
  }
  EXPECT_EQ(store->upload_state(key).committed_size, 60U);
  auto upload = store->begin_upload(key, text.size());
  while (!(*upload)->has_digested_part()) ASSERT_TRUE((*upload)->digest_part(25).ok());
  EXPECT_EQ((*upload)->committed_size(), 60U);
  ASSERT_TRUE((*upload)->append(60, text.substr(60)).ok());
  EXPECT_TRUE((*upload)->commit().ok());
}

TEST_F(StoreTest, ThrowsAwayBytesOfAnotherDigest) {
  const auto store = open();
  const GridKey key = key_of("something else");
  {
    auto upload = store->begin_upload(key, 100);
    ASSERT_TRUE((*upload)->append(0, content(1)).ok());
    const auto status = (*upload)->commit();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string(status.message()), HasSubstr(digest_of(content(1))));
  }
  EXPECT_EQ(store->upload_state(key).committed_size, 0U);
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path() / "uploads"));
}

TEST_F(StoreTest, RefusesAGapAndAnOverrunAndGoesOn) {
  const auto store = open();
  const std::string text = content(1);
  auto upload = store->begin_upload(key_of(text), text.size());
  EXPECT_EQ((*upload)->append(7, "x").code(), absl::StatusCode::kOutOfRange);
  EXPECT_EQ((*upload)->append(0, text + "x").code(), absl::StatusCode::kInvalidArgument);
  ASSERT_TRUE((*upload)->append(0, text).ok());
  EXPECT_TRUE((*upload)->commit().ok());
}

TEST_F(StoreTest, LetsOneCallAtATimeUploadAFile) {
  const auto store = open();
  const auto first = store->begin_upload(key_of(content(1)), 100);
  ASSERT_TRUE(first.ok());
  const auto second = store->begin_upload(key_of(content(1)), 100);
  EXPECT_EQ(second.status().code(), absl::StatusCode::kAborted);
}

TEST_F(StoreTest, EvictsTheLeastRecentlyUsed) {
  const auto store = open(300);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(put(*store, content(i)).ok());
  EXPECT_TRUE(store->touch(key_of(content(0))));
  ASSERT_TRUE(put(*store, content(3)).ok());
  EXPECT_FALSE(store->touch(key_of(content(1))));
  EXPECT_TRUE(store->touch(key_of(content(0))));
  EXPECT_TRUE(store->touch(key_of(content(2))));
}

TEST_F(StoreTest, NeverEvictsAGridInUse) {
  const auto store = open(100);
  ASSERT_TRUE(put(*store, content(0)).ok());
  auto lease = store->acquire(key_of(content(0)));
  const auto refused = put(*store, content(1));
  EXPECT_EQ(refused.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(refused.message()), HasSubstr("100"));
  lease->reset();
  EXPECT_TRUE(put(*store, content(1)).ok());
}

TEST_F(StoreTest, NeverEvictsAGridThatIsNeeded) {
  const auto store = open(100);
  ASSERT_TRUE(put(*store, content(0)).ok());
  std::set<GridKey> needed = {key_of(content(0))};
  store->ask_before_evicting([&] { return needed; });
  EXPECT_EQ(reason_of(put(*store, content(1))), "STORE_HELD_BY_JOBS");
  needed.clear();
  EXPECT_TRUE(put(*store, content(1)).ok());
}

TEST_F(StoreTest, FindsTheOneGridThatNobodyNeedsBehindManyOlderOnes) {
  const auto store = open(20'000);
  std::set<GridKey> needed;
  for (int i = 0; i < 200; ++i) {
    ASSERT_TRUE(put(*store, content(i)).ok());
    if (i < 199) needed.insert(key_of(content(i)));
  }
  store->ask_before_evicting([&] { return needed; });
  EXPECT_TRUE(put(*store, content(200)).ok());
  EXPECT_FALSE(store->touch(key_of(content(199))));
  for (const GridKey& key : needed) EXPECT_TRUE(store->touch(key));
}

TEST_F(StoreTest, EvictsAsManySmallGridsAsALargeOneTakes) {
  const auto store = open(30'000);
  for (int i = 0; i < 300; ++i) ASSERT_TRUE(put(*store, content(i)).ok());
  ASSERT_TRUE(put(*store, std::string(20'050, 'x')).ok());
  const StoreStats stats = store->stats();
  EXPECT_EQ(stats.evicted_files, 201U);
  EXPECT_EQ(stats.bytes, 20'050U + 99 * 100);
}

TEST_F(StoreTest, NeverEvictsAGridThatWasTakenWhileItAskedWhoNeedsIt) {
  const auto store = open(100);
  ASSERT_TRUE(put(*store, content(0)).ok());
  store->ask_before_evicting([&] {
    EXPECT_TRUE(store->acquire(key_of(content(0))).ok());
    return std::set<GridKey>();
  });
  EXPECT_EQ(reason_of(put(*store, content(1))), "STORE_BUSY");
  EXPECT_TRUE(store->touch(key_of(content(0))));
}

TEST_F(StoreTest, EvictsNoGridWhenNobodyCanSayWhoNeedsIt) {
  const auto store = open(100);
  ASSERT_TRUE(put(*store, content(0)).ok());
  store->ask_before_evicting([] { return absl::UnavailableError("gone"); });
  EXPECT_EQ(put(*store, content(1)), absl::UnavailableError("gone"));
  EXPECT_TRUE(store->touch(key_of(content(0))));
}

TEST_F(StoreTest, EvictsUploadsThatWereGivenUp) {
  const auto store = open(150);
  {
    auto upload = store->begin_upload(key_of(content(0)), 100);
    ASSERT_TRUE((*upload)->append(0, content(0).substr(0, 80)).ok());
  }
  EXPECT_TRUE(put(*store, content(1)).ok());
  EXPECT_EQ(store->upload_state(key_of(content(0))).committed_size, 0U);
}

TEST_F(StoreTest, RefusesMoreThanItsBudgetWithBothNumbers) {
  const auto store = open(99);
  const auto status = put(*store, content(0));
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(status.message()), HasSubstr("100 is over the limit of 99"));
}

TEST_F(StoreTest, EvictsForAnotherFileHoweverSmallAllAre) {
  const auto store = open(std::uint64_t{1} << 30);
  store->limit_files(3);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(put(*store, content(i)).ok());
  {
    auto part = store->begin_upload(key_of(content(3)), 100);
    ASSERT_TRUE(part.ok()) << part.status();
    ASSERT_TRUE((*part)->append(0, content(3).substr(0, 1)).ok());
  }
  EXPECT_FALSE(store->touch(key_of(content(0))));
  {
    auto resumed = store->begin_upload(key_of(content(3)), 100);
    ASSERT_TRUE(resumed.ok()) << "its part is no other file: " << resumed.status();
    ASSERT_TRUE((*resumed)->digest_part(100).ok());
    ASSERT_TRUE((*resumed)->append(1, content(3).substr(1)).ok());
    ASSERT_TRUE((*resumed)->commit().ok());
  }
  EXPECT_TRUE(store->touch(key_of(content(1))));
  EXPECT_EQ(store->stats().files, 3U);
}

TEST_F(StoreTest, LimitsHowManyUnfinishedFilesAreOfOneClient) {
  const auto store = open();
  const Uploader alice{"alice", 1000, 2};
  for (int i = 0; i < 2; ++i) {
    auto part = store->begin_upload(key_of(content(i)), 100, alice);
    ASSERT_TRUE(part.ok()) << part.status();
    ASSERT_TRUE((*part)->append(0, content(i).substr(0, 1)).ok());
  }
  EXPECT_TRUE(store->begin_upload(key_of(content(1)), 100, alice).ok()) << "one of the two";
  EXPECT_EQ(reason_of(store->begin_upload(key_of(content(2)), 100, alice).status()),
            "QUOTA_EXCEEDED");
  EXPECT_TRUE(store->begin_upload(key_of(content(2)), 100, {"bob", 1000, 2}).ok());
}

// A limit on the file's size stands for the disk's end: both fail in the middle of a write.
TEST_F(StoreTest, KeepsWholePiecesWhenTheDiskIsFull) {
  const auto store = open();
  const std::string text = content(0);
  auto upload = store->begin_upload(key_of(text), text.size());
  ASSERT_TRUE((*upload)->append(0, text.substr(0, 50)).ok());
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit old{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &old), 0);
  const rlimit tight{70, old.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &tight), 0);
  const auto status = (*upload)->append(50, text.substr(50));
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &old), 0);
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted) << status;
  upload->reset();
  EXPECT_EQ(store->upload_state(key_of(text)).committed_size, 50U);
}

TEST_F(StoreTest, KnowsNothingOfAnotherNamespace) {
  const auto store = open();
  ASSERT_TRUE(put(*store, content(1)).ok());
  const GridKey theirs{"theirs", digest_of(content(1))};
  EXPECT_FALSE(store->touch(theirs));
  EXPECT_TRUE(absl::IsNotFound(store->acquire(theirs).status()));
  EXPECT_EQ(store->upload_state(theirs).committed_size, 0U);
  EXPECT_TRUE(store->list("theirs", "", 10).empty());
}

TEST_F(StoreTest, TakesAllBytesAgainInAnotherNamespace) {
  const auto store = open();
  const std::string text = content(1);
  ASSERT_TRUE(put(*store, text).ok());
  const GridKey theirs{"theirs", digest_of(text)};
  auto upload = store->begin_upload(theirs, text.size());
  ASSERT_TRUE(upload.ok()) << upload.status();
  EXPECT_EQ((*upload)->committed_size(), 0U);
  ASSERT_TRUE((*upload)->append(0, text).ok());
  ASSERT_TRUE((*upload)->commit().ok());
  EXPECT_TRUE(store->touch(theirs));
  EXPECT_NE((*store->acquire(theirs))->path, (*store->acquire(key_of(text)))->path);
}

TEST_F(StoreTest, KeepsNamespacesApartOverARestart) {
  const std::string text = content(1);
  {
    const auto store = open();
    auto upload = store->begin_upload({"theirs", digest_of(text)}, text.size());
    ASSERT_TRUE((*upload)->append(0, text).ok());
    ASSERT_TRUE((*upload)->commit().ok());
    auto part = store->begin_upload({"others", digest_of(text)}, text.size());
    ASSERT_TRUE((*part)->append(0, text.substr(0, 30)).ok());
  }
  const auto store = open();
  EXPECT_EQ(store->list("theirs", "", 10).size(), 1U);
  EXPECT_EQ(store->upload_state({"others", digest_of(text)}).committed_size, 30U);
  EXPECT_FALSE(store->touch(key_of(text)));
}

TEST_F(StoreTest, SharesItsBudgetAmongNamespaces) {
  const auto store = open(150);
  ASSERT_TRUE(put(*store, content(0)).ok());
  const std::string text = content(1);
  auto upload = store->begin_upload({"theirs", digest_of(text)}, text.size());
  ASSERT_TRUE(upload.ok()) << upload.status();
  EXPECT_FALSE(store->touch(key_of(content(0))));
}

TEST_F(StoreTest, IgnoresWhatIsNotItsOwn) {
  std::filesystem::create_directories(folder_.path() / "grids" / "zz");
  std::ofstream(folder_.path() / "grids" / "zz" / "notes.txt") << "mine";
  EXPECT_TRUE(open()->list(std::string(kDefaultSpace), "", 10).empty());
}

}  // namespace
}  // namespace tet
