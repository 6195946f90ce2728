// Jobs as programs read them: one JSON object a line, with keys that stay.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "client/library/job_client.h"

namespace tet {

/// "QUEUED", "SUCCEEDED", ...
std::string name_of(v1::JobState state);
/// "CREATED", "SHARD_DONE", ...
std::string name_of(v1::JobChange change);

/// "WORKING", "QUARANTINED" or "LOST".
std::string state_of(const v1::Worker& worker);

bool is_final(v1::JobState state);

/// docs/jobs.md lists the keys.
nlohmann::ordered_json as_json(const v1::Job& job);
nlohmann::ordered_json as_json(const v1::JobEvent& event);
nlohmann::ordered_json as_json(const v1::DeadShard& shard);
nlohmann::ordered_json as_json(const v1::Worker& worker);
/// `code`, `reason`, `message`.
nlohmann::ordered_json as_json(const absl::Status& error);

/// One line without its end. Text may come from elsewhere and need not be UTF-8.
std::string line_of(const nlohmann::ordered_json& json);

}  // namespace tet
