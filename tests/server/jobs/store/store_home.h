// Where a test's job store lives: opened as often as the test likes, by this process and
// others.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/jobs/store/job_store.h"
#include "server/jobs/store/sql_job_store.h"

namespace tet::test {

class StoreHome {
 public:
  virtual ~StoreHome() = default;
  /// Fails the test, and gives nothing, if the store cannot be opened.
  virtual std::unique_ptr<JobStore> open(const SqlJobStore::Options& rules) const = 0;
  /// How the worker program opens it.
  virtual std::vector<std::string> worker_arguments() const = 0;
};

/// Makes a store of today one of the first version.
constexpr char kBackToTheFirst[] =
    "DROP INDEX jobs_waiting; DROP INDEX jobs_planned; ALTER TABLE jobs DROP COLUMN "
    "room_waits; "
    "DROP INDEX jobs_of_algorithm; DROP TABLE facts; DROP TABLE workers; "
    "ALTER TABLE queue DROP COLUMN algorithm; ALTER TABLE jobs DROP COLUMN algorithm; "
    "ALTER TABLE jobs DROP COLUMN replans; ALTER TABLE jobs DROP COLUMN given_back; "
    "ALTER TABLE jobs DROP COLUMN trouble; DROP INDEX jobs_inputs; "
    "ALTER TABLE jobs DROP COLUMN input; ";

/// A new home, empty.
using MakeHome = std::unique_ptr<StoreHome> (*)();

}  // namespace tet::test
