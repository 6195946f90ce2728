#include "core/vdb/parts/load_module.h"

#include <dlfcn.h>

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include "core/vdb/parts/find_decoder.h"

namespace tet {

absl::StatusOr<const void*> load_module(const ModuleName& name) {
  const auto unavailable = [&](const std::string& why) {
    return absl::UnavailableError(absl::StrFormat(
        "the part of tetstream that needs %s cannot be loaded: %s", name.brings, why));
  };
  const absl::StatusOr<std::string> path = find_module(name.file);
  if (!path.ok()) return unavailable(std::string(path.status().message()));
  void* const module = ::dlopen(path->c_str(), RTLD_NOW | RTLD_LOCAL);
  if (module == nullptr) return unavailable(::dlerror());
  void* const function = ::dlsym(module, name.function);
  if (function == nullptr) return unavailable(absl::StrFormat("'%s' is another one", *path));
  return reinterpret_cast<const void* (*)()>(function)();
}

}  // namespace tet
