#include "tetstream/version.h"

namespace tetstream {

const char* version() noexcept { return TETSTREAM_VERSION; }

}  // namespace tetstream
