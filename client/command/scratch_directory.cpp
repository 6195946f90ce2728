#include "client/command/scratch_directory.h"

#include <stdlib.h>
#include <system_error>

namespace tet {

ScratchDirectory::ScratchDirectory(const std::filesystem::path& parent)
    : path_((parent / ".tetstream.XXXXXX").string()) {
  made_ = mkdtemp(path_.data()) != nullptr;
}

ScratchDirectory::~ScratchDirectory() {
  std::error_code ignored;
  if (made_) std::filesystem::remove_all(path_, ignored);
}

}  // namespace tet
