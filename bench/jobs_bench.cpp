// The job store's rates, for both engines: jobs submitted, shards claimed and committed, pages
// listed, with few and with many jobs in the queue. Durable as in service: every commit reaches
// the disk.
#include <cstdint>
#include <cstdlib>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <absl/strings/str_cat.h>
#include <benchmark/benchmark.h>

#include "server/jobs/store/postgres_job_store.h"
#include "server/jobs/store/sqlite_job_store.h"
#include "tests/server/jobs/store/made_up_work.h"
#include "tests/server/jobs/store/postgres_server.h"
#include "tests/server/test_folder.h"

namespace tet::bench {
namespace {

using test::digests_of;
using test::plan_of;

enum Engine : std::int64_t { kSqlite = 0, kPostgres = 1 };

std::unique_ptr<JobStore> open_sqlite() {
  static const test::TestFolder folder;
  static int count = 0;
  return open_sqlite_job_store({.path = folder.file(absl::StrCat(++count, ".db"))}).value();
}

std::unique_ptr<JobStore> open_postgres() {
  static test::PostgresServer server(true);
  static int count = 0;
  const std::string schema = absl::StrCat("bench", ++count);
  server.make_schema(schema);
  return open_postgres_job_store({.connection = server.connection(schema)}).value();
}

std::unique_ptr<JobStore> open(std::int64_t engine) {
  return engine == kSqlite ? open_sqlite() : open_postgres();
}

NewJob wanted(std::int64_t i = 0) {
  NewJob job;
  job.space = absl::StrCat("space-", i % 10);
  job.spec = std::string(300, 's');
  job.labels = {{"farm", "night"}};
  return job;
}

/// A store with `count` jobs in its queue, made once for all that leave it as it was.
JobStore& filled(std::int64_t engine, std::int64_t count) {
  static std::map<std::pair<std::int64_t, std::int64_t>, std::unique_ptr<JobStore>> stores;
  auto& store = stores[{engine, count}];
  if (store) return *store;
  store = open(engine);
  for (std::int64_t i = 0; i < count; ++i) store->create(wanted(i)).value();
  return *store;
}

std::vector<ShardLease> claim_some(JobStore& store, std::int64_t most) {
  auto leases = store.claim({"w", most});
  if (!leases.ok()) std::abort();
  return *std::move(leases);
}

void submit(benchmark::State& state) {
  static std::unique_ptr<JobStore> store;
  if (state.thread_index() == 0) store = open(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(store->create(wanted(state.thread_index())));
  state.SetItemsProcessed(state.iterations());
  if (state.thread_index() == 0) store.reset();
}

/// Behind others in the queue, which stays as long as it is.
void submit_behind(benchmark::State& state) {
  JobStore& store = filled(state.range(0), state.range(1));
  for (auto _ : state) {
    const auto created = store.create(wanted());
    state.PauseTiming();
    (void)store.cancel(created.value().job.id);
    (void)store.remove(created.value().job.id);
    state.ResumeTiming();
  }
  state.SetItemsProcessed(state.iterations());
}

void claim(benchmark::State& state) {
  JobStore& store = filled(state.range(0), state.range(1));
  const std::int64_t batch = state.range(2);
  std::int64_t claimed = 0;
  std::vector<ShardLease> leases;
  for (auto _ : state) {
    leases = claim_some(store, batch);
    claimed += std::ssize(leases);
    state.PauseTiming();
    for (const ShardLease& lease : leases) (void)store.release(lease.id);
    state.ResumeTiming();
  }
  state.SetItemsProcessed(claimed);
}

void complete(benchmark::State& state) {
  const auto store = open(state.range(0));
  std::vector<ShardLease> leases;
  for (auto _ : state) {
    if (leases.empty()) {
      state.PauseTiming();
      store->create(wanted()).value();
      const auto plan = claim_some(*store, 1);
      (void)store->set_plan(plan.at(0).id, plan_of(100));
      leases = claim_some(*store, 100);
      state.ResumeTiming();
    }
    const absl::Status status =
        store->complete(leases.back().id, digests_of(leases.back().chunks));
    if (!status.ok()) state.SkipWithError(status.ToString().c_str());
    leases.pop_back();
  }
  state.SetItemsProcessed(state.iterations());
}

void heartbeat(benchmark::State& state) {
  JobStore& store = filled(state.range(0), 100);
  std::vector<LeaseId> ids;
  for (const ShardLease& lease : claim_some(store, 100)) ids.push_back(lease.id);
  for (auto _ : state) benchmark::DoNotOptimize(store.heartbeat(ids, absl::Seconds(30)));
  for (const LeaseId& id : ids) (void)store.release(id);
  state.SetItemsProcessed(state.iterations() * std::ssize(ids));
}

void list(benchmark::State& state) {
  JobStore& store = filled(state.range(0), state.range(1));
  ListJobs query;
  query.filter.labels = {{"farm", "night"}};
  std::int64_t listed = 0;
  for (auto _ : state) {
    const JobPage page = store.list(query).value();
    query.page_token = page.next_page_token;
    listed += std::ssize(page.jobs);
  }
  state.SetItemsProcessed(listed);
}

BENCHMARK(submit)->ArgName("engine")->Arg(kSqlite)->Arg(kPostgres)->UseRealTime();
BENCHMARK(submit)->ArgName("engine")->Arg(kSqlite)->Arg(kPostgres)->Threads(8)->UseRealTime();
BENCHMARK(submit_behind)
    ->ArgNames({"engine", "queued"})
    ->ArgsProduct({{kSqlite, kPostgres}, {100, 10'000}})
    ->UseRealTime();
BENCHMARK(claim)
    ->ArgNames({"engine", "queued", "batch"})
    ->ArgsProduct({{kSqlite, kPostgres}, {100, 10'000}, {1, 16}})
    ->UseRealTime();
BENCHMARK(complete)->ArgName("engine")->Arg(kSqlite)->Arg(kPostgres)->UseRealTime();
BENCHMARK(heartbeat)->ArgName("engine")->Arg(kSqlite)->Arg(kPostgres)->UseRealTime();
BENCHMARK(list)
    ->ArgNames({"engine", "queued"})
    ->ArgsProduct({{kSqlite, kPostgres}, {100, 10'000}})
    ->UseRealTime();

}  // namespace
}  // namespace tet::bench

BENCHMARK_MAIN();
