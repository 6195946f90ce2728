// Log lines: one JSON object each, on stderr.
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json.hpp>
#include <spdlog/common.h>

namespace tet {

/// Sends log lines of `level` (a name spdlog knows) and above to stderr. Call it once, first.
void start_logging(const std::string& level);

/// Writes {"time", "level", "event", ...fields} as one line. `fields` is an object.
/// Thread safety: any thread may call it at any time.
void log_event(spdlog::level::level_enum level,
               std::string_view event,
               const nlohmann::ordered_json& fields = nlohmann::ordered_json::object());

}  // namespace tet
