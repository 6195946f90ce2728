// openvdb_part() where it is a module, which is looked for beside the decoder.
#include <atomic>
#include <dlfcn.h>
#include <mutex>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/vdb/find_decoder.h"
#include "core/vdb/openvdb_part.h"

namespace tet {
namespace {

constexpr const char* kFunction = "tetstream_openvdb_part";

std::atomic<const OpenVdbPart*> loaded = nullptr;

absl::Status unavailable(const std::string& why) {
  return absl::UnavailableError(
      absl::StrCat("the part of tetstream that needs OpenVDB cannot be loaded: ", why));
}

/// Stays loaded until the process ends.
absl::StatusOr<const OpenVdbPart*> load() {
  const absl::StatusOr<std::string> path = find_openvdb_module();
  if (!path.ok()) return unavailable(std::string(path.status().message()));
  void* const module = ::dlopen(path->c_str(), RTLD_NOW | RTLD_LOCAL);
  if (module == nullptr) return unavailable(::dlerror());
  void* const function = ::dlsym(module, kFunction);
  if (function == nullptr) return unavailable(absl::StrFormat("'%s' is another one", *path));
  return reinterpret_cast<const OpenVdbPart* (*)()>(function)();
}

}  // namespace

absl::StatusOr<const OpenVdbPart*> openvdb_part() {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  if (const OpenVdbPart* const part = loaded) return part;
  const absl::StatusOr<const OpenVdbPart*> part = load();
  if (part.ok()) loaded = *part;
  return part;
}

bool has_openvdb_part() noexcept { return loaded != nullptr; }

}  // namespace tet
