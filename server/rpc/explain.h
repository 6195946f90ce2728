// Core's failures as the service tells them: with a reason, and without the server's own paths.
#pragma once

#include <cstddef>
#include <string_view>

#include <absl/status/status.h>

#include "core/vdb/walk/memory_charge.h"

namespace tet {

/// Explains why the stored file `digest`, which lies at `path`, could not be read for `use`. A
/// failure that has a reason keeps it.
absl::Status about_file(const absl::Status& status,
                        std::string_view digest,
                        std::string_view path,
                        GridUse use = GridUse::kSurface);

/// Explains why the grid of field number `i` of a mesh's request could not be read, naming the
/// field.
absl::Status about_field(const absl::Status& status, std::size_t i);

/// Explains why a grid of a request for several could not be read, naming its place `i`, unless
/// it is the file that cannot be read.
absl::Status about_grid(const absl::Status& status, std::size_t i);

/// Explains why a mesh could not be counted. A failure that has a reason keeps it.
absl::Status about_mesh(const absl::Status& status);

}  // namespace tet
