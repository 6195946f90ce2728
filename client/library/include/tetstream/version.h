// Which version a program was compiled against, and which it runs with.
#pragma once

#include "tetstream/export.h"

#define TETSTREAM_VERSION_MAJOR 0
#define TETSTREAM_VERSION_MINOR 2
#define TETSTREAM_VERSION_PATCH 0

namespace tetstream {

/// Version of the library that the program runs with, as "0.2.0".
TETSTREAM_API const char* version() noexcept;

}  // namespace tetstream
