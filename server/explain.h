// Core's failures as the service tells them: with a reason, and without the server's own paths.
#pragma once

#include <string_view>

#include <absl/status/status.h>

namespace tet {

/// Of reading the stored file `digest`, which lies at `path`. What has a reason keeps it.
absl::Status about_file(const absl::Status& status,
                        std::string_view digest,
                        std::string_view path);

/// Of counting a mesh. What has a reason keeps it.
absl::Status about_mesh(const absl::Status& status);

}  // namespace tet
