// Memory that has a descriptor, so that another process can be handed it.
#pragma once

#include "core/base/posix/descriptor.h"

namespace tet {

/// Makes an empty file in memory, which can be sealed and never run as a program. `name` is for
/// people who look at the process. None is open where the system has none: errno says why.
///
/// Its seals may be more than whoever uses it has added: where the kernel knows files that
/// cannot be run, F_SEAL_EXEC is one of them.
Descriptor make_memory_file(const char* name) noexcept;

}  // namespace tet
