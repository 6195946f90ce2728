#include "server/upkeep/upkeep_commands.h"

#include <filesystem>
#include <iostream>

#include <absl/status/status.h>

#include "core/base/printable.h"
#include "server/jobs/store/open_job_store.h"
#include "server/upkeep/backup.h"
#include "server/upkeep/check_store.h"

namespace tet {

namespace {

constexpr int kFine = 0, kFoundProblems = 1, kCannot = 3;

/// SQLite's file of jobs; empty where there is none.
std::filesystem::path sqlite_file_of(const Config& config) {
  if (!config.has_jobs() || is_postgres(config.jobs)) return {};
  if (!config.jobs.empty()) return config.jobs;
  return std::filesystem::path(config.store) / "jobs.sqlite";
}

int cannot(const absl::Status& status) {
  std::cerr << "tetstreamd: " << for_terminal(std::string(status.message())) << "\n";
  return kCannot;
}

void tell_of_jobs(const Config& config, bool has_jobs) {
  if (has_jobs) std::cout << "The jobs are with them.\n";
  if (!is_postgres(config.jobs)) return;
  std::cout << "The jobs are in PostgreSQL: run pg_dump after this, and then this once more.\n";
}

int back_up(const Config& config, const std::string& folder) {
  const auto done = back_up_store(config.store, sqlite_file_of(config), folder);
  if (!done.ok()) return cannot(done.status());
  std::cout << "Backed up to " << for_terminal(folder) << ": " << done->files << " files, "
            << done->new_files << " of them new; " << done->gone_files
            << " removed that the store has no more.\n";
  tell_of_jobs(config, done->has_jobs);
  return kFine;
}

int restore(const Config& config, const std::string& folder) {
  const auto done = restore_store(folder, config.store, sqlite_file_of(config));
  if (!done.ok()) return cannot(done.status());
  std::cout << "Restored " << done->files << " files to " << for_terminal(config.store)
            << ".\n";
  tell_of_jobs(config, done->has_jobs);
  return kFine;
}

int check(const Config& config) {
  const auto done = check_store(
      config.store, sqlite_file_of(config),
      [](const std::string& problem) { std::cout << for_terminal(problem) << "\n"; });
  if (!done.ok()) return cannot(done.status());
  std::cout << "Read " << done->files << " files, " << done->bytes
            << " bytes: " << done->problems << " problems.\n";
  return done->problems == 0 ? kFine : kFoundProblems;
}

}  // namespace

int run_upkeep(Upkeep what, const Config& config, const std::string& folder) {
  switch (what) {
    case Upkeep::kBackup:
      return back_up(config, folder);
    case Upkeep::kRestore:
      return restore(config, folder);
    case Upkeep::kCheck:
      return check(config);
  }
  return kCannot;
}

}  // namespace tet
