// Parts of tetstream that are modules, loaded when something needs what they bring along.
#pragma once

#include <mutex>
#include <string>

#include <absl/status/statusor.h>

namespace tet {

/// A module beside the decoder (see find_decoder.h), and its one function.
struct ModuleName {
  const char* file = nullptr;
  const char* function = nullptr;  ///< takes nothing, and returns a pointer to what it is for
  const char* brings = nullptr;    ///< for whoever is told that it is missing
};

/// Loads it for as long as the process lives, and returns what its function returns. Errors:
/// kUnavailable (it is not there, and where it was looked for; or it does not load).
absl::StatusOr<const void*> load_module(const ModuleName& name);

/// A module that is loaded when it is asked for. Thread-safe.
template <class Part>
class LoadedModule {
 public:
  explicit LoadedModule(const ModuleName& name) : name_(name) {}

  /// Loads it, the first time. Errors: those of load_module, which is tried again then.
  absl::StatusOr<Part*> get() {
    const std::lock_guard lock(mutex_);
    if (part_ != nullptr) return part_;
    const absl::StatusOr<const void*> part = load_module(name_);
    if (!part.ok()) return part.status();
    return part_ = static_cast<Part*>(*part);
  }

  bool is_loaded() const {
    const std::lock_guard lock(mutex_);
    return part_ != nullptr;
  }

 private:
  const ModuleName name_;
  mutable std::mutex mutex_;
  Part* part_ = nullptr;
};

}  // namespace tet
