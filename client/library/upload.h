// A file on its way to the server.
#pragma once

#include <cstdint>

#include <absl/status/status.h>

#include "client/library/channel.h"
#include "client/library/local_file.h"
#include "client/library/mesh_client.h"
#include "core/base/cancel.h"

namespace tet {

/// One UploadGrid call that sends `file` from `offset` on. Errors: kAborted when it ended
/// well but short; those of io_error where the file cannot be read; the server's.
absl::Status upload_from(const ServerChannel& channel,
                         const LocalFile& file,
                         std::uint64_t offset,
                         const ClientProgress& progress,
                         const Cancellation& cancellation);

}  // namespace tet
