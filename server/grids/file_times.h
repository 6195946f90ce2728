// When a file was used last, as the file itself says.
#pragma once

#include <filesystem>

#include <absl/time/time.h>

namespace tet {

/// Gives a file this time, or a later one if it has that already, and says which it has then:
/// whoever remembers an earlier one can tell that the file was used since. A file that is gone
/// has the time that was given.
absl::Time give_time(const std::filesystem::path& path, absl::Time time);

}  // namespace tet
