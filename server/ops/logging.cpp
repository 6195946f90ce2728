#include "server/ops/logging.h"

#include <absl/time/clock.h>
#include <absl/time/time.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

namespace tet {

void start_logging(const std::string& level) {
  auto logger = std::make_shared<spdlog::logger>(
      "tetstream", std::make_shared<spdlog::sinks::stderr_sink_mt>());
  logger->set_pattern("%v");
  logger->set_level(spdlog::level::from_str(level));
  spdlog::set_default_logger(std::move(logger));
}

void log_event(spdlog::level::level_enum level,
               std::string_view event,
               const nlohmann::ordered_json& fields) {
  if (!spdlog::should_log(level)) return;
  nlohmann::ordered_json line;
  line["time"] = absl::FormatTime("%Y-%m-%dT%H:%M:%E3SZ", absl::Now(), absl::UTCTimeZone());
  line["level"] = std::string_view(spdlog::level::to_string_view(level).data());
  line["event"] = event;
  line.update(fields);
  // A client's text may not be UTF-8; a log line must be all the same.
  spdlog::log(level, "{}", line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

}  // namespace tet
