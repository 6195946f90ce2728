// Two servers' views of one store; what holds among them holds among processes, since each
// opens the files that it locks by itself.
#include <csignal>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/convert/status.h"
#include "proto/wire/sha256.h"
#include "server/grids/grid_store.h"
#include "server/grids/grid_upload.h"
#include "server/grids/store_identity.h"
#include "tests/server/test_folder.h"

namespace tet {
namespace {

using testing::HasSubstr;

GridKey shared_key(std::string_view text) {
  Sha256 digest;
  digest.add(text);
  return {std::string(kDefaultSpace), digest.finish_hex()};
}

/// Text of its own for each `number`, 100 bytes.
std::string shared_text(int number) {
  std::string text = "shared grid " + std::to_string(number) + " ";
  text.resize(100, '.');
  return text;
}

class SharedStoreTest : public testing::Test {
 protected:
  std::unique_ptr<GridStore> open(std::uint64_t budget = 1000,
                                  StoreSharing sharing = StoreSharing::kServers) {
    auto store = GridStore::open(folder_.path(), budget, 0, sharing);
    EXPECT_TRUE(store.ok()) << store.status();
    return *std::move(store);
  }

  static absl::Status put(GridStore& store, const std::string& text) {
    auto upload = store.begin_upload(shared_key(text), text.size());
    if (!upload.ok()) return upload.status();
    if (const auto status = (*upload)->append(0, text); !status.ok()) return status;
    return (*upload)->commit();
  }

  static bool has(GridStore& store, int number) {
    return store.upload_state(shared_key(shared_text(number))).complete;
  }

  static std::size_t listed(GridStore& store) {
    store.catch_up();
    return store.list(std::string(kDefaultSpace), "", 10).size();
  }

  std::filesystem::path journal() const { return folder_.path() / "grids.changes"; }

