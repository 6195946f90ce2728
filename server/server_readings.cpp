#include "server/server_readings.h"

#include <filesystem>
#include <system_error>

namespace tet {

namespace {

Reading build_info() {
  Reading info = gauge("tetstream_build_info", "1, with what this server is.", 1);
  info.labels.emplace_back("version", TETSTREAM_VERSION);
  info.labels.emplace_back("algorithm", kAlgorithmVersion);
  return info;
}

void add_work(const MeshEngine& engine, std::vector<Reading>& readings) {
  readings.push_back(gauge("tetstream_ready", "1 unless the server is shutting down.",
                           !engine.calls.admission().is_ending()));
  readings.push_back(
      gauge("tetstream_calls_running", "Calls that have not ended.", engine.calls.running()));
  readings.push_back(gauge("tetstream_meshes_running", "Streams and estimates that run.",
                           engine.activity.meshes.load()));
  readings.push_back(gauge("tetstream_meshes_paused",
                           "Streams that wait for their readers and have lent their places.",
                           engine.calls.admission().paused_meshes()));
  readings.push_back(gauge("tetstream_meshes_queued", "Streams and estimates that wait.",
                           engine.calls.admission().queued_meshes()));
  readings.push_back(gauge("tetstream_send_bytes", "Bytes of chunks on their way to clients.",
                           engine.send_budget.used_bytes()));
  readings.push_back(
      gauge("tetstream_plans_running", "Meshes being counted.", engine.planner.running()));
  readings.push_back(counter("tetstream_plans_cut_short_total",
                             "Turns that were not enough for their plans.",
                             engine.turns.cut_short()));
  readings.push_back(gauge("tetstream_chunks_in_flight", "Chunks asked for and not yet made.",
                           engine.activity.chunks_in_flight.load()));
  readings.push_back(counter("tetstream_cached_streams_total",
                             "Streams that were served from results of jobs.",
                             engine.activity.cached_streams.load()));
  readings.push_back(counter("tetstream_shared_streams_total",
                             "Streams whose chunks were in shared memory.",
                             engine.activity.shared_streams.load()));
  readings.push_back(counter("tetstream_made_chunks_total", "Chunks made.",
                             engine.activity.chunks_made.load()));
}

void add_disk(const Config& config, std::vector<Reading>& readings) {
  std::error_code error;
  const auto disk = std::filesystem::space(config.store, error);
  if (!error) {
    readings.push_back(gauge("tetstream_store_free_bytes",
                             "Bytes that the store's disk has free.", disk.available));
  }
  readings.push_back(gauge("tetstream_disk_reserve_bytes", "The setting disk_reserve_bytes.",
                           config.disk_reserve_bytes));
}

void add_store(const StoreStats& store, std::vector<Reading>& readings) {
  readings.push_back(gauge("tetstream_store_bytes",
                           "Bytes of the store in use: grid files, and uploads under way.",
                           store.bytes));
  readings.push_back(gauge("tetstream_store_files", "Grid files stored.", store.files));
  readings.push_back(
      gauge("tetstream_store_uploads", "Uploads begun and not complete.", store.uploads));
  readings.push_back(
      gauge("tetstream_store_budget_bytes", "The setting store_bytes.", store.budget_bytes));
}

void add_plans(const PlannerStats& plans, std::vector<Reading>& readings) {
  readings.push_back(
      gauge("tetstream_resident_bytes", "Bytes of grids in memory.", plans.volumes.bytes));
  readings.push_back(
      gauge("tetstream_resident_grids", "Grids in memory.", plans.volumes.grids));
  readings.push_back(gauge("tetstream_resident_budget_bytes", "The setting resident_bytes.",
                           plans.volumes.budget_bytes));
  readings.push_back(gauge("tetstream_plan_bytes",
                           "Bytes of counted meshes in memory: in use, and the last few.",
                           plans.plan_bytes));
  readings.push_back(
      gauge("tetstream_plan_budget_bytes", "The setting plan_bytes.", plans.plan_budget_bytes));
  constexpr char kLookups[] = "tetstream_plan_lookups_total";
  constexpr char kHelp[] = "Plans asked for, by whether one was kept.";
  readings.push_back(counter(kLookups, kHelp, plans.hits, {{"result", "hit"}}));
  readings.push_back(counter(kLookups, kHelp, plans.misses, {{"result", "miss"}}));
}

void add_evictions(const StoreStats& store,
                   const PlannerStats& plans,
                   std::vector<Reading>& readings) {
  constexpr char kEvictions[] = "tetstream_evictions_total";
  constexpr char kHelp[] = "What had to go to make room, by what it was.";
  readings.push_back(counter(kEvictions, kHelp, store.evicted_files, {{"what", "grid_file"}}));
  readings.push_back(counter(kEvictions, kHelp, store.evicted_uploads, {{"what", "upload"}}));
  readings.push_back(
      counter(kEvictions, kHelp, plans.volumes.evicted, {{"what", "resident_grid"}}));
  readings.push_back(counter("tetstream_store_corrupt_total",
                             "Stored files that were found damaged and set aside.",
                             store.corrupt_files));
}

}  // namespace

std::vector<Reading> read_server(const MeshEngine& engine, const GridStore& store) {
  const StoreStats stored = store.stats();
  const PlannerStats plans = engine.planner.stats();
  std::vector<Reading> readings = {build_info()};
  add_work(engine, readings);
  add_store(stored, readings);
  add_disk(engine.config, readings);
  add_plans(plans, readings);
  add_evictions(stored, plans, readings);
  return readings;
}

std::vector<Reading> read_credentials(Access& access, ServerTls* tls) {
  const auto kept_old = [](const char* what, bool is_old) {
    Reading reading = gauge("tetstream_kept_old",
                            "1 while a file cannot be used and what it held is kept.", is_old);
    reading.labels.emplace_back("what", what);
    return reading;
  };
  std::vector<Reading> readings{kept_old("tokens", access.keeps_old()),
                                kept_old("certificate", tls != nullptr && tls->keeps_old())};
  if (tls != nullptr) {
    readings.push_back(gauge("tetstream_certificate_expires_seconds",
                             "When the server's certificate ends, Unix time.",
                             absl::ToUnixSeconds(tls->expires())));
  }
  return readings;
}

}  // namespace tet
