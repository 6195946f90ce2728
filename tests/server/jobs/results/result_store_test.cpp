#include "server/jobs/results/result_store.h"

#include <atomic>
#include <chrono>
#include <fstream>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <sys/resource.h>
#include <thread>
#include <vector>

#include <absl/strings/escaping.h>
#include <absl/strings/str_cat.h>
#include <gtest/gtest.h>

#include "proto/convert/status.h"
#include "server/ops/logging.h"
#include "tests/server/test_folder.h"
#include "tests/support/eventually.h"

namespace tet::test {
namespace {

namespace fs = std::filesystem;

constexpr char kMesh[] = "aa00", kOther[] = "bb00";
const std::string kLongId(64, 'a');

/// Makes a file look as if it had lain there for two hours.
void age(const fs::path& file) {
  fs::last_write_time(file, fs::file_time_type::clock::now() - std::chrono::hours(2));
}

ChunkMessage chunk_of(const std::string& bytes) {
  const grpc::Slice slices[] = {grpc::Slice(bytes.substr(0, 3)), grpc::Slice(bytes.substr(3))};
  ChunkMessage chunk;
  chunk.event = grpc::ByteBuffer(slices, 2);
  chunk.tets = 7;
  chunk.bytes = bytes.size();
  chunk.quality.min_dihedral_deg = 12.5;
  chunk.quality.histogram[12] = 6;
  return chunk;
}

std::string bytes_of(const ChunkMessage& chunk) {
  grpc::Slice slice;
  EXPECT_TRUE(chunk.event.DumpToSingleSlice(&slice).ok());
  return {reinterpret_cast<const char*>(slice.begin()), slice.size()};
}

/// What is in the folders of meshes, while nobody evicts or asks for room.
std::uint64_t stored_bytes_in(const fs::path& root) {
  const auto turn = ResultLedger(root).take();
  EXPECT_TRUE(turn.ok()) << turn.status();
  std::uint64_t bytes = 0;
  std::error_code gone;
  for (fs::recursive_directory_iterator it(root / "default/meshes", gone), end;
       !gone && it != end; it.increment(gone)) {
    std::error_code ignored;
    const std::uintmax_t size = it->file_size(ignored);
    if (!ignored) bytes += size;
  }
  return bytes;
}

class ResultStoreTest : public testing::Test {
 protected:
  ResultStoreTest() { start_logging("off"); }

  std::unique_ptr<ResultStore> open(std::uint64_t budget = 1 << 20,
                                    absl::Duration keep_damaged = absl::Hours(1)) {
    return ResultStore::open(folder_.path(), {budget, 0, keep_damaged}).value();
  }
  static std::shared_ptr<MeshFolder> use(ResultStore& store, const std::string& mesh) {
    return store.make({"default", mesh}).value();
  }
  absl::StatusOr<ChunkMessage> get(const MeshFolder& mesh, const ChunkDigest& digest) {
    return mesh.get_chunk(digest, blocks_, nullptr);
  }
  fs::path file_of(const ChunkDigest& digest) const {
    return folder_.path() / "default/meshes/aa" / kMesh / absl::BytesToHexString(digest);
  }

