// Log lines: one JSON object each, on stderr.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>
#include <spdlog/common.h>

namespace tet {

/// Sends log lines of `level` (a name spdlog knows) and above to stderr, by a LogWriter that
/// keeps so many bytes. Call it first, and again for another level, or where stderr has become
/// another file; not from several threads.
void start_logging(const std::string& level, std::size_t buffer_bytes = std::size_t{4} << 20);

/// Returns once all lines are written, or at the timeout.
void flush_log(std::chrono::milliseconds timeout);
/// Lines that nobody took in time.
std::int64_t dropped_log_lines();

/// Writes {"time", "level", "event", ...fields} as one line. `fields` is an object.
/// Thread safety: any thread may call it at any time.
void log_event(spdlog::level::level_enum level,
               std::string_view event,
               const nlohmann::ordered_json& fields = nlohmann::ordered_json::object());

}  // namespace tet
