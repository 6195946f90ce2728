#include "server/jobs/work/work_place.h"

#include <system_error>

#include <absl/strings/str_cat.h>

#include "proto/convert/status.h"
#include "server/grids/store_identity.h"

namespace tet {

namespace {

absl::Status wrong_store(const std::string& message) {
  return with_reason(absl::FailedPreconditionError(message), "WRONG_STORE");
}

absl::Status not_there(const std::string& why) {
  return wrong_store(absl::StrCat("the folder of --store is no store of files now (", why,
                                  "): mount it there"));
}

absl::Status another(const std::string& found, const std::string& wanted) {
  return wrong_store(
      absl::StrCat("the folder of --store is store ", found, ", but the jobs belong to store ",
                   wanted, ": mount that one; or, if this one is to take its place, write ",
                   wanted, " into its ", kStoreIdentityFile));
}

/// Every store has had this file, which tells stores of before they had an identity.
bool has_lock(const std::filesystem::path& store) {
  std::error_code ignored;
  return std::filesystem::exists(store / "lock", ignored);
}

}  // namespace

absl::Status WorkPlace::check_store() {
  const std::lock_guard lock(mutex_);
  auto found = read_store_identity(store_);
  if (absl::IsNotFound(found.status()) && use_ == StoreUse::kOwn && wanted_.empty()) {
    found = make_store_identity(store_);
  }
  const bool missing = absl::IsNotFound(found.status());
  if (!found.ok() && !missing) return found.status();
  const std::string identity = missing ? "" : *found;
  if (wanted_.empty()) {
    if (auto status = learn_whose_jobs(identity); !status.ok()) return status;
  }
  if (missing && wanted_.empty() && has_lock(store_)) return absl::OkStatus();
  if (missing) return not_there(absl::StrCat(kStoreIdentityFile, " is missing"));
  if (!wanted_.empty() && identity != wanted_) return another(identity, wanted_);
  return absl::OkStatus();
}

absl::Status WorkPlace::learn_whose_jobs(const std::string& found) {
  const auto wanted = jobs_.belongs_to(use_ == StoreUse::kOwn ? found : "");
  if (!wanted.ok()) return wanted.status();
  wanted_ = *wanted;
  return absl::OkStatus();
}

absl::Status WorkPlace::check(const ResultStore& results) {
  const absl::Status store = check_store();
  return store.ok() ? results.probe() : store;
}

}  // namespace tet