  TestFolder folder_;
  BlockPool blocks_{4096, 1};
};

TEST_F(ResultStoreTest, GivesBackWhatWasPut) {
  const auto store = open();
  const auto mesh = use(*store, kMesh);
  const ChunkDigest digest = mesh->put_chunk(chunk_of("some bytes")).value();
  EXPECT_EQ(mesh->put_chunk(chunk_of("some bytes")).value(), digest);
  const ChunkMessage chunk = get(*mesh, digest).value();
  EXPECT_EQ(bytes_of(chunk), "some bytes");
  EXPECT_EQ(chunk.tets, 7U);
  EXPECT_EQ(chunk.quality.min_dihedral_deg, 12.5);
  EXPECT_EQ(chunk.quality.histogram[12], 6U);
}

TEST_F(ResultStoreTest, NoticesEachDamageOfAChunk) {
  const auto store = open();
  const auto mesh = use(*store, kMesh);
  const auto damage = [&](const std::function<void(const fs::path&)>& how) {
    const ChunkDigest digest = mesh->put_chunk(chunk_of("some bytes")).value();
    how(file_of(digest));
    EXPECT_EQ(reason_of(get(*mesh, digest).status()), "CHUNK_DAMAGED");
    EXPECT_FALSE(mesh->has_chunk(digest));
  };
  damage([](const fs::path& file) { fs::remove(file); });
  damage([](const fs::path& file) { fs::resize_file(file, 5); });
  damage([](const fs::path& file) { fs::resize_file(file, fs::file_size(file) - 1); });
  damage([](const fs::path& file) { fs::resize_file(file, fs::file_size(file) + 1); });
  damage([](const fs::path& file) {
    std::fstream(file, std::ios::in | std::ios::out | std::ios::binary).seekp(3) << '!';
  });
}

TEST_F(ResultStoreTest, KnowsTheShardsThatAreWhole) {
  const auto store = open();
  const auto mesh = use(*store, kMesh);
  const std::vector<ChunkDigest> digests = {mesh->put_chunk(chunk_of("first")).value(),
                                            mesh->put_chunk(chunk_of("second")).value()};
  const ChunkRange range{4, 6};
  EXPECT_FALSE(mesh->find_shard(range));
  ASSERT_TRUE(mesh->put_shard(range, digests).ok());
  EXPECT_EQ(mesh->find_whole_shard(range), digests);
  fs::remove(file_of(digests[1]));
  EXPECT_FALSE(mesh->find_whole_shard(range));
  EXPECT_EQ(mesh->find_shard(range), digests);
}

TEST_F(ResultStoreTest, EvictsWhatWasUsedLeastAndNothingInUse) {
  constexpr std::uint64_t kBudget = 10'000;
  const auto store = open(kBudget);
  ASSERT_TRUE(store->put_chunk(*use(*store, kMesh), chunk_of(std::string(4000, 'x'))).ok());
  const auto used = use(*store, kOther);
  ASSERT_TRUE(store->put_chunk(*used, chunk_of("small")).ok());
  EXPECT_TRUE(store->put_chunk(*used, chunk_of(std::string(4000, 'y'))).ok());
  EXPECT_EQ(store->stats().evicted, 1U);
  EXPECT_TRUE(absl::IsNotFound(store->find({"default", kMesh}).status()));
  EXPECT_TRUE(store->find({"default", kOther}).ok());
  const auto full = store->put_chunk(*used, chunk_of(std::string(kBudget, 'z')));
  EXPECT_EQ(reason_of(full.status()), "RESULTS_FULL");
}

TEST_F(ResultStoreTest, EvictsNothingThatIsNeededThoughNobodyUsesIt) {
  constexpr std::uint64_t kBudget = 10'000;
  absl::StatusOr<std::set<ResultKey>> needed = std::set<ResultKey>{{"default", kMesh}};
  const auto store =
      ResultStore::open(folder_.path(), {kBudget, 0}, [&] { return needed; }).value();
  const ChunkMessage large = chunk_of(std::string(4000, 'x'));
  ASSERT_TRUE(store->put_chunk(*use(*store, kMesh), large).ok());
  ASSERT_TRUE(store->put_chunk(*use(*store, "cc00"), chunk_of("small")).ok());
  const auto put = [&] {
    return store->put_chunk(*use(*store, kOther), chunk_of(std::string(5000, 'y'))).status();
  };
  EXPECT_EQ(reason_of(put()), "RESULTS_FULL");
  EXPECT_TRUE(store->find({"default", kMesh}).ok());
  // What nobody needs went, and would have if it had been enough.
  EXPECT_TRUE(absl::IsNotFound(store->find({"default", "cc00"}).status()));
  needed = absl::UnavailableError("gone");
  EXPECT_EQ(put(), absl::UnavailableError("gone"));
  EXPECT_TRUE(store->find({"default", kMesh}).ok());
  needed = std::set<ResultKey>();
  EXPECT_EQ(put(), absl::OkStatus());
  EXPECT_TRUE(absl::IsNotFound(store->find({"default", kMesh}).status()));
}

/// As a worker that makes a shard just then: it waits for who evicts, and begins anew.
TEST_F(ResultStoreTest, AsksWhatIsNeededWhileNobodyCanMakeAnyOfIt) {
  constexpr std::uint64_t kBudget = 10'000;
  std::atomic<bool> is_made{false};
  std::unique_ptr<ResultStore> store;
  std::jthread maker;
  const auto ask = [&]() -> absl::StatusOr<std::set<ResultKey>> {
    maker = std::jthread([&] {
      use(*store, kMesh);
      is_made = true;
    });
    const auto lock =
        FolderLock::take(folder_.path() / "default/meshes/aa" / kMesh, FileLock::kAlone, false);
    EXPECT_TRUE(absl::IsAborted(lock.status())) << lock.status();
    EXPECT_FALSE(is_made);
    return std::set<ResultKey>();
  };
  store = ResultStore::open(folder_.path(), {kBudget, 0}, ask).value();
  ASSERT_TRUE(store->put_chunk(*use(*store, kMesh), chunk_of(std::string(4000, 'x'))).ok());
  EXPECT_TRUE(store->put_chunk(*use(*store, kOther), chunk_of(std::string(5000, 'y'))).ok());
  maker.join();
  EXPECT_TRUE(is_made);
}

TEST_F(ResultStoreTest, KeepsOneAccountOfWhatAllProcessesStore) {
  constexpr std::uint64_t kBudget = 200'000;
  constexpr int kWriters = 4, kChunks = 60, kChunkBytes = 4000;
  // Each as a process of its own has it: locks of files know no processes, but open files.
  std::vector<std::unique_ptr<ResultStore>> stores;
  for (int i = 0; i < kWriters; ++i) stores.push_back(open(kBudget));
  std::atomic<std::uint64_t> peak{0};
  {
    std::vector<std::jthread> writers;
    for (int writer = 0; writer < kWriters; ++writer) {
      writers.emplace_back([&, writer] {
        ResultStore& store = *stores[static_cast<std::size_t>(writer)];
        for (int i = 0; i < kChunks; ++i) {
          const auto mesh = use(store, absl::StrCat("aa", writer, i / 5));
          const std::string bytes = absl::StrCat(writer, " ", i, std::string(kChunkBytes, '.'));
          EXPECT_TRUE(store.put_chunk(*mesh, chunk_of(bytes)).ok());
          const std::uint64_t now = stored_bytes_in(folder_.path());
          for (auto most = peak.load(); now > most && !peak.compare_exchange_weak(most, now);) {
          }
        }
      });
    }
  }
  EXPECT_LE(peak, kBudget);
  EXPECT_GT(peak, kBudget / 2) << "or nobody had to make room";
  std::uint64_t evicted = 0;
  for (const auto& store : stores) evicted += store->stats().evicted;
  EXPECT_GT(evicted, 0U);
  // What nobody writes any more is counted as it is.
  stores[0]->sweep();
  EXPECT_EQ(stores[0]->stats().bytes, stored_bytes_in(folder_.path()));
}

TEST_F(ResultStoreTest, CountsNoChunkTwiceAndNoneThatWasNotWritten) {
  const auto store = open(), other = open();
  const auto mesh = use(*store, kMesh);
  ASSERT_TRUE(store->put_chunk(*mesh, chunk_of("some bytes")).ok());
  const std::uint64_t once = store->stats().bytes;
  EXPECT_EQ(once, stored_bytes_in(folder_.path()));
  ASSERT_TRUE(store->put_chunk(*mesh, chunk_of("some bytes")).ok());
  ASSERT_TRUE(other->put_chunk(*mesh, chunk_of("other bytes")).ok());
  const std::uint64_t twice = stored_bytes_in(folder_.path());
  EXPECT_EQ(other->stats().bytes, twice);
  // A folder that is gone takes no chunk.
  fs::remove_all(folder_.path() / "default/meshes/aa" / kMesh);
  EXPECT_FALSE(store->put_chunk(*mesh, chunk_of("third bytes")).ok());
  EXPECT_EQ(store->stats().bytes, twice);
}

TEST_F(ResultStoreTest, MakesADamagedAccountAnew) {
  const auto store = open();
  const auto mesh = use(*store, kMesh);
  ASSERT_TRUE(store->put_chunk(*mesh, chunk_of("some bytes")).ok());
  fs::resize_file(folder_.path() / ".account", 3);
  ASSERT_TRUE(store->put_chunk(*mesh, chunk_of("other bytes")).ok());
  EXPECT_EQ(store->stats().bytes, stored_bytes_in(folder_.path()));
}

TEST_F(ResultStoreTest, TakesADamagedPlanForNone) {
  const auto store = open();
  const std::string name(64, 'a');
  EXPECT_FALSE(store->find_plan("default", name));
  ASSERT_TRUE(store->put_plan({"default", kLongId}, name, "a plan").ok());
  EXPECT_EQ(store->find_plan("default", name), "a plan");
  fs::resize_file(folder_.path() / "default/plans" / name, 130);
  EXPECT_FALSE(store->find_plan("default", name));
}

TEST_F(ResultStoreTest, KeepsPlansAsLongAsTheirMeshes) {
  const auto store = open();
  const std::string kept(64, 'b'), stale(64, 'c');
  use(*store, kLongId);
  ASSERT_TRUE(store->put_plan({"default", kLongId}, kept, "a plan").ok());
  ASSERT_TRUE(store->put_plan({"default", std::string(64, 'd')}, stale, "a plan").ok());
  store->sweep();
  EXPECT_TRUE(store->find_plan("default", stale));  // its mesh may be about to be made
  for (const std::string& name : {kept, stale}) age(folder_.path() / "default/plans" / name);
  store->sweep();
  EXPECT_EQ(store->find_plan("default", kept), "a plan");
  EXPECT_FALSE(store->find_plan("default", stale));
}

TEST_F(ResultStoreTest, KeepsThePlanOfAJobThatWaitsAsLongAsItLooks) {
  const auto store = open();
  const std::string waiting(64, 'b'), given_up(64, 'c');
  for (const std::string& name : {waiting, given_up}) {
    ASSERT_TRUE(store->put_plan({"default", kLongId}, name, "a plan").ok());
    age(folder_.path() / "default/plans" / name);
  }
  store->keep_plan("default", waiting);
  store->sweep();
  EXPECT_EQ(store->find_plan("default", waiting), "a plan");
  EXPECT_FALSE(store->find_plan("default", given_up));
}

TEST_F(ResultStoreTest, KnowsWhatOthersHaveStoredWhereItLooksForRoom) {
  const auto store = open(), other = open();
  ASSERT_TRUE(other->put_chunk(*use(*other, kMesh), chunk_of("some bytes")).ok());
  EXPECT_EQ(store->check_fits(1), absl::OkStatus());
  EXPECT_EQ(store->stats().bytes, stored_bytes_in(folder_.path()));
}

/// At most so many more files are open as long as it lives.
class FewFiles {
 public:
  explicit FewFiles(rlim_t more) {
    ::getrlimit(RLIMIT_NOFILE, &before_);
    const File first_free = open_file("/dev/null", O_RDONLY).value();
    rlimit few = before_;
    few.rlim_cur = static_cast<rlim_t>(first_free.descriptor().number()) + more;
    ::setrlimit(RLIMIT_NOFILE, &few);
  }
  ~FewFiles() { ::setrlimit(RLIMIT_NOFILE, &before_); }
  FewFiles(const FewFiles&) = delete;
  FewFiles& operator=(const FewFiles&) = delete;

