// Jobs as messages have them, and as the public headers do.
#pragma once

#include <string>

#include <absl/status/statusor.h>

#include "tetstream/jobs.h"
#include "tetstream/v1/jobs.pb.h"

namespace tetstream {

// The shared library does not show them: who links it knows no messages.
#pragma GCC visibility push(hidden)

/// The order alone, without its mesh.
v1::Job message_of(const JobOrder& order);
v1::JobFilter message_of(const JobFilter& filter);

Job to_public(const v1::Job& job);
JobEvent to_public(const v1::JobEvent& event);

/// The order's request id; a new one where it has none.
std::string request_id_of(const JobOrder& order);

#pragma GCC visibility pop

}  // namespace tetstream
