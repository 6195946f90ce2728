// Core's failures as the service tells them: with a reason, and without the server's own paths.
#pragma once

#include <cstddef>
#include <string_view>

#include <absl/status/status.h>

#include "core/vdb/memory_charge.h"

namespace tet {

/// Of reading the stored file `digest`, which lies at `path`, for `use`. What has a reason
/// keeps it.
absl::Status about_file(const absl::Status& status,
                        std::string_view digest,
                        std::string_view path,
                        GridUse use = GridUse::kSurface);

/// Of reading the grid of field number `i` of a mesh's request: names that.
absl::Status about_field(const absl::Status& status, std::size_t i);

/// Of reading the grid that a request for several names in place `i`: names that, unless it is
/// the file that cannot be read.
absl::Status about_grid(const absl::Status& status, std::size_t i);

/// Of counting a mesh. What has a reason keeps it.
absl::Status about_mesh(const absl::Status& status);

}  // namespace tet