 private:
  rlimit before_{};
};

TEST_F(ResultStoreTest, EvictsMoreMeshesThanItMayOpenFiles) {
  constexpr int kMeshes = 200;
  {
    const auto store = open();
    for (int i = 0; i < kMeshes; ++i) {
      ASSERT_TRUE(store->put_chunk(*use(*store, absl::StrCat("aa", i)), chunk_of("few")).ok());
    }
  }
  const FewFiles few(100);
  const auto store = open(0);
  EXPECT_EQ(store->stats().evicted, static_cast<std::uint64_t>(kMeshes));
  EXPECT_EQ(store->stats().bytes, 0U);
}

TEST_F(ResultStoreTest, KeepsDamagedChunksForAWhile) {
  const auto store = open();
  const auto mesh = use(*store, kMesh);
  const ChunkDigest digest = mesh->put_chunk(chunk_of("some bytes")).value();
  fs::resize_file(file_of(digest), 5);
  EXPECT_FALSE(get(*mesh, digest).ok());
  const fs::path damaged = file_of(digest).string() + ".damaged";
  store->sweep();
  EXPECT_TRUE(fs::exists(damaged));
  // Once the file system's clock goes on: some go by steps of milliseconds.
  const auto strict = open(1 << 20, absl::ZeroDuration());
  EXPECT_TRUE(eventually([&] {
    strict->sweep();
    return !fs::exists(damaged);
  }));
}

}  // namespace
}  // namespace tet::test
