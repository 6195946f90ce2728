// `tetstreamd backup`, `restore` and `check`.
#pragma once

#include <string>

#include "server/ops/config.h"

namespace tet {

/// What an operator does with a store, by the name of its command.
enum class Upkeep { kBackup, kRestore, kCheck };

/// Does it with the store and the jobs of the settings, and tells people about it. `folder` is
/// the backup's. Returns the exit code: 0, 1 if the check found something, 3 if it failed.
int run_upkeep(Upkeep what, const Config& config, const std::string& folder);

}  // namespace tet