  test::TestFolder folder_;
};

TEST_F(SharedStoreTest, FindsWhatTheOtherServerStored) {
  const auto one = open(), other = open();
  ASSERT_TRUE(put(*one, shared_text(1)).ok());
  const GridKey key = shared_key(shared_text(1));
  EXPECT_TRUE(other->touch(key));
  EXPECT_TRUE(other->upload_state(key).complete);
  EXPECT_TRUE(other->acquire(key).ok());
  EXPECT_EQ(listed(*other), 1U);
  EXPECT_EQ(other->stats().bytes, 100U);
  EXPECT_TRUE(absl::IsAlreadyExists(other->begin_upload(key, 100).status()));
}

TEST_F(SharedStoreTest, TellsOfGridsThatItNeverAskedFor) {
  const auto one = open(), other = open();
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(put(*one, shared_text(i)).ok());
  EXPECT_EQ(listed(*other), 3U);
  EXPECT_EQ(other->stats().bytes, 300U);
}

TEST_F(SharedStoreTest, LetsOneServerAtATimeUploadAFile) {
  const auto one = open(), other = open();
  const GridKey key = shared_key(shared_text(1));
  {
    auto first = one->begin_upload(key, 100);
    ASSERT_TRUE(first.ok());
    const auto second = other->begin_upload(key, 100);
    EXPECT_EQ(reason_of(second.status()), "UPLOAD_IN_PROGRESS");
    ASSERT_TRUE((*first)->append(0, shared_text(1)).ok());
    ASSERT_TRUE((*first)->commit().ok());
    EXPECT_TRUE(absl::IsAlreadyExists(other->begin_upload(key, 100).status()));
  }
  EXPECT_TRUE(has(*other, 1));
}

TEST_F(SharedStoreTest, GoesOnWithAnUploadThatTheOtherLeft) {
  const auto one = open(), other = open();
  const std::string text = shared_text(1);
  {
    auto upload = one->begin_upload(shared_key(text), 100);
    ASSERT_TRUE((*upload)->append(0, text.substr(0, 60)).ok());
  }
  EXPECT_EQ(other->upload_state(shared_key(text)).committed_size, 60U);
  auto upload = other->begin_upload(shared_key(text), 100);
  ASSERT_TRUE(upload.ok()) << upload.status();
  ASSERT_TRUE((*upload)->digest_part(100).ok());
  ASSERT_TRUE((*upload)->append(60, text.substr(60)).ok());
  EXPECT_TRUE((*upload)->commit().ok());
  EXPECT_TRUE(has(*one, 1));
}

/// What a server does that is killed in the middle of an upload of 100 bytes.
void upload_and_be_killed(const std::filesystem::path& root,
                          const std::string& text,
                          std::size_t sent = 60) {
  const pid_t child = ::fork();
  if (child == 0) {
    auto store = GridStore::open(root, 1000, 0, StoreSharing::kServers);
    auto upload = (*store)->begin_upload(shared_key(text), text.size(), {"alice"});
    if ((*upload)->append(0, text.substr(0, sent)).ok()) ::raise(SIGKILL);
    ::_exit(1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
}

TEST_F(SharedStoreTest, GoesOnWithAnUploadWhoseServerWasKilled) {
  const auto store = open();
  const std::string text = shared_text(1);
  upload_and_be_killed(folder_.path(), text);
  auto upload = store->begin_upload(shared_key(text), 100);
  ASSERT_TRUE(upload.ok()) << upload.status();
  ASSERT_TRUE((*upload)->digest_part(100).ok());
  EXPECT_EQ((*upload)->committed_size(), 60U);
  ASSERT_TRUE((*upload)->append(60, text.substr(60)).ok());
  EXPECT_TRUE((*upload)->commit().ok());
}

TEST_F(SharedStoreTest, KeepsNothingOfAnUploadOfWhichNothingCame) {
  const auto store = open();
  upload_and_be_killed(folder_.path(), shared_text(1), 0);
  ASSERT_TRUE(put(*store, shared_text(2)).ok());
  EXPECT_EQ(store->stats().uploads, 0U);
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path() / "uploads"));
}

TEST_F(SharedStoreTest, KeepsNoRoomForAnUploadWhoseServerWasKilled) {
  const auto store = open(160);
  upload_and_be_killed(folder_.path(), shared_text(1));
  EXPECT_TRUE(put(*store, shared_text(2)).ok());
  EXPECT_EQ(store->stats().evicted_uploads, 0U);
}

TEST_F(SharedStoreTest, KeepsRoomForAllOfTheOthersUpload) {
  const auto one = open(150), other = open(150);
  const auto upload = one->begin_upload(shared_key(shared_text(1)), 100);
  ASSERT_TRUE(upload.ok());
  EXPECT_EQ(reason_of(put(*other, shared_text(2))), "STORE_BUSY");
  // One that comes later learns of it, too.
  EXPECT_EQ(reason_of(put(*open(150), shared_text(2))), "STORE_BUSY");
}

TEST_F(SharedStoreTest, ChargesAClientForItsUploadsOnAllServers) {
  const auto one = open(), other = open();
  const auto upload = one->begin_upload(shared_key(shared_text(1)), 100, {"alice", 150});
  ASSERT_TRUE(upload.ok());
  const GridKey key = shared_key(shared_text(2));
  EXPECT_EQ(reason_of(other->begin_upload(key, 100, {"alice", 150}).status()),
            "QUOTA_EXCEEDED");
  EXPECT_TRUE(other->begin_upload(key, 100, {"bob", 150}).ok());
}

TEST_F(SharedStoreTest, EvictsWhatNoServerHasUsedForLongest) {
  const auto one = open(300), other = open(300);
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(put(*one, shared_text(i)).ok());
  EXPECT_TRUE(other->touch(shared_key(shared_text(0))));
  ASSERT_TRUE(put(*one, shared_text(3)).ok());
  EXPECT_FALSE(has(*other, 1));
  for (const int kept : {0, 2, 3}) EXPECT_TRUE(has(*other, kept)) << kept;
  EXPECT_EQ(listed(*other), 3U);
}

TEST_F(SharedStoreTest, NeverEvictsAGridThatTheOtherUses) {
  const auto one = open(100), other = open(100);
  ASSERT_TRUE(put(*one, shared_text(0)).ok());
  auto lease = other->acquire(shared_key(shared_text(0)));
  ASSERT_TRUE(lease.ok());
  EXPECT_EQ(reason_of(put(*one, shared_text(1))), "STORE_BUSY");
  EXPECT_EQ(test::read_text((*lease)->path.string()), shared_text(0));
  lease->reset();
  EXPECT_TRUE(put(*one, shared_text(1)).ok());
  EXPECT_TRUE(absl::IsNotFound(other->acquire(shared_key(shared_text(0))).status()));
}

TEST_F(SharedStoreTest, NeverEvictsAGridThatTheOtherTookWhileItAskedWhoNeedsIt) {
  const auto one = open(100), other = open(100);
  ASSERT_TRUE(put(*one, shared_text(0)).ok());
  one->ask_before_evicting([&] {
    EXPECT_TRUE(other->acquire(shared_key(shared_text(0))).ok());
    return std::set<GridKey>();
  });
  EXPECT_EQ(reason_of(put(*one, shared_text(1))), "STORE_BUSY");
  EXPECT_TRUE(has(*other, 0));
}

/// As of a server that makes a job just then: it takes the grid before the jobs are asked, and
/// lets go of it when the job is stored, which the answer does not know of.
TEST_F(SharedStoreTest, NeverEvictsAGridThatTheOtherHadWhenItAskedWhoNeedsIt) {
  const auto one = open(100), other = open(100);
  ASSERT_TRUE(put(*one, shared_text(0)).ok());
  auto lease = other->acquire(shared_key(shared_text(0)));
  ASSERT_TRUE(lease.ok());
  one->ask_before_evicting([&] {
    lease->reset();
    return std::set<GridKey>();
  });
  // Where nothing may go nobody is asked.
  EXPECT_EQ(reason_of(put(*one, shared_text(1))), "STORE_BUSY");
  EXPECT_TRUE(has(*other, 0));
  lease->reset();
  EXPECT_TRUE(put(*one, shared_text(1)).ok());
}

TEST_F(SharedStoreTest, LosesNothingWithTheJournal) {
  const auto one = open(300), other = open(300);
  for (int i = 0; i < 2; ++i) ASSERT_TRUE(put(*one, shared_text(i)).ok());
  EXPECT_EQ(listed(*other), 2U);
  for (const char* const broken :
       {"", "no journal\n", "tetstream grids 1 0123456789abcdef\nx\n"}) {
    std::ofstream(journal()) << broken;
    EXPECT_EQ(listed(*one), 2U);
    EXPECT_EQ(listed(*other), 2U);
  }
  std::filesystem::remove(journal());
  ASSERT_TRUE(put(*other, shared_text(2)).ok());
  EXPECT_EQ(listed(*one), 3U);
  EXPECT_EQ(one->stats().bytes, 300U);
}

TEST_F(SharedStoreTest, WritesOverALineThatSomebodyDiedOver) {
  const auto one = open(), other = open();
  ASSERT_TRUE(put(*one, shared_text(0)).ok());
  EXPECT_EQ(listed(*other), 1U);
  std::ofstream(journal(), std::ios::app) << "+ default 0123";
  ASSERT_TRUE(put(*other, shared_text(1)).ok());
  EXPECT_EQ(listed(*one), 2U);
  EXPECT_THAT(test::read_text(journal().string()), testing::Not(HasSubstr("0123+")));
}

TEST_F(SharedStoreTest, LeavesAnUploadToItsServerWhenTheJournalIsLost) {
  const auto one = open(150), other = open(150);
  auto upload = one->begin_upload(shared_key(shared_text(1)), 100);
  ASSERT_TRUE((*upload)->append(0, shared_text(1)).ok());
  std::filesystem::remove(journal());
  EXPECT_EQ(reason_of(put(*other, shared_text(2))), "STORE_BUSY");
  EXPECT_TRUE((*upload)->commit().ok());
}

TEST_F(SharedStoreTest, SetsNothingAsideThatCameInPlaceOfTheDamage) {
  const auto one = open(), other = open();
  const GridKey key = shared_key(shared_text(0));
  ASSERT_TRUE(put(*one, shared_text(0)).ok());
  const auto ours = *one->acquire(key), theirs = *other->acquire(key);
  one->set_aside(ours);
  EXPECT_FALSE(has(*other, 0));
  ASSERT_TRUE(put(*one, shared_text(0)).ok());
  other->set_aside(theirs);
  EXPECT_TRUE(has(*other, 0));
  EXPECT_EQ(other->stats().corrupt_files, 0U);
}

TEST_F(SharedStoreTest, LetsAWorkerReadWhatNoServerThenEvicts) {
  const auto server = open(100);
  ASSERT_TRUE(put(*server, shared_text(0)).ok());
  const auto worker = *GridStore::open_beside_server(folder_.path());
  auto lease = worker->acquire(shared_key(shared_text(0)));
  ASSERT_TRUE(lease.ok());
  EXPECT_EQ(reason_of(put(*server, shared_text(1))), "STORE_BUSY");
}

TEST_F(SharedStoreTest, RefusesWhoeverWantsItAlone) {
  const auto shared = open();
  const auto alone = GridStore::open(folder_.path(), 1000);
  EXPECT_TRUE(absl::IsFailedPrecondition(alone.status()));
  EXPECT_THAT(std::string(alone.status().message()), HasSubstr("PostgreSQL"));
}

TEST_F(SharedStoreTest, SharesNothingWithWhoeverHasItAlone) {
  const auto alone = open(1000, StoreSharing::kAlone);
  const auto shared = GridStore::open(folder_.path(), 1000, 0, StoreSharing::kServers);
  EXPECT_TRUE(absl::IsFailedPrecondition(shared.status()));
}

TEST_F(SharedStoreTest, IsGivenOneIdentityByAllWhoBegin) {
  std::vector<std::string> made(8);
  {
    std::vector<std::jthread> servers;
    for (std::string& identity : made) {
      servers.emplace_back(
          [&] { identity = make_store_identity(folder_.path()).value_or(""); });
    }
  }
  EXPECT_THAT(made, testing::Each(made.front()));
  EXPECT_THAT(made.front(), testing::SizeIs(32));
}

// Whatever two servers with several threads each do at once, the account is right in the end.
TEST_F(SharedStoreTest, CountsRightlyWhateverHappensAtOnce) {
  const auto one = open(500), other = open(500);
  {
    std::vector<std::jthread> clients;
    for (int client = 0; client < 4; ++client) {
      GridStore& store = client % 2 == 0 ? *one : *other;
      clients.emplace_back([&store, client] {
        for (int i = 0; i < 40; ++i) {
          const int number = (7 * i + client) % 12;
          put(store, shared_text(number)).IgnoreError();
          if (const auto lease = store.acquire(shared_key(shared_text(number))); lease.ok()) {
            EXPECT_EQ(test::read_text((*lease)->path.string()), shared_text(number));
          }
        }
      });
    }
  }
  EXPECT_EQ(listed(*one), listed(*other));
  EXPECT_LE(one->stats().bytes, 500U);
  EXPECT_EQ(one->stats().bytes, 100 * listed(*one));
  EXPECT_EQ(one->stats().bytes, other->stats().bytes);
  EXPECT_EQ(one->stats().uploads, 0U);
}

}  // namespace
}  // namespace tet
